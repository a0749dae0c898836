#include "inspect_reprojection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
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

using CornerJacobian = Eigen::Matrix<double, 2, 6>;

// A corner of a board that the source camera measured, in another camera's image.
// @param J by the error of T_source_board, chart of transform_error()
bool project(const Camera& camera, const Rigid3& T_camera_source, const Rigid3& T_source_board,
             const Eigen::Vector3d& p_board, Eigen::Vector2d* pixel, CornerJacobian* J) {
  const Eigen::Vector3d turned = T_source_board.rotation * p_board;
  Eigen::Matrix<double, 2, 3> J_camera;
  if (!camera.project(T_camera_source * (turned + T_source_board.translation), pixel, &J_camera)) return false;
  const Eigen::Matrix<double, 2, 3> J_source = J_camera * T_camera_source.rotation_matrix();
  *J << J_source, -J_source * skew(turned);
  return true;
}

// Of a corner's place in the image: the detector's, and what no lens model follows.
Eigen::Matrix2d corner_covariance(const CornerObservation& corner, const RigCamera& camera) {
  return corner.covariance_px2 + std::pow(camera.intrinsics_sigma.residual_px, 2) * Eigen::Matrix2d::Identity();
}

// Of T_source_board as the view measures it, chart of transform_error().
Matrix6d board_covariance(const BoardView& view, const ShapedBoard& board, const RigCamera& camera,
                          const Rigid3& T_source_board) {
  Matrix6d H = Matrix6d::Zero();
  for (const CornerObservation& corner : view.corners) {
    Eigen::Vector2d pixel;
    CornerJacobian J;
    if (project(camera.camera, Rigid3(), T_source_board, board.corner(corner.id), &pixel, &J))
      H += J.transpose() * corner_covariance(corner, camera).inverse() * J;
  }
  return H.ldlt().solve(Matrix6d::Identity());
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

  // Adds the residuals of the target view, and the variances that are to be expected of them to expected_px.
  void add(const BoardView& source, const BoardView& target, CarriedOver* carried) const {
    const RigCamera &from = camera_of(source), &to = camera_of(target);
    const ShapedBoard board{observations_.board_of(source), shapes_[static_cast<std::size_t>(source.board)]};
    const std::optional<Rigid3> T_source_board = pose_of_board(source, board, from.camera);
    if (!T_source_board) return;
    const Rigid3 T_target_source = poses_.at(target.camera).inverse() * odometry(target.stop).inverse() *
                                   odometry(source.stop) * poses_.at(source.camera);
    const Matrix6d measured = board_covariance(source, board, from, *T_source_board);
    for (const CornerObservation& corner : target.corners) {
      Eigen::Vector2d projected;
      CornerJacobian J;
      if (!project(to.camera, T_target_source, *T_source_board, board.corner(corner.id), &projected, &J)) continue;
      carried->residuals.push_back({corner.pixel, projected - corner.pixel});
      carried->expected_px += 0.5 * (corner_covariance(corner, to) + J * measured * J.transpose()).trace();
    }
  }

 private:
  const RigCamera& camera_of(const BoardView& view) const {
    return observations_.cameras[static_cast<std::size_t>(view.camera)];
  }

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
    carry_over.add(*source, view, &carried);
  }
  const double count = static_cast<double>(std::max<std::size_t>(1, carried.residuals.size()));
  carried.expected_px = std::sqrt(carried.expected_px / count);
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
  picture.stated_sigma_px = carried.expected_px;
  picture.title = result.method + ", " + name + ": reprojected minus detected corners";
  picture.subtitle = "board of another camera at the same stop (" + std::to_string(carried.from_same_stop) +
                     " views), or of another stop by odometry (" + std::to_string(carried.from_other_stops) +
                     "); ring and curve: what detector and lens of both views let expect";
  return draw_residuals(picture, folder / ("reprojection_" + result.method + "_" + name + ".png"));
}

}  // namespace rigproof::inspect_detail
