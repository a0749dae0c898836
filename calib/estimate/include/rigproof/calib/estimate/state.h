// The unknowns of the maximum-likelihood method, and their places in the vector of unknowns.
#pragma once

#include <Eigen/Core>
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

struct State {
  std::vector<Rigid3> T_robot_camera;
  Rigid3 T_world_board;
  std::vector<RobotPose> poses;
  NuisanceValues nuisances;

  double odometry_scale() const { return 1.0 + nuisances.of(Nuisance::kOdometryFactors)[0]; }
  double odometry_yaw_factor() const { return 1.0 + nuisances.of(Nuisance::kOdometryFactors)[1]; }
};

/// The state of values as they are reported; depth scales of one where none are given, all else as declared.
State state_from(const CalibrationState& values);

/// Unknowns: six a pose (x, y, yaw, height, roll, pitch); then the globals: six a camera, six of the board, and the
/// rows of the table of nuisances of which any has a prior. Rotations move by R <- R Exp(phi).
class Layout {
 public:
  static Layout of(const Observations& observations, const Priors& priors);
  int poses = 0;
  int cameras = 0;
  int camera(int c) const { return 6 * c; }
  int board() const { return 6 * cameras; }
  /// Whether the row is among the unknowns.
  bool has(Nuisance nuisance) const { return first_[static_cast<std::size_t>(nuisance)] >= 0; }
  /// Index of the first value of a row that is among them; the values of the next camera follow.
  int place(Nuisance nuisance, int c = 0) const {
    const NuisanceRow& row = row_of(nuisance);
    return first_[static_cast<std::size_t>(nuisance)] + (row.per_camera ? c * row.size() : 0);
  }
  int globals() const { return globals_; }

 private:
  std::array<int, kNuisances> first_{};
  int globals_ = 0;
};

/// Moves the state by the steps of the poses (6 * poses) and of the globals.
State moved(const State& state, const Layout& layout, const Eigen::VectorXd& pose_step,
            const Eigen::VectorXd& global_step);

}  // namespace rigproof::ml
