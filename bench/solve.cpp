// How long the estimator takes: with its covariance, told the noise or told nothing, and how that grows with stops.
#include <benchmark/benchmark.h>

#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof {
namespace {

GeometricRun draw(int cameras, int stops, bool told) {
  GeometricConfig config;
  config.stops = stops;
  // More cameras than the reference rig has: copies of them, all of which see the board from every stop.
  const GeometricRig three = config.rig;
  config.rig.cameras.clear();
  config.rig.T_robot_camera.clear();
  for (int c = 0; c < cameras; ++c) {
    const std::size_t from = static_cast<std::size_t>(c % 3);
    config.rig.cameras.push_back(three.cameras[from]);
    config.rig.cameras.back().name = config.rig.cameras.back().folder = "camera" + std::to_string(c + 1);
    Rigid3 T = three.T_robot_camera[from];
    T.translation.z() += 0.05 * (c / 3);
    config.rig.T_robot_camera.push_back(T);
  }
  config.rig.min_cameras_per_stop = cameras;
  config.declare_odometry_model = config.declare_odometry_sigmas = told;
  return draw_geometric_run(config);
}

MlOptions options_of(bool told) {
  MlOptions options;
  if (!told) return options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
  options.estimate_corner_level = options.estimate_plane_level = false;
  return options;
}

void solve(benchmark::State& state, bool told) {
  const GeometricRun run = draw(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), told);
  const MlOptions options = options_of(told);
  for (auto iteration : state) benchmark::DoNotOptimize(estimate_maximum_likelihood(run.observations, options));
}
BENCHMARK_CAPTURE(solve, told, true)
    ->Args({3, 100})
    ->Args({3, 200})
    ->Args({3, 400})
    ->Args({8, 250})
    ->Args({8, 500})
    ->Args({8, 1000})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve, told_nothing, false)->Args({3, 100})->Args({8, 1000})->Unit(benchmark::kMillisecond);

// Noise told, and nothing said of lenses, board and depth: their errors are among the unknowns.
void solve_strangers(benchmark::State& state) {
  GeometricRun run = draw(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), true);
  run.observations.board.doubt();
  for (RigCamera& camera : run.observations.cameras) {
    camera.intrinsics_sigma = IntrinsicsSigma();
    camera.depth->noise.doubt_place_and_common_scale();
  }
  const MlOptions options = options_of(true);
  for (auto iteration : state) benchmark::DoNotOptimize(estimate_maximum_likelihood(run.observations, options));
}
BENCHMARK(solve_strangers)->Args({3, 100})->Args({8, 250})->Unit(benchmark::kMillisecond);

void view_poses(benchmark::State& state) {
  const GeometricRun run = draw(3, 100, true);
  for (auto iteration : state) benchmark::DoNotOptimize(estimate_view_poses(run.observations));
}
BENCHMARK(view_poses)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rigproof

BENCHMARK_MAIN();
