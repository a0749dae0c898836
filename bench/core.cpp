// Reading and writing what a run of 2,000 stops and 3 cameras leaves on disk, and the arithmetic of inner loops.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "rigproof/core/files.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/odometry_csv.h"
#include "rigproof/core/random.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/study/workflow/scratch_folder.h"
#include "rigproof/truth/truth.h"

namespace rigproof {
namespace {

constexpr int kStops = 2000;
constexpr int kCameras = 3;

Observations large_observations() {
  RandomStream random(1, "bench");
  Observations o;
  for (int c = 0; c < kCameras; ++c) {
    RigCamera camera;
    camera.name = camera.folder = camera.link = "camera" + std::to_string(c);
    camera.camera = Camera::symmetric(1280, 720, 640.0);
    o.cameras.push_back(camera);
  }
  for (int stop = 0; stop < kStops; ++stop) {
    o.stops.push_back({static_cast<double>(stop), random.normal(), random.normal(), random.normal(), 0.0});
    for (int c = 0; c < kCameras; ++c) {
      BoardView view;
      view.stop = stop;
      view.camera = c;
      view.file = "left/color/000000.png";
      for (int id = 0; id < o.board.corner_count(); ++id)
        view.corners.push_back(
            {id, {random.uniform(0.0, 1279.0), random.uniform(0.0, 719.0)}, Eigen::Matrix2d::Identity() * 1.234e-5});
      o.board_views.push_back(view);
    }
  }
  return o;
}

void save_observations_of_2000_stops(benchmark::State& state) {
  const ScratchFolder folder("bench");
  const Observations observations = large_observations();
  for (auto _ : state) save_observations(observations, folder.path() / "o.json");
  state.counters["MB"] = static_cast<double>(std::filesystem::file_size(folder.path() / "o.json")) * 1e-6;
}
BENCHMARK(save_observations_of_2000_stops)->Unit(benchmark::kMillisecond);

void load_observations_of_2000_stops(benchmark::State& state) {
  const ScratchFolder folder("bench");
  save_observations(large_observations(), folder.path() / "o.json");
  for (auto _ : state) benchmark::DoNotOptimize(load_observations(folder.path() / "o.json"));
}
BENCHMARK(load_observations_of_2000_stops)->Unit(benchmark::kMillisecond);

void load_truth_of_2000_stops(benchmark::State& state) {
  const ScratchFolder folder("bench");
  Truth truth;
  for (int i = 0; i < kStops; ++i) truth.stops.push_back({i * 2.0, planar_pose(i * 0.1, 0.3, i * 0.01)});
  save_truth(truth, folder.path() / "t.yaml");
  for (auto _ : state) benchmark::DoNotOptimize(load_truth(folder.path() / "t.yaml"));
}
BENCHMARK(load_truth_of_2000_stops)->Unit(benchmark::kMillisecond);

void load_manifest_of_12000_files(benchmark::State& state) {
  const ScratchFolder folder("bench");
  Manifest manifest;
  for (int i = 0; i < 12000; ++i)
    manifest.files["recording/left/color/" + std::to_string(i) + ".png"] = {123456, std::string(64, 'a')};
  save_manifest(manifest, folder.path() / "run.yaml");
  for (auto _ : state) benchmark::DoNotOptimize(load_manifest(folder.path() / "run.yaml"));
}
BENCHMARK(load_manifest_of_12000_files)->Unit(benchmark::kMillisecond);

void read_odometry_of_100000_rows(benchmark::State& state) {
  const ScratchFolder folder("bench");
  RandomStream random(2, "bench odometry");
  std::vector<OdometrySample> odometry;
  for (int i = 0; i < 100000; ++i) odometry.push_back({i * 0.02, random.normal(), random.normal(), random.normal()});
  write_file_atomically(folder.path() / "o.csv", odometry_csv(odometry));
  for (auto _ : state) {
    Problems problems;
    benchmark::DoNotOptimize(read_odometry_csv(folder.path() / "o.csv", &problems));
  }
}
BENCHMARK(read_odometry_of_100000_rows)->Unit(benchmark::kMillisecond);

void sha256_of_a_megabyte(benchmark::State& state) {
  const std::string bytes(1U << 20U, 'x');
  for (auto _ : state) benchmark::DoNotOptimize(sha256_hex(bytes));
}
BENCHMARK(sha256_of_a_megabyte)->Unit(benchmark::kMillisecond);

void project_a_point(benchmark::State& state) {
  Camera camera = Camera::symmetric(1280, 720, 640.0);
  camera.lens = static_cast<Lens>(state.range(0));
  camera.distortion = {0.05, -0.02, 0.001, 0.001, 0.01};
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> J;
  double x = 0.1;
  for (auto _ : state) {
    benchmark::DoNotOptimize(x);
    benchmark::DoNotOptimize(camera.project({x, 0.2, 1.5}, &pixel, &J));
    benchmark::DoNotOptimize(J);
  }
}
BENCHMARK(project_a_point)->DenseRange(0, 2);

}  // namespace
}  // namespace rigproof

BENCHMARK_MAIN();
