#include "corner_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "as_estimated.h"
#include "inspect_pictures.h"
#include "rigproof/calib/estimate/board_shape.h"
#include "rigproof/calib/geometry/pnp.h"

namespace rigproof::inspect_detail {
namespace {

// A view, with where its camera is and the lens that this pose goes with.
struct PlacedView {
  const BoardView* view = nullptr;
  std::size_t index = 0;
  Rigid3 T_robot_camera;
  Camera camera;
  double lens_residual_px = 0.0;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // of the robot by its odometry: forward, left, yaw rate
  double readout_s = 0.0;                              // from the first row to the last; 0 if the pose is unknown
};

double readout_of(const Result& result, const RigCamera& camera) {
  for (const EstimatedQuantity& quantity : result.also_estimated)
    if (quantity.camera == camera.name && quantity.name == "readout_ms")
      return camera.readout_s + quantity.value / 1000.0;
  return camera.readout_s;
}

// A board as the robot sees it when the middle rows are read, and by how much the robot's velocity differs from its
// odometry's: forward, left [m/s], yaw rate [rad/s].
struct BoardInRobot {
  Rigid3 T_robot_board;
  Eigen::Vector3d velocity_error = Eigen::Vector3d::Zero();
};
using CornerJacobian = Eigen::Matrix<double, 2, 9>;

// A corner where its row is read, which is that of the corner as found.
// @param J by the error of T_robot_board, chart of transform_error(), and by that of the velocity
bool project(const PlacedView& placed, const BoardInRobot& seen, const Eigen::Vector3d& p_board, double row,
             Eigen::Vector2d* pixel, CornerJacobian* J = nullptr) {
  const double late_s = row_delay_s(row, placed.camera.height_px, placed.readout_s);
  const Eigen::Vector3d velocity = placed.velocity + seen.velocity_error;
  Vector6d twist;
  twist << velocity.x(), velocity.y(), 0.0, 0.0, 0.0, velocity.z();
  const Eigen::Vector3d turned = seen.T_robot_board.rotation * p_board;
  const Eigen::Vector3d p_robot = se3_exp(-late_s * twist) * (turned + seen.T_robot_board.translation);
  Eigen::Matrix<double, 2, 3> J_camera;
  if (!placed.camera.project(placed.T_robot_camera.inverse() * p_robot, pixel, &J_camera)) return false;
  if (J == nullptr) return true;
  const Eigen::Matrix<double, 2, 3> J_robot = J_camera * placed.T_robot_camera.rotation_matrix().transpose();
  Eigen::Matrix3d by_velocity = Eigen::Matrix3d::Identity();
  by_velocity.col(2) = Eigen::Vector3d::UnitZ().cross(p_robot);
  *J << J_robot, -J_robot * skew(turned), -late_s * J_robot * by_velocity;
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

// Gauss-Newton, weighted by the corners' covariances.
std::optional<BoardInRobot> fit_board(const std::vector<PlacedView>& views, const ShapedBoard& board) {
  const Eigen::Array3d sigmas(0.02, 0.02, 0.1);  // of the velocity: it need only not run away where rows tell nothing
  const std::optional<Rigid3> guess = first_guess(views, board.stated);
  if (!guess) return std::nullopt;
  BoardInRobot seen{*guess};
  for (int iteration = 0; iteration < 10; ++iteration) {
    Eigen::Matrix<double, 9, 9> H = Eigen::Matrix<double, 9, 9>::Zero();
    Eigen::Matrix<double, 9, 1> g = Eigen::Matrix<double, 9, 1>::Zero();
    H.diagonal().tail<3>() = sigmas.square().inverse();
    g.tail<3>() = -seen.velocity_error.array() / sigmas.square();
    for (const PlacedView& placed : views) {
      for (const CornerObservation& corner : placed.view->corners) {
        Eigen::Vector2d pixel;
        CornerJacobian J;
        if (!project(placed, seen, board.corner(corner.id), corner.pixel.y(), &pixel, &J)) continue;
        const Eigen::Matrix2d weight = corner.covariance_px2.inverse();
        H += J.transpose() * weight * J;
        g += J.transpose() * weight * (corner.pixel - pixel);
      }
    }
    const Eigen::Matrix<double, 9, 1> step = H.ldlt().solve(g);
    if (!step.allFinite()) return std::nullopt;
    seen.T_robot_board = apply_transform_error(seen.T_robot_board, step.head<6>());
    seen.velocity_error += step.tail<3>();
    if (step.norm() < 1e-10) break;
  }
  return seen;
}

void add_differences(const std::vector<PlacedView>& views, const ShapedBoard& board, CornerFit* fit) {
  const std::optional<BoardInRobot> seen = fit_board(views, board);
  if (!seen) return;
  ++fit->boards;
  for (const PlacedView& placed : views) {
    std::vector<Eigen::Vector2d>& differences = fit->differences[placed.index];
    for (const CornerObservation& corner : placed.view->corners) {
      Eigen::Vector2d pixel;
      const bool visible = project(placed, *seen, board.corner(corner.id), corner.pixel.y(), &pixel);
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

Eigen::Vector3d ShapedBoard::corner(int id) const {
  return ml::corner_of_board(stated, shape, stated.corner(id)).point;
}

std::optional<Rigid3> pose_of_board(const BoardView& view, const ShapedBoard& board, const Camera& camera) {
  const std::optional<BoardInRobot> seen = fit_board({{&view, 0, Rigid3(), camera}}, board);
  if (!seen) return std::nullopt;
  return seen->T_robot_board;
}

double CornerFit::shrink() const {
  return corners == 0
             ? 1.0
             : std::sqrt(std::max(0.0, 1.0 - 3.0 * static_cast<double>(boards) / static_cast<double>(corners)));
}

CornerFit fit_corners(const Observations& stated, const Result& result) {
  const Observations observations = as_estimated(stated, result);
  CornerFit fit;
  fit.differences.resize(observations.board_views.size());
  // Cameras with a pose share the board of a stop; any other camera has one of its own.
  std::map<std::tuple<int, int, int>, std::vector<PlacedView>> groups;  // stop, camera or -1, board
  for (std::size_t i = 0; i < observations.board_views.size(); ++i) {
    const BoardView& view = observations.board_views[i];
    const RigCamera& camera = observations.cameras[static_cast<std::size_t>(view.camera)];
    if (view.corners.size() < 4 || is_left_out(result, camera.name, view)) continue;
    const EstimatedTransform* pose = pose_of_camera(result, camera.name);
    PlacedView placed{&view, i, Rigid3(), camera.camera, camera.intrinsics_sigma.residual_px};
    if (pose != nullptr) {
      placed.T_robot_camera = pose->T_parent_child;
      placed.velocity = observations.stops[static_cast<std::size_t>(view.stop)].velocity;
      if (!placed.velocity.isZero(0.0)) placed.readout_s = readout_of(result, camera);
    }
    groups[{view.stop, pose == nullptr ? view.camera : -1, view.board}].push_back(placed);
  }
  const std::vector<Eigen::Vector4d> shapes = board_shapes(observations, result);
  for (const auto& [key, views] : groups) {
    const int board = std::get<2>(key);
    add_differences(views, {observations.board_at(board), shapes[static_cast<std::size_t>(board)]}, &fit);
  }
  for (double* sum : {&fit.rms_px, &fit.stated_px})
    *sum = std::sqrt(*sum / static_cast<double>(std::max<std::size_t>(1, 2 * fit.corners)));
  return fit;
}

}  // namespace rigproof::inspect_detail
