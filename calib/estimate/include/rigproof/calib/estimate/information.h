// The information that observations hold about a calibration: the Cramer-Rao bound when evaluated at the truth.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/calib/estimate/odometry_law.h"
#include "rigproof/calib/estimate/unknowns.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Everything that the observations depend on; per camera and per stop in the order of Observations.
struct CalibrationState {
  std::vector<Rigid3> T_robot_camera;
  Rigid3 T_world_board;               ///< of the first board
  std::vector<Rigid3> T_world_robot;  ///< all six degrees of freedom
  double odometry_scale = 1.0;        ///< measured = scale * true translation of an increment
  double odometry_yaw_factor = 1.0;   ///< measured = factor * true rotation of an increment
  std::vector<double> depth_scale;    ///< measured = scale * true depth, one a camera
  std::vector<Rigid3> T_world_more_boards;
};

/// Standard deviations of what is not in the observations themselves. Corners and planes carry their covariances.
struct CalibrationNoise {
  OdometryLaw law;
  double odometry_xy_m = 0.002;
  double odometry_yaw_rad = 0.01;
  double suspension_height_m = 0.0;
  double suspension_tilt_rad = 0.0;
  PriorSigmas priors;
};

/// Covariances in the chart of transform_error(): tx ty tz rx ry rz, metres and radians.
struct InformationBound {
  std::vector<Matrix6d> camera_to_robot;  ///< one a camera, in the order of Observations
  struct Pair {
    int parent, child;  ///< camera indices, parent < child
    Matrix6d covariance;
  };
  std::vector<Pair> camera_to_camera;
  Eigen::MatrixXd joint;  ///< 6 cameras x 6 cameras
  /// Undetermined directions of all cameras; do not use the variances above along them. One column a direction, same
  /// chart as `joint`.
  Eigen::MatrixXd free_directions;
};

/// Inverse information at the given state: no unbiased estimator has a smaller covariance. Measured values are not
/// used, only the covariances of the corners and planes that were seen. Depth scales have the priors of
/// DepthNoise::scale_sigma; lenses and prints that are not believed have their fields as large as is stated. Throws
/// Error if the state does not fit the observations.
InformationBound cramer_rao_bound(const Observations& observations, const CalibrationState& state,
                                  const CalibrationNoise& noise);

}  // namespace rigproof
