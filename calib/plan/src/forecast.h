// What a stop would see and how much it would tell, before the robot goes there.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "floor.h"
#include "rigproof/calib/diagnose/basis.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/arrow_system.h"
#include "rigproof/calib/estimate/noise.h"
#include "rigproof/calib/estimate/state.h"
#include "rigproof/calib/plan/suggest.h"

namespace rigproof::suggest {

/// What calibration knows so far: the estimate of `ml` and what its uncertainty is stated from.
struct CalibrationSoFar {
  MlEstimate estimate;
  ml::Basis basis;
  std::vector<bool> has_pose;  ///< cameras that saw the board
  bool determined = false;     ///< the poses of all these, whole
};
/// Throws Error if no camera ever saw the board.
CalibrationSoFar calibration_so_far(const Observations& observations, const MlOptions& options = {});

/// Of several boards in the world.
inline const Rigid3& pose_of_board(const CalibrationState& state, int board) {
  return board == 0 ? state.T_world_board : state.T_world_more_boards[static_cast<std::size_t>(board) - 1];
}

/// Predicts what the cameras see from a place: views, planes and odometry without noise, each with the covariance that
/// the same camera's nearest view so far has.
class Foresight {
 public:
  Foresight(const CalibrationSoFar& knowledge, const SuggestOptions& options);

  /// Boards that were seen: where the others stand nobody knows.
  const std::vector<int>& boards() const { return boards_; }
  /// Cameras that see a whole board, not too obliquely.
  std::vector<int> cameras_with_board(const Rigid3& T_world_robot) const;
  /// The observations so far as they would be without noise if the estimate were true, so that predicted stops do not
  /// contradict them. `levels` are written as declared noise.
  Observations as_expected(const ml::NoiseLevels& levels) const;
  /// Appends the stop. The odometry continues from the observations' last stop, which stands at `T_world_before`.
  void append_stop(const Rigid3& T_world_before, const Rigid3& T_world_robot, Observations* observations) const;

 private:
  // A camera with a whole board in its image: of several the one with most corners.
  struct Sight {
    int camera, board;
  };
  std::vector<Sight> sights(const Rigid3& T_world_robot) const;
  bool sees_board(const Sight& sight, const Rigid3& T_camera_board) const;
  Stop stop_after(const Stop* before, const Rigid3& T_world_before, const Rigid3& T_world_robot) const;
  Eigen::Vector3d ground_seen(int camera, const Rigid3& T_world_robot) const;
  Eigen::Vector3d board_plane_seen(int camera, const Rigid3& T_camera_board) const;
  Rigid3 T_camera_board(const Sight& sight, const Rigid3& T_world_robot) const;
  BoardView board_view(int stop, const Sight& sight, const Rigid3& T_camera_board) const;
  void append_board_plane(int stop, int camera, const Rigid3& T_camera_board, Observations* observations) const;

  const CalibrationSoFar& knowledge_;
  double max_obliquity_rad_;
  double margin_share_;
  std::vector<int> boards_;
  // Of each camera: where boards were in its views and with which sigma its corners were found; the covariance of its
  // ground planes, if it usually sees the ground; where boards were in its board planes, and their covariance.
  struct Seen {
    Eigen::Vector3d board_m;
    Eigen::Matrix3d covariance;  // corners: only the upper left two
  };
  std::vector<std::vector<Seen>> corners_, board_planes_;
  std::vector<std::optional<Eigen::Matrix3d>> ground_;
};

/// Noise levels of stops that are still to come. How long their paths will be is unknown, so every increment counts as
/// uncertain as the average one so far.
ml::NoiseLevels expected_levels(const ml::Basis& basis);

/// The information of one stop by itself: on its pose and on the globals.
struct StopInformation {
  ml::RobotPose pose;
  Matrix6d diagonal;
  Eigen::MatrixXd pose_global;
  Eigen::MatrixXd global;
};

/// The information of all stops so far, condensed to the last one and the globals; stops are added in the order of
/// driving.
class Forecast {
 public:
  explicit Forecast(const CalibrationSoFar& knowledge);

  const ml::NoiseLevels& levels() const { return levels_; }  ///< of what is yet to be driven
  StopInformation information_of(const Foresight& foresight, const Place& place) const;
  /// Information on the globals with these stops added. Absent if it is singular in the poses.
  std::optional<Eigen::MatrixXd> with_stops(const std::vector<const StopInformation*>& stops) const;
  /// Covariance of the cameras (chart of transform_error(), six a camera); open directions count as one metre and one
  /// radian. Only of cameras that saw the board, as measured from the point about which the robot turns.
  std::optional<Eigen::MatrixXd> regular_covariance(const std::vector<const StopInformation*>& stops) const;
  /// No stop tells more of where the turning point lies.
  enum class Errors { kAll, kBesideTurningPoint };
  /// Standard deviations of every camera that saw the board, absent where nothing determines them.
  std::vector<AxisSigmas> sigmas(const std::vector<const StopInformation*>& stops, Errors errors = Errors::kAll) const;

 private:
  ml::ArrowSystem linearised(const Observations& observations, const ml::NoiseLevels& levels,
                             const ml::State& state) const;
  void add_common_errors(Errors errors, Eigen::MatrixXd* joint) const;
  void link(const ml::RobotPose& from, const ml::RobotPose& to, int index, ml::ArrowSystem* system) const;

  const CalibrationSoFar& knowledge_;
  ml::State state_;
  ml::NoiseLevels levels_;
  ml::Priors priors_;
  ml::Layout layout_;
  ml::ArrowSystem base_;  // one pose: the last stop
  bool first_is_last_;
};

}  // namespace rigproof::suggest
