// The residuals of the estimator with hand-written derivatives.
#pragma once

#include <Eigen/Core>

#include "rigproof/calib/estimate/odometry_way.h"
#include "rigproof/calib/estimate/state.h"
#include "rigproof/core/camera.h"

namespace rigproof::ml {

/// Jacobians lie row by row: products of their transposes are then summed column by column, four times as fast.
template <int kRows, int kColumns>
using RowJacobian = Eigen::Matrix<double, kRows, kColumns, Eigen::RowMajor>;
using Matrix36d = RowJacobian<3, 6>;

/// T_camera_board of one view. A motion of any unknown moves a point q of the board in camera coordinates by
/// dq = omega x q + v; the derivatives of the twist (omega, v) by each unknown are below.
struct ViewGeometry {
  Rigid3 T_camera_board;
  Matrix6d twist_by_camera;  ///< by (dt, phi) of T_robot_camera
  Matrix6d twist_by_board;   ///< by (dt, phi) of T_world_board
  Matrix6d twist_by_pose;    ///< by (x, y, yaw, height, roll, pitch)
};
ViewGeometry view_geometry(const Rigid3& T_robot_camera, const Rigid3& T_world_board, const RobotPose& pose);

/// Projected minus measured pixel, not whitened.
struct CornerResidual {
  Eigen::Vector2d value;
  RowJacobian<2, 6> by_twist;
  RowJacobian<2, 3> by_point;
};
/// @param corner_camera the corner in camera coordinates.
/// Returns false where the point is not in front of the camera.
bool corner_residual(const Camera& camera, const Eigen::Vector3d& corner_camera, const Eigen::Vector2d& measured,
                     CornerResidual* residual);

/// Predicted minus measured inverse-depth plane of the ground [1/m].
struct GroundResidual {
  Eigen::Vector3d value;
  Matrix36d by_camera;  ///< by (dt, phi)
  Matrix36d by_pose;
  Eigen::Vector3d by_depth_bias;
};
GroundResidual ground_residual(const Rigid3& T_robot_camera, const RobotPose& pose, double depth_bias,
                               const Eigen::Vector3d& measured);

/// Predicted minus measured inverse-depth plane of the board [1/m].
struct BoardPlaneResidual {
  Eigen::Vector3d value;
  Matrix36d by_twist;
  Eigen::Vector3d by_depth_bias;
};
BoardPlaneResidual board_plane_residual(const Rigid3& T_camera_board, double depth_bias,
                                        const Eigen::Vector3d& measured);

/// Odometry of an increment: (s Rz(-yaw_i) dp - m_xy, k dyaw - m_yaw), metres and radians, p being where the point of
/// the robot is whose motion is measured.
struct IncrementResidual {
  Eigen::Vector3d value;
  Eigen::Matrix3d by_from;  ///< by (x, y, yaw)
  Eigen::Matrix3d by_to;
  Eigen::Matrix<double, 3, 2> by_factors;  ///< scale, yaw factor
  Eigen::Vector3d by_veer;                 ///< [1/(rad/m)]
};
/// @param measured from which a veer is subtracted along the way
IncrementResidual increment_residual(const RobotPose& from, const RobotPose& to, const OdometryErrors& errors,
                                     const VeeringIncrement& measured);
/// The same along the way, which yaw factor and veer bend: s Rz(-yaw_i) dp - m_xy(k, v).
IncrementResidual way_residual(const RobotPose& from, const RobotPose& to, const OdometryErrors& errors,
                               const OdometryWay& way);
/// Odometry that knows a stop's pose in its world: predicted minus measured, of the point of the robot that it is of.
struct PoseResidual {
  Eigen::Vector3d value;
  Eigen::Matrix3d by_pose;  ///< by (x, y, yaw)
};
PoseResidual pose_residual(const RobotPose& pose, const Stop& measured, const Eigen::Vector2d& point_m);
/// What the odometry says about the motion from one stop to the next, in the former's frame: x, y, yaw.
/// @param point_m of the robot whose motion is asked for, in its frame
Eigen::Vector3d measured_increment(const Stop& from, const Stop& to,
                                   const Eigen::Vector2d& point_m = Eigen::Vector2d::Zero());
/// The same of a point of the robot, with what a veer of the heading does to it; on a single arc if the samples between
/// them are unknown.
VeeringIncrement veering_increment(const Stop& from, const Stop& to, const Eigen::Vector2d& point_m);

}  // namespace rigproof::ml
