#include "inspect_reprojection.h"

#include <map>

#include "as_estimated.h"
#include "corner_fit.h"
#include "inspect_pictures.h"

namespace rigproof::inspect_detail {
namespace {

// Poses of the cameras in the robot frame that a result answers completely, by index in the observations.
std::map<int, Rigid3> poses_of(const Observations& observations, const Result& result) {
  std::map<int, Rigid3> poses;
  for (std::size_t i = 0; i < observations.cameras.size(); ++i)
    if (const EstimatedTransform* estimate = pose_of_camera(result, observations.cameras[i].name))
      poses[static_cast<int>(i)] = estimate->T_parent_child;
  return poses;
}

// Carries the board, as one view measures it, to another view through the calibrated rig and the odometry between the
// two stops. Nothing of the target view enters, so every error of the calibration shows.
class CarryOver {
 public:
  CarryOver(const Observations& observations, const Result& result)
      : observations_(as_estimated(observations, result)),
        shapes_(board_shapes(observations, result)),
        poses_(poses_of(observations, result)) {}

  const Observations& observations() const { return observations_; }

  bool knows(std::size_t camera) const { return poses_.count(static_cast<int>(camera)) > 0; }

  // The view to carry over from: another camera at the same stop, else the nearest earlier or later view.
  const BoardView* source_for(const BoardView& target) const {
    const BoardView* best = nullptr;
    for (const BoardView& view : observations_.board_views) {
      if (&view == &target || view.board != target.board || poses_.count(view.camera) == 0) continue;
      if (best == nullptr || std::abs(view.stop - target.stop) < std::abs(best->stop - target.stop)) best = &view;
    }
    return best;
  }

  void add(const BoardView& source, const BoardView& target, std::vector<Residual>* residuals) const {
    const Camera& source_camera = observations_.cameras[static_cast<std::size_t>(source.camera)].camera;
    const ShapedBoard board{observations_.board_of(source), shapes_[static_cast<std::size_t>(source.board)]};
    const std::optional<Rigid3> T_source_board = pose_of_board(source, board, source_camera);
    if (!T_source_board) return;
    const Camera& target_camera = observations_.cameras[static_cast<std::size_t>(target.camera)].camera;
    const Rigid3 T_target_board = poses_.at(target.camera).inverse() * odometry(target.stop).inverse() *
                                  odometry(source.stop) * poses_.at(source.camera) * *T_source_board;
    for (const CornerObservation& corner : target.corners) {
      Eigen::Vector2d projected;
      if (target_camera.project(T_target_board * board.corner(corner.id), &projected))
        residuals->push_back({corner.pixel, projected - corner.pixel});
    }
  }

 private:
  Rigid3 odometry(int stop) const {
    const Stop& s = observations_.stops[static_cast<std::size_t>(stop)];
    return planar_pose(s.x_m, s.y_m, s.yaw_rad);
  }

  const Observations observations_;
  const std::vector<Eigen::Vector4d> shapes_;
  const std::map<int, Rigid3> poses_;
};

}  // namespace

CarriedOver carried_over(const Observations& observations, const Result& result, std::size_t camera) {
  const CarryOver carry_over(observations, result);
  CarriedOver carried;
  if (!carry_over.knows(camera)) return carried;
  for (const BoardView& view : carry_over.observations().board_views) {
    if (view.camera != static_cast<int>(camera)) continue;
    const BoardView* source = carry_over.source_for(view);
    if (source == nullptr) continue;
    ++(source->stop == view.stop ? carried.from_same_stop : carried.from_other_stops);
    carry_over.add(*source, view, &carried.residuals);
  }
  return carried;
}

Written draw_reprojection(const InspectInput& input, const Result& result, std::size_t camera,
                          const std::filesystem::path& folder) {
  const CarriedOver carried = carried_over(input.observations, result, camera);
  if (carried.residuals.empty()) return std::nullopt;
  const std::string& name = input.observations.cameras[camera].name;
  ResidualPicture picture;
  picture.camera = camera;
  picture.image = input.observations.cameras[camera].camera;
  picture.residuals = carried.residuals;
  picture.title = result.method + ", " + name + ": reprojected minus detected corners";
  picture.subtitle = "board carried over by the calibration: " + std::to_string(carried.from_same_stop) +
                     " views from another camera at the same stop, " + std::to_string(carried.from_other_stops) +
                     " from another stop by odometry";
  return draw_residuals(picture, folder / ("reprojection_" + result.method + "_" + name + ".png"));
}

}  // namespace rigproof::inspect_detail
