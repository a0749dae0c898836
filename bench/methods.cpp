// How long solving takes without detection, and one ground plane.
#include <benchmark/benchmark.h>

#include "rigproof/calib/methods/registry.h"
#include "rigproof/calib/vision/ground_plane.h"
#include "rigproof/core/random.h"
#include "synthetic_drive.h"

namespace rigproof {
namespace {

SyntheticDrive drive_of(int cameras, int stops) {
  DriveOptions options;
  options.cameras = cameras;
  options.stops = stops;
  options.corner_sigma_px = 0.1;
  options.odometry_sigma_m = 0.002;
  options.odometry_sigma_rad = 0.01;
  return make_drive(options);
}

void solve(benchmark::State& state, const char* name) {
  const SyntheticDrive drive = drive_of(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const Method& method = find_method(name);
  for (auto iteration : state) benchmark::DoNotOptimize(method.solve(drive.observations));
}
BENCHMARK_CAPTURE(solve, memroc, "memroc")->Args({3, 100})->Args({8, 1000})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve, joint_memroc, "joint_memroc")->Args({3, 100})->Unit(benchmark::kMillisecond);

void ground_plane(benchmark::State& state) {
  RigCamera camera;
  camera.camera = Camera::symmetric(1280, 720, 640.0);
  camera.depth = DepthStream();
  Image16 depth(1280, 720);
  RandomStream random(0, "bench");
  for (int y = 0; y < 720; ++y) {
    for (int x = 0; x < 1280; ++x) {
      // A floor 0.7 m below a camera that looks level, and a wall at 4 m.
      const double floor = (y - 359.5) / 640.0 / 0.7;
      depth.at(x, y) = static_cast<std::uint16_t>(1000.0 / (std::max(0.25, floor) + random.normal(0.0, 0.0019)));
    }
  }
  for (auto iteration : state) {
    const DepthPoints points = points_from_depth(depth, camera, 10);
    benchmark::DoNotOptimize(fit_ground_plane(points, camera.depth->noise, std::nullopt));
  }
}
BENCHMARK(ground_plane)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rigproof

BENCHMARK_MAIN();
