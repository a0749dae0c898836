// What the maximum-likelihood method estimates, and where each part stands in the vector of unknowns.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ml/noise.h"
#include "rigproof/calib/information.h"
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
  double odometry_scale = 1.0;
  double odometry_yaw_factor = 1.0;
  std::vector<double> depth_bias;              ///< measured depth = (1 + bias) * true, one a camera
  std::vector<Eigen::Vector3d> intrinsics;     ///< relative focal length, shift of cx and of cy [px], one a camera
  std::vector<Eigen::Vector3d> ground_offset;  ///< common to all ground planes of a camera [1/m]
  std::vector<double> clock_offset_s;          ///< stamps of a camera's images less the odometry's time, one a camera
  double turn_lag_s = 0.0;                     ///< by how much the body turns later than the odometry's wheels
};

/// The state of values as they are reported; intrinsics as told, ground planes without a common error.
State state_from(const CalibrationState& values);

/// Unknowns: six a pose (x, y, yaw, height, roll, pitch), then the globals in the order below. Rotations move by
/// R <- R Exp(phi).
struct Layout {
  int poses = 0;
  int cameras = 0;
  bool with_intrinsics = false;
  bool with_ground_offsets = false;
  bool with_clock_offsets = false;

  static Layout of(const Observations& observations, const Priors& priors);
  int camera(int c) const { return 6 * c; }
  int board() const { return 6 * cameras; }
  int odometry_scale() const { return 6 * cameras + 6; }
  int odometry_yaw_factor() const { return 6 * cameras + 7; }
  int depth_bias(int c) const { return 6 * cameras + 8 + c; }
  int intrinsics(int c) const { return 7 * cameras + 8 + 3 * c; }
  int ground_offset(int c) const { return 7 * cameras + 8 + (with_intrinsics ? 3 * cameras : 0) + 3 * c; }
  int clock_offset(int c) const { return ground_offset(with_ground_offsets ? cameras : 0) + c; }
  int turn_lag() const { return clock_offset(cameras); }  ///< only beside clock offsets
  int globals() const { return clock_offset(with_clock_offsets ? cameras + 1 : 0); }
};

/// Moves the state by the steps of the poses (6 * poses) and of the globals.
State moved(const State& state, const Layout& layout, const Eigen::VectorXd& pose_step,
            const Eigen::VectorXd& global_step);

}  // namespace rigproof::ml
