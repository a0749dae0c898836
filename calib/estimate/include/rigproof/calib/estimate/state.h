// The unknowns of the maximum-likelihood method, and their places in the vector of unknowns.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <vector>

#include "rigproof/calib/estimate/information.h"
#include "rigproof/calib/estimate/unknowns.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/rigid3.h"

namespace rigproof::ml {

/// T_world_robot = (x, y, 0; Rz(yaw)) * (0, 0, height; Exp(roll, pitch, 0)): a planar pose and the suspension's slack.
struct RobotPose {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double height_m = 0.0;
  double roll_rad = 0.0;
  double pitch_rad = 0.0;

  Eigen::Quaterniond tilt() const { return so3_exp({roll_rad, pitch_rad, 0.0}); }
  Rigid3 transform() const { return Rigid3(rotation_z(yaw_rad) * tilt(), {x_m, y_m, height_m}); }
  static RobotPose from_transform(const Rigid3& T_world_robot);
};

/// Bodies that have another pose from a stop on: something was knocked, or a board was moved, during the drive.
struct Step {
  static constexpr int kBoard = -1;  ///< the first of the boards
  static constexpr int board(int b) { return kBoard - b; }
  static constexpr bool is_board(int body) { return body < 0; }
  static constexpr int board_of(int body) { return kBoard - body; }
  int split = 0;            ///< the first stop at which they have it
  std::vector<int> bodies;  ///< cameras, boards
};

/// What the odometry's increments are off by: measured = scale * true way; = yaw_factor * true turn + veer * way
/// forward.
struct OdometryErrors {
  double scale = 1.0, yaw_factor = 1.0;
  double veer_rad_per_m = 0.0;
};

struct State {
  std::vector<Rigid3> T_robot_camera;
  std::vector<Rigid3> T_world_board = {Rigid3()};  ///< of each board
  std::vector<RobotPose> poses;
  NuisanceValues nuisances;
  std::vector<Rigid3> second_poses;  ///< of a step's bodies from its split on, in their order

  /// The pose of a camera in the robot or of a board in the world, as at the first stop.
  const Rigid3& first_pose(int body) const {
    return Step::is_board(body) ? T_world_board[static_cast<std::size_t>(Step::board_of(body))]
                                : T_robot_camera[static_cast<std::size_t>(body)];
  }
  double odometry_scale() const { return 1.0 + nuisances.of(Nuisance::kOdometryFactors)[0]; }
  double odometry_yaw_factor() const { return 1.0 + nuisances.of(Nuisance::kOdometryFactors)[1]; }
  double odometry_veer() const { return nuisances.of(Nuisance::kOdometryVeer)[0]; }
  OdometryErrors odometry_errors() const { return {odometry_scale(), odometry_yaw_factor(), odometry_veer()}; }
};

/// The state of values as they are reported; depth scales of one where none are given, all else as declared.
State state_from(const CalibrationState& values);

/// Unknowns: six a pose (x, y, yaw, height, roll, pitch); then the globals: six a camera, six a board, the rows of the
/// table of nuisances of which any has a prior, and six of each body of a step. Rotations move by R <- R Exp(phi).
class Layout {
 public:
  static Layout of(const Observations& observations, const Priors& priors);
  void add(const Step& step);
  int poses = 0;
  int cameras = 0;
  int boards = 1;
  int camera(int c) const { return 6 * c; }
  int board(int b = 0) const { return 6 * (cameras + b); }
  /// Where the first pose of a camera or board stands.
  int body(int body) const { return Step::is_board(body) ? board(Step::board_of(body)) : camera(body); }
  /// How many there are of a row of the table.
  int count(Nuisance nuisance) const { return count_of(row_of(nuisance).each, cameras, boards); }
  /// Whether the row is among the unknowns.
  bool has(Nuisance nuisance) const { return first_[static_cast<std::size_t>(nuisance)] >= 0; }
  /// Index of the first value of a row that is among them; the values of the next camera, or board, follow.
  int place(Nuisance nuisance, int c = 0) const {
    const NuisanceRow& row = row_of(nuisance);
    return first_[static_cast<std::size_t>(nuisance)] + (row.each == Each::kRig ? 0 : c * row.size());
  }
  int globals() const { return globals_; }
  const Step& step() const { return step_; }
  /// Which of a step's bodies the second pose of a camera (or Step::board()) is at a stop; -1: it has its first one.
  int second_of(int body, int stop) const {
    if (step_.bodies.empty() || stop < step_.split) return -1;
    const auto found = std::find(step_.bodies.begin(), step_.bodies.end(), body);
    return found == step_.bodies.end() ? -1 : static_cast<int>(found - step_.bodies.begin());
  }
  /// Where the second pose of a step's body stands.
  int second(int index) const { return globals_ - 6 * (static_cast<int>(step_.bodies.size()) - index); }

 private:
  std::array<int, kNuisances> first_{};
  int globals_ = 0;
  Step step_;
};

/// Moves the state by the steps of the poses (6 * poses) and of the globals.
State moved(const State& state, const Layout& layout, const Eigen::VectorXd& pose_step,
            const Eigen::VectorXd& global_step);

}  // namespace rigproof::ml
