#include "measured_noise.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/error.h"
#include "rigproof/core/observations.h"

namespace rigproof {
namespace {

// Variances of measurements; one for all of them that holds as much information as they hold together.
class Pool {
 public:
  /// @param weight of the measurement's information beside another one of the same variance
  void add(double variance, double weight) {
    if (!(variance > 0.0)) return;
    weights_ += weight;
    information_ += weight / variance;
  }
  bool empty() const { return information_ == 0.0; }
  double sigma() const { return std::sqrt(weights_ / information_); }

 private:
  double weights_ = 0.0, information_ = 0.0;
};

// By camera of the observations.
class Measured {
 public:
  explicit Measured(const Observations& seen) : seen_(seen), noise_(seen.cameras.size()) {
    for (const BoardView& view : seen.board_views) add_corners(view);
    for (const PlaneObservation& plane : seen.ground_planes)
      if (const auto moments = ground_ray_moments(camera(plane.camera), plane.inverse_depth_plane))
        add(plane, *moments, &at(plane.camera).ground);
    add_board_planes(estimate_view_poses(seen));
  }

  // False where the camera saw no board.
  bool read(std::size_t index, GeometricNoise* noise) const {
    const Pools& pools = noise_[index];
    if (pools.corners.empty()) return false;
    noise->corner_sigma_px = pools.corners.sigma();
    if (!pools.ground.empty()) noise->ground_sigma_per_m = pools.ground.sigma();
    if (!pools.board.empty()) noise->board_sigma_per_m = pools.board.sigma();
    return true;
  }

 private:
  struct Pools {
    Pool corners, ground, board;
  };

  const Camera& camera(int index) const { return seen_.cameras[static_cast<std::size_t>(index)].camera; }
  Pools& at(int camera) { return noise_[static_cast<std::size_t>(camera)]; }

  void add_corners(const BoardView& view) {
    for (const CornerObservation& corner : view.corners)
      at(view.camera).corners.add(0.5 * corner.covariance_px2.trace(), 1.0);
  }

  void add_board_planes(const ViewPoses& views) {
    std::map<std::pair<int, int>, const ViewPose*> boards;
    for (const ViewPose& view : views.poses) boards[{view.stop, view.camera}] = &view;
    for (const PlaneObservation& plane : seen_.board_planes) {
      const auto board = boards.find({plane.stop, plane.camera});
      if (board == boards.end()) continue;
      const ViewPose& view = *board->second;
      add(plane, board_ray_moments(camera(plane.camera), seen_.board_at(view.board), view.T_camera_board),
          &at(plane.camera).board);
    }
  }

  // What the covariance says of 1/z at a pixel, if the pixels were independent: a near board holds more of them than a
  // far one.
  static void add(const PlaneObservation& plane, const RayMoments& moments, Pool* pool) {
    pool->add(moments.pixels * (plane.covariance_per_m2 * moments.mean).trace() / 3.0, moments.pixels);
  }

  const Observations& seen_;
  std::vector<Pools> noise_;
};

}  // namespace

std::vector<GeometricNoise> measured_noise(const std::filesystem::path& observations,
                                           const std::vector<RigCamera>& cameras) {
  const Observations seen = load_observations(observations);
  const Measured measured(seen);
  std::vector<GeometricNoise> noise(cameras.size());
  Problems problems;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const std::string& name = cameras[i].name;
    const auto problem = [&](const std::string& message) {
      problems.add({observations.string(), 0, "geometric.measured", name, message});
    };
    const auto same = [&name](const RigCamera& camera) { return camera.name == name; };
    const auto found = std::find_if(seen.cameras.begin(), seen.cameras.end(), same);
    if (found == seen.cameras.end()) {
      problem("is no camera of these observations");
    } else if (found->camera.width_px != cameras[i].camera.width_px ||
               found->camera.height_px != cameras[i].camera.height_px) {
      problem("has images of another size there");
    } else if (!measured.read(static_cast<std::size_t>(found - seen.cameras.begin()), &noise[i])) {
      problem("saw no board there");
    }
  }
  problems.throw_if_any();
  return noise;
}

}  // namespace rigproof
