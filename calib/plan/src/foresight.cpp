// What the cameras would see from a place.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "forecast.h"
#include "rigproof/core/error.h"
#include "rigproof/core/median.h"

namespace rigproof::suggest {
namespace {

constexpr double kWhiteBorder_m = 0.03;

Eigen::Matrix3d corner_covariance(const BoardView& view) {
  std::vector<double> variances;
  for (const CornerObservation& corner : view.corners) variances.push_back(0.5 * corner.covariance_px2.trace());
  return median(std::move(variances)) * Eigen::Matrix3d::Identity();
}

// The covariance of a camera's ground planes, if it has one at half of its stops at least.
std::optional<Eigen::Matrix3d> usual_ground(const Observations& observations, int camera) {
  std::vector<Eigen::Matrix3d> covariances;
  for (const PlaneObservation& plane : observations.ground_planes)
    if (plane.camera == camera) covariances.push_back(plane.covariance_per_m2);
  if (covariances.empty() || 2 * covariances.size() < observations.stops.size()) return std::nullopt;
  const auto middle = covariances.begin() + static_cast<std::ptrdiff_t>(covariances.size() / 2);
  std::nth_element(covariances.begin(), middle, covariances.end(),
                   [](const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) { return a.trace() < b.trace(); });
  return *middle;
}

// The closed form in the place of the estimate, in the same world.
void start_over(const Observations& observations, const InitialGuess& guess, MlEstimate* estimate) {
  CalibrationState* state = &estimate->state;
  const Stop& first = observations.stops.front();
  const bool absolute = estimate->noise.law.model == OdometryModel::kPerPose;  // its world is the odometry's
  const Rigid3 T_world_guess = absolute ? planar_pose(first.x_m, first.y_m, first.yaw_rad) : Rigid3();
  for (std::size_t c = 0; c < guess.T_robot_camera.size(); ++c)
    if (guess.T_robot_camera[c]) state->T_robot_camera[c] = *guess.T_robot_camera[c];
  state->T_world_board = T_world_guess * *guess.T_world_board;
  state->T_world_more_boards.clear();
  for (const Rigid3& T : guess.T_world_more_boards) state->T_world_more_boards.push_back(T_world_guess * T);
  for (std::size_t i = 0; i < guess.T_world_robot.size(); ++i)
    state->T_world_robot[i] = T_world_guess * guess.T_world_robot[i];
  state->odometry_scale = state->odometry_yaw_factor = 1.0;
  std::fill(state->depth_scale.begin(), state->depth_scale.end(), 1.0);
}

// What is open in a planar drive is where on the robot the rig sits: a planar motion D of all cameras in the robot,
// with all robot poses moved by D^-1, changes no image. Nobody mounts cameras metres away: among those that the
// odometry allows the motion is taken that brings them near the robot's middle, looking ahead rather than back.
class RigPlacement {
 public:
  RigPlacement(const ml::Basis& basis, const std::vector<bool>& has_pose, CalibrationState* state) : state_(*state) {
    const Observations& observations = basis.used;
    const ml::NoiseLevels nominal, expected = expected_levels(basis);
    sigma_xy_m_ = std::max(nominal.odometry_xy_m, expected.odometry_xy_m);
    sigma_yaw_rad_ = std::max(nominal.odometry_yaw_rad, expected.odometry_yaw_rad);
    for (std::size_t i = 0; i + 1 < observations.stops.size(); ++i) {
      const Stop &a = observations.stops[i], &b = observations.stops[i + 1];
      measured_.push_back(planar_pose(a.x_m, a.y_m, a.yaw_rad).inverse() * planar_pose(b.x_m, b.y_m, b.yaw_rad));
    }
    double cameras = 0.0;
    for (std::size_t c = 0; c < has_pose.size(); ++c) {
      if (!has_pose[c]) continue;
      middle_ += state_.T_robot_camera[c].translation;
      ahead_ += state_.T_robot_camera[c].rotation * Eigen::Vector3d::UnitZ();
      cameras += 1.0;
    }
    middle_ /= cameras;
  }

  void apply() {
    Eigen::Vector3d d = Eigen::Vector3d::Zero();
    for (int iteration = 0; iteration < 20; ++iteration) {
      const Eigen::VectorXd r = residuals(d);
      Eigen::MatrixXd J(r.size(), 3);
      constexpr double kStep = 1e-5;
      for (int k = 0; k < 3; ++k) J.col(k) = (residuals(d + kStep * Eigen::Vector3d::Unit(k)) - r) / kStep;
      const Eigen::Vector3d step = (J.transpose() * J).ldlt().solve(J.transpose() * r);
      d -= step;
      if (step.norm() < 1e-6) break;
    }
    const Rigid3 D = planar_pose(d.x(), d.y(), d.z());
    for (Rigid3& T : state_.T_robot_camera) T = D * T;
    for (Rigid3& T : state_.T_world_robot) T = T * D.inverse();
  }

 private:
  Eigen::VectorXd residuals(const Eigen::Vector3d& d) const {
    constexpr double kMiddle_m = 0.3, kAhead_rad = 1.5;
    const Rigid3 D = planar_pose(d.x(), d.y(), d.z());
    Eigen::VectorXd r(3 * static_cast<Eigen::Index>(measured_.size()) + 3);
    for (std::size_t i = 0; i < measured_.size(); ++i) {
      const Rigid3 motion = D * state_.T_world_robot[i].inverse() * state_.T_world_robot[i + 1] * D.inverse();
      const Eigen::Vector2d shift = (motion.translation - measured_[i].translation).head<2>() / sigma_xy_m_;
      const double turn = wrap_angle(yaw_of(motion) - yaw_of(measured_[i])) / sigma_yaw_rad_;
      r.segment<3>(3 * static_cast<Eigen::Index>(i)) << shift, turn;
    }
    const Eigen::Vector3d ahead = D.rotation * ahead_;
    r.tail<3>() << (D * middle_).head<2>() / kMiddle_m, std::atan2(ahead.y(), ahead.x()) / kAhead_rad;
    return r;
  }

  CalibrationState& state_;
  double sigma_xy_m_ = 0.0, sigma_yaw_rad_ = 0.0;
  std::vector<Rigid3> measured_;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero(), ahead_ = Eigen::Vector3d::Zero();
};

template <typename Seen>
const Seen* nearest(const std::vector<Seen>& seen, const Eigen::Vector3d& board_m) {
  const auto closer = [&board_m](const Seen& a, const Seen& b) {
    return (a.board_m - board_m).squaredNorm() < (b.board_m - board_m).squaredNorm();
  };
  const auto best = std::min_element(seen.begin(), seen.end(), closer);
  return best == seen.end() ? nullptr : &*best;
}

// Which board a plane is of: that of the view beside it, or the only one.
class BoardsInViews {
 public:
  explicit BoardsInViews(const Observations& observations) : only_one_(observations.boards() == 1) {
    for (const BoardView& view : observations.board_views) boards_[{view.stop, view.camera}] = view.board;
  }
  std::optional<int> of(const PlaneObservation& plane) const {
    const auto found = boards_.find({plane.stop, plane.camera});
    if (found != boards_.end()) return found->second;
    return only_one_ ? std::optional(0) : std::nullopt;
  }

 private:
  bool only_one_;
  std::map<std::pair<int, int>, int> boards_;  // by stop and camera
};

bool all_determined(const Result& result) {
  const std::vector<EstimatedTransform>& cameras = result.camera_to_robot;
  return !cameras.empty() &&
         std::all_of(cameras.begin(), cameras.end(), [](const EstimatedTransform& t) { return t.fully_observable(); });
}

}  // namespace

CalibrationSoFar calibration_so_far(const Observations& observations, const MlOptions& options) {
  std::optional<ml::Basis> basis;
  MlEstimate estimate = ml::estimate_with_basis(observations, options, &basis);
  if (!basis) {
    const std::vector<Finding>& reasons = estimate.result.reasons;
    throw FindingError("suggest", reasons.empty() ? Finding("poses.undetermined") : reasons.front());
  }
  const bool determined = all_determined(estimate.result);
  CalibrationSoFar knowledge{std::move(estimate), std::move(*basis), {}, determined};
  const InitialGuess& guess = knowledge.basis.guess;
  for (const std::optional<Rigid3>& T : guess.T_robot_camera) knowledge.has_pose.push_back(T.has_value());
  if (determined) return knowledge;
  start_over(knowledge.basis.used, guess, &knowledge.estimate);
  RigPlacement(knowledge.basis, knowledge.has_pose, &knowledge.estimate.state).apply();
  return knowledge;
}

Foresight::Foresight(const CalibrationSoFar& knowledge, const SuggestOptions& options)
    : knowledge_(knowledge), max_obliquity_rad_(options.max_obliquity_rad) {
  // Where x, y or yaw are open, the board will not be quite where it is expected.
  margin_share_ = knowledge.determined ? 0.03 : 0.12;
  const Observations& observations = knowledge.basis.used;
  const CalibrationState& state = knowledge.estimate.state;
  corners_.resize(observations.cameras.size());
  board_planes_.resize(observations.cameras.size());
  const auto board_m = [&](int stop, int camera, int board) -> Eigen::Vector3d {
    return T_camera_board({camera, board}, state.T_world_robot[static_cast<std::size_t>(stop)]).translation;
  };
  std::set<int> boards;
  for (const BoardView& view : observations.board_views) {
    if (view.corners.empty()) continue;
    boards.insert(view.board);
    corners_[static_cast<std::size_t>(view.camera)].push_back(
        {board_m(view.stop, view.camera, view.board), corner_covariance(view)});
  }
  if (boards.empty()) boards.insert(0);  // no view counts: it stands where the closed form has it
  boards_.assign(boards.begin(), boards.end());
  const BoardsInViews in_views(observations);
  for (const PlaneObservation& plane : observations.board_planes)
    if (const std::optional<int> board = in_views.of(plane))
      board_planes_[static_cast<std::size_t>(plane.camera)].push_back(
          {board_m(plane.stop, plane.camera, *board), plane.covariance_per_m2});
  for (int c = 0; c < static_cast<int>(observations.cameras.size()); ++c)
    ground_.push_back(usual_ground(observations, c));
}

bool Foresight::sees_board(const Sight& sight, const Rigid3& T) const {
  const Board& board = knowledge_.basis.used.board_at(sight.board);
  const Camera& lens = knowledge_.basis.used.cameras[static_cast<std::size_t>(sight.camera)].camera;
  const Eigen::Vector3d centre = T * board.centre();
  const Eigen::Vector3d normal = T.rotation * Eigen::Vector3d::UnitZ();
  if (normal.dot(centre.normalized()) < std::cos(max_obliquity_rad_)) return false;
  const double margin_px = margin_share_ * std::min(lens.width_px, lens.height_px);
  const std::vector<Eigen::Vector3d> outline = board.outline();
  return std::all_of(outline.begin(), outline.end(), [&](const Eigen::Vector3d& corner) {
    const Eigen::Vector3d outwards = corner - board.centre();
    Eigen::Vector2d pixel;
    return lens.project(T * (corner + kWhiteBorder_m * outwards.normalized()), &pixel) &&
           lens.contains(pixel, margin_px);
  });
}

std::vector<Foresight::Sight> Foresight::sights(const Rigid3& T_world_robot) const {
  const Observations& used = knowledge_.basis.used;
  std::vector<Sight> sights;
  for (std::size_t c = 0; c < used.cameras.size(); ++c) {
    if (!knowledge_.has_pose[c] || corners_[c].empty()) continue;
    std::optional<Sight> most;
    for (const int board : boards_) {
      const Sight sight{static_cast<int>(c), board};
      if (most && used.board_at(board).corner_count() <= used.board_at(most->board).corner_count()) continue;
      if (sees_board(sight, T_camera_board(sight, T_world_robot))) most = sight;
    }
    if (most) sights.push_back(*most);
  }
  return sights;
}

std::vector<int> Foresight::cameras_with_board(const Rigid3& T_world_robot) const {
  std::vector<int> cameras;
  for (const Sight& sight : sights(T_world_robot)) cameras.push_back(sight.camera);
  return cameras;
}

BoardView Foresight::board_view(int stop, const Sight& sight, const Rigid3& T) const {
  const std::size_t c = static_cast<std::size_t>(sight.camera);
  const Board& board = knowledge_.basis.used.board_at(sight.board);
  BoardView view;
  view.stop = stop;
  view.camera = sight.camera;
  view.board = sight.board;
  const Seen* like = nearest(corners_[c], T.translation);
  for (int id = 0; id < board.corner_count(); ++id) {
    CornerObservation corner;
    corner.id = id;
    corner.covariance_px2 = like->covariance.topLeftCorner<2, 2>();
    if (knowledge_.basis.used.cameras[c].camera.project(T * board.corner(id), &corner.pixel))
      view.corners.push_back(corner);
  }
  return view;
}

Rigid3 Foresight::T_camera_board(const Sight& sight, const Rigid3& T_world_robot) const {
  const CalibrationState& state = knowledge_.estimate.state;
  return (T_world_robot * state.T_robot_camera[static_cast<std::size_t>(sight.camera)]).inverse() *
         pose_of_board(state, sight.board);
}

Eigen::Vector3d Foresight::board_plane_seen(int camera, const Rigid3& T) const {
  const Eigen::Vector3d normal = T.rotation * Eigen::Vector3d::UnitZ();
  const double scale = knowledge_.estimate.state.depth_scale[static_cast<std::size_t>(camera)];
  return normal / (normal.dot(T.translation) * scale);
}

Eigen::Vector3d Foresight::ground_seen(int camera, const Rigid3& T_world_robot) const {
  const CalibrationState& state = knowledge_.estimate.state;
  const std::size_t c = static_cast<std::size_t>(camera);
  const Rigid3 T_camera_world = (T_world_robot * state.T_robot_camera[c]).inverse();
  const Eigen::Vector3d up = T_camera_world.rotation * Eigen::Vector3d::UnitZ();
  return up / (up.dot(T_camera_world.translation) * state.depth_scale[c]);
}

void Foresight::append_board_plane(int stop, int camera, const Rigid3& T, Observations* observations) const {
  const Seen* like = nearest(board_planes_[static_cast<std::size_t>(camera)], T.translation);
  if (like == nullptr) return;
  PlaneObservation plane;
  plane.stop = stop;
  plane.camera = camera;
  plane.inverse_depth_plane = board_plane_seen(camera, T);
  plane.covariance_per_m2 = like->covariance;
  observations->board_planes.push_back(plane);
}

Stop Foresight::stop_after(const Stop* before, const Rigid3& T_world_before, const Rigid3& T_world_robot) const {
  const CalibrationState& state = knowledge_.estimate.state;
  Rigid3 T = T_world_robot;
  if (knowledge_.estimate.noise.law.model == OdometryModel::kPerIncrement && before != nullptr) {
    // Scale and yaw factor are those of the point about which the robot turns.
    const Eigen::Vector2d& centre_m = knowledge_.basis.used.odometry_noise.rotation_centre_m;
    const Rigid3 T_robot_point = planar_pose(centre_m.x(), centre_m.y(), 0.0);
    const Rigid3 motion = (T_world_before * T_robot_point).inverse() * T_world_robot * T_robot_point;
    T = planar_pose(before->x_m, before->y_m, before->yaw_rad) * T_robot_point *
        planar_pose(state.odometry_scale * motion.translation.x(), state.odometry_scale * motion.translation.y(),
                    state.odometry_yaw_factor * yaw_of(motion)) *
        T_robot_point.inverse();
  }
  constexpr double kStopTime_s = 2.0;
  const double stamp_s = before != nullptr ? before->stamp_s + kStopTime_s : 0.0;
  return {stamp_s, T.translation.x(), T.translation.y(), yaw_of(T), 0.0};
}

Observations Foresight::as_expected(const ml::NoiseLevels& levels) const {
  const CalibrationState& state = knowledge_.estimate.state;
  Observations expected = knowledge_.basis.used;
  expected.odometry_noise.model = levels.law.model;
  expected.odometry_noise.sigma_xy_m = levels.odometry_xy_m;
  expected.odometry_noise.sigma_yaw_rad = levels.odometry_yaw_rad;
  const auto pose = [&state](int stop) { return state.T_world_robot[static_cast<std::size_t>(stop)]; };
  for (std::size_t i = 0; i < expected.stops.size(); ++i)
    expected.stops[i] = stop_after(i > 0 ? &expected.stops[i - 1] : nullptr, state.T_world_robot[i > 0 ? i - 1 : 0],
                                   state.T_world_robot[i]);
  for (BoardView& view : expected.board_views) {
    const Camera& lens = expected.cameras[static_cast<std::size_t>(view.camera)].camera;
    const Rigid3 T = T_camera_board({view.camera, view.board}, pose(view.stop));
    for (CornerObservation& corner : view.corners)
      lens.project(T * expected.board_of(view).corner(corner.id), &corner.pixel);
  }
  const BoardsInViews in_views(expected);
  for (PlaneObservation& plane : expected.ground_planes)
    plane.inverse_depth_plane = ground_seen(plane.camera, pose(plane.stop));
  for (PlaneObservation& plane : expected.board_planes)
    if (const std::optional<int> board = in_views.of(plane))
      plane.inverse_depth_plane =
          board_plane_seen(plane.camera, T_camera_board({plane.camera, *board}, pose(plane.stop)));
  for (std::size_t b = 0; b < expected.more_boards.size(); ++b)
    if (std::optional<BoardPlace>& place = expected.more_boards[b].place)
      place->T_first_board = state.T_world_board.inverse() * state.T_world_more_boards[b];
  return expected;
}

void Foresight::append_stop(const Rigid3& T_world_before, const Rigid3& T_world_robot,
                            Observations* observations) const {
  const int stop = static_cast<int>(observations->stops.size());
  const Stop* before = observations->stops.empty() ? nullptr : &observations->stops.back();
  observations->stops.push_back(stop_after(before, T_world_before, T_world_robot));
  for (const Sight& sight : sights(T_world_robot)) {
    const Rigid3 T = T_camera_board(sight, T_world_robot);
    observations->board_views.push_back(board_view(stop, sight, T));
    append_board_plane(stop, sight.camera, T, observations);
  }
  for (std::size_t c = 0; c < ground_.size(); ++c) {
    if (!ground_[c] || !knowledge_.has_pose[c]) continue;
    PlaneObservation plane;
    plane.stop = stop;
    plane.camera = static_cast<int>(c);
    plane.inverse_depth_plane = ground_seen(plane.camera, T_world_robot);
    plane.covariance_per_m2 = *ground_[c];
    observations->ground_planes.push_back(plane);
  }
}

}  // namespace rigproof::suggest
