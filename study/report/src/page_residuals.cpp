#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "page_parts.h"
#include "rigproof/calib/geometry/pnp.h"

namespace rigproof::page_detail {
namespace {

// A view, with where its camera is and the lens that this pose goes with.
struct PlacedView {
  const BoardView* view = nullptr;
  std::size_t index = 0;
  Rigid3 T_robot_camera;
  Camera camera;
  double lens_residual_px = 0.0;
};

Camera lens_of(const Result& result, const RigCamera& camera) {
  for (const EstimatedLens& lens : result.lenses)
    if (lens.camera == camera.name) return lens.intrinsics;
  return camera.camera;
}

const EstimatedTransform* pose_of_camera(const Result& result, const std::string& name) {
  for (const EstimatedTransform& estimate : result.camera_to_robot)
    if (estimate.child == name && estimate.fully_observable()) return &estimate;
  return nullptr;
}

bool project(const PlacedView& placed, const Eigen::Vector3d& p_robot, Eigen::Vector2d* pixel,
             Eigen::Matrix<double, 2, 3>* J_pixel_robot = nullptr) {
  Eigen::Matrix<double, 2, 3> J_pixel_camera;
  if (!placed.camera.project(placed.T_robot_camera.inverse() * p_robot, pixel, &J_pixel_camera)) return false;
  if (J_pixel_robot != nullptr) *J_pixel_robot = J_pixel_camera * placed.T_robot_camera.rotation_matrix().transpose();
  return true;
}

std::optional<Rigid3> first_guess(const std::vector<PlacedView>& views, const Board& board) {
  const auto most = std::max_element(views.begin(), views.end(), [](const PlacedView& a, const PlacedView& b) {
    return a.view->corners.size() < b.view->corners.size();
  });
  const auto pose = estimate_board_pose(most->view->corners, board, most->camera);
  if (!pose) return std::nullopt;
  return most->T_robot_camera * pose->T_camera_board;
}

// Gauss-Newton over the error of T_robot_board in the chart of transform_error(), weighted by the corners' covariances.
std::optional<Rigid3> fit_board(const std::vector<PlacedView>& views, const Board& board) {
  std::optional<Rigid3> T = first_guess(views, board);
  for (int iteration = 0; T && iteration < 10; ++iteration) {
    Matrix6d H = Matrix6d::Zero();
    Vector6d g = Vector6d::Zero();
    for (const PlacedView& placed : views) {
      for (const CornerObservation& corner : placed.view->corners) {
        Eigen::Vector2d pixel;
        Eigen::Matrix<double, 2, 3> J_robot;
        if (!project(placed, *T * board.corner(corner.id), &pixel, &J_robot)) continue;
        Eigen::Matrix<double, 2, 6> J;
        J << J_robot, -J_robot * skew(T->rotation * board.corner(corner.id));
        const Eigen::Matrix2d weight = corner.covariance_px2.inverse();
        H += J.transpose() * weight * J;
        g += J.transpose() * weight * (corner.pixel - pixel);
      }
    }
    const Vector6d step = H.ldlt().solve(g);
    if (!step.allFinite()) return std::nullopt;
    T = apply_transform_error(*T, step);
    if (step.norm() < 1e-10) break;
  }
  return T;
}

void add_differences(const std::vector<PlacedView>& views, const Board& board, CornerFit* fit) {
  const std::optional<Rigid3> T_robot_board = fit_board(views, board);
  if (!T_robot_board) return;
  ++fit->boards;
  for (const PlacedView& placed : views) {
    std::vector<Eigen::Vector2d>& differences = fit->differences[placed.index];
    for (const CornerObservation& corner : placed.view->corners) {
      Eigen::Vector2d pixel;
      const bool visible = project(placed, *T_robot_board * board.corner(corner.id), &pixel);
      differences.push_back(visible ? Eigen::Vector2d(corner.pixel - pixel) : Eigen::Vector2d::Constant(std::nan("")));
      if (!visible) continue;
      ++fit->corners;
      fit->rms_px += differences.back().squaredNorm();
      fit->stated_px += corner.covariance_px2.trace() + 2.0 * placed.lens_residual_px * placed.lens_residual_px;
    }
  }
}

bool is_left_out(const Result& result, const std::string& camera, const BoardView& view) {
  for (const CameraUse& use : result.use)
    for (const Exclusion& exclusion : use.left_out)
      if (use.camera == camera && !exclusion.depth && exclusion.stop == view.stop && exclusion.file == view.file)
        return true;
  return false;
}

}  // namespace

CornerFit fit_corners(const Observations& observations, const Result& result) {
  CornerFit fit;
  fit.differences.resize(observations.board_views.size());
  // Cameras with a pose share the board of a stop; any other camera has one of its own.
  std::map<std::pair<int, int>, std::vector<PlacedView>> groups;
  for (std::size_t i = 0; i < observations.board_views.size(); ++i) {
    const BoardView& view = observations.board_views[i];
    const RigCamera& camera = observations.cameras[static_cast<std::size_t>(view.camera)];
    if (view.corners.size() < 4 || is_left_out(result, camera.name, view)) continue;
    const EstimatedTransform* pose = pose_of_camera(result, camera.name);
    groups[{view.stop, pose == nullptr ? view.camera : -1}].push_back(
        {&view, i, pose == nullptr ? Rigid3() : pose->T_parent_child, lens_of(result, camera),
         camera.intrinsics_sigma.residual_px});
  }
  for (const auto& [key, views] : groups) add_differences(views, observations.board, &fit);
  for (double* sum : {&fit.rms_px, &fit.stated_px})
    *sum = std::sqrt(*sum / static_cast<double>(std::max<std::size_t>(1, 2 * fit.corners)));
  return fit;
}

}  // namespace rigproof::page_detail
