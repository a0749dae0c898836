#include "rigproof/calib/estimate/residuals.h"

#include <Eigen/Geometry>
#include <cmath>

namespace rigproof::ml {
namespace {

// d Exp(roll, pitch, 0) as a rotation on the right: E <- E Exp(J (droll, dpitch)).
Eigen::Matrix<double, 3, 2> tilt_jacobian(const RobotPose& pose) {
  return so3_left_jacobian({-pose.roll_rad, -pose.pitch_rad, 0.0}).leftCols<2>();
}

Eigen::Vector3d odometry_at(const Stop& stop) { return {stop.x_m, stop.y_m, stop.yaw_rad}; }

// In the frame of its beginning; poses and motion are (x, y, yaw).
Eigen::Vector3d motion_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const double c = std::cos(from.z()), s = std::sin(from.z());
  const double dx = to.x() - from.x(), dy = to.y() - from.y();
  return {c * dx + s * dy, c * dy - s * dx, wrap_angle(to.z() - from.z())};
}

}  // namespace

ViewGeometry view_geometry(const Rigid3& T_robot_camera, const Rigid3& T_world_board, const RobotPose& pose) {
  const Eigen::Matrix3d R_camera_robot = T_robot_camera.rotation_matrix().transpose();
  const Eigen::Matrix3d E = pose.tilt().toRotationMatrix();
  const Rigid3 T_world_robot = pose.transform();
  const Eigen::Matrix3d R_camera_world = R_camera_robot * T_world_robot.rotation_matrix().transpose();
  ViewGeometry view;
  view.T_camera_board = T_robot_camera.inverse() * (T_world_robot.inverse() * T_world_board);

  view.twist_by_camera.setZero();
  view.twist_by_camera.topRightCorner<3, 3>() = -Eigen::Matrix3d::Identity();
  view.twist_by_camera.bottomLeftCorner<3, 3>() = -R_camera_robot;

  const Eigen::Matrix3d R_camera_board = view.T_camera_board.rotation_matrix();
  view.twist_by_board.setZero();
  view.twist_by_board.topRightCorner<3, 3>() = R_camera_board;
  view.twist_by_board.bottomLeftCorner<3, 3>() = R_camera_world;
  view.twist_by_board.bottomRightCorner<3, 3>() = skew(view.T_camera_board.translation) * R_camera_board;

  // Turning the robot by a (robot axes) turns the world the other way round about the robot's origin.
  Eigen::Matrix3d axes;
  axes.col(0) = E.transpose().col(2);
  axes.rightCols<2>() = tilt_jacobian(pose);
  view.twist_by_pose.setZero();
  view.twist_by_pose.block<3, 3>(0, 0).col(2) = -R_camera_robot * axes.col(0);
  view.twist_by_pose.block<3, 2>(0, 4) = -R_camera_robot * axes.rightCols<2>();
  const Eigen::Matrix3d lever = R_camera_robot * skew(T_robot_camera.translation);  // -(a x t) = t x a
  view.twist_by_pose.block<3, 1>(3, 2) = lever * axes.col(0);
  view.twist_by_pose.block<3, 2>(3, 4) = lever * axes.rightCols<2>();
  view.twist_by_pose.block<3, 2>(3, 0) = -R_camera_world.leftCols<2>();
  view.twist_by_pose.block<3, 1>(3, 3) = -R_camera_world.col(2);
  return view;
}

bool corner_residual(const Camera& camera, const Eigen::Vector3d& corner_camera, const Eigen::Vector2d& measured,
                     CornerResidual* residual) {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> J;
  if (!camera.project(corner_camera, &pixel, &J)) return false;
  residual->value = pixel - measured;
  // A row a of J gives a . (w x q + v) = (q x a) . w + a . v
  for (int row = 0; row < 2; ++row) {
    const Eigen::Vector3d a = J.row(row);
    residual->by_twist.row(row) << corner_camera.cross(a).transpose(), a.transpose();
  }
  residual->by_point = J;
  return true;
}

GroundResidual ground_residual(const Rigid3& T_robot_camera, const RobotPose& pose, double depth_bias,
                               const Eigen::Vector3d& measured) {
  const Eigen::Matrix3d R_camera_robot = T_robot_camera.rotation_matrix().transpose();
  const Eigen::Vector3d& t = T_robot_camera.translation;
  const Eigen::Vector3d up_robot = pose.tilt().conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d up = R_camera_robot * up_robot;
  const Eigen::Matrix<double, 3, 2> tilt = tilt_jacobian(pose);
  const double height = up_robot.dot(t) + pose.height_m;
  const double scale = 1.0 / (height * (1.0 + depth_bias));
  const Eigen::Vector3d by_height = up * (scale / height);

  GroundResidual residual;
  residual.value = -up * scale - measured;
  residual.by_camera.leftCols<3>() = by_height * up_robot.transpose();
  residual.by_camera.rightCols<3>() = -scale * skew(up);
  residual.by_pose.setZero();
  residual.by_pose.col(3) = by_height;
  residual.by_pose.rightCols<2>() =
      -scale * R_camera_robot * skew(up_robot) * tilt + by_height * (t.cross(up_robot).transpose() * tilt);
  residual.by_depth_bias = up * (scale / (1.0 + depth_bias));
  return residual;
}

BoardPlaneResidual board_plane_residual(const Rigid3& T_camera_board, double depth_bias,
                                        const Eigen::Vector3d& measured) {
  const Eigen::Vector3d normal = T_camera_board.rotation * Eigen::Vector3d::UnitZ();
  const double distance = normal.dot(T_camera_board.translation);
  const double scale = 1.0 / (distance * (1.0 + depth_bias));
  BoardPlaneResidual residual;
  residual.value = normal * scale - measured;
  residual.by_twist.leftCols<3>() = -scale * skew(normal);
  residual.by_twist.rightCols<3>() = -(scale / distance) * normal * normal.transpose();
  residual.by_depth_bias = -normal * (scale / (1.0 + depth_bias));
  return residual;
}

IncrementResidual increment_residual(const RobotPose& from, const RobotPose& to, const OdometryErrors& errors,
                                     const VeeringIncrement& veering) {
  const double scale = errors.scale, yaw_factor = errors.yaw_factor;
  const Eigen::Vector3d measured = veering.measured + errors.veer_rad_per_m * veering.by_veer;
  const double c = std::cos(from.yaw_rad), s = std::sin(from.yaw_rad);
  const double dx = to.x_m - from.x_m, dy = to.y_m - from.y_m;
  const Eigen::Vector2d& point = veering.point_m;
  const Eigen::Vector2d point_after = Eigen::Rotation2Dd(to.yaw_rad - from.yaw_rad) * point;
  const double along = c * dx + s * dy + point_after.x() - point.x();
  const double across = c * dy - s * dx + point_after.y() - point.y();
  // The turn nearest to the measured one: a yaw knows no full turns.
  const double turn = measured.z() + wrap_angle(to.yaw_rad - from.yaw_rad - measured.z());
  IncrementResidual residual;
  residual.value << scale * along - measured.x(), scale * across - measured.y(), yaw_factor * turn - measured.z();
  residual.by_to << scale * c, scale * s, 0.0, -scale * s, scale * c, 0.0, 0.0, 0.0, yaw_factor;
  residual.by_from = -residual.by_to;
  residual.by_from(0, 2) = scale * (across + point.y());
  residual.by_from(1, 2) = -scale * (along + point.x());
  residual.by_to(0, 2) = -scale * point_after.y();
  residual.by_to(1, 2) = scale * point_after.x();
  residual.by_factors << along, 0.0, across, 0.0, 0.0, turn;
  residual.by_veer = -veering.by_veer;
  return residual;
}

IncrementResidual way_residual(const RobotPose& from, const RobotPose& to, const OdometryErrors& errors,
                               const OdometryWay& way) {
  const double yaw_factor = errors.yaw_factor;
  const OdometryWay::Motion motion = way.motion(yaw_factor, errors.veer_rad_per_m);
  // Of equal headings the one nearest to the turns that were driven.
  Eigen::Vector3d turned = motion.value;
  turned.z() /= yaw_factor;
  IncrementResidual residual =
      increment_residual(from, to, {errors.scale, 1.0, 0.0}, {turned, Eigen::Vector3d::Zero(), way.point_m()});
  const double turn = turned.z() + residual.value.z();
  residual.value.z() = yaw_factor * turn - motion.value.z();
  residual.by_from(2, 2) *= yaw_factor;
  residual.by_to(2, 2) *= yaw_factor;
  residual.by_factors.col(1) << -motion.xy_by_yaw_factor, turn;
  residual.by_veer = -motion.by_veer;
  return residual;
}

PoseResidual pose_residual(const RobotPose& pose, const Stop& measured, const Eigen::Vector2d& point_m) {
  const Eigen::Vector3d predicted = odometry_of_point({pose.x_m, pose.y_m, pose.yaw_rad}, point_m);
  PoseResidual residual;
  residual.value = predicted - odometry_of_point(odometry_at(measured), point_m);
  residual.value.z() = wrap_angle(residual.value.z());
  residual.by_pose.setIdentity();
  residual.by_pose(0, 2) = pose.y_m - predicted.y();
  residual.by_pose(1, 2) = predicted.x() - pose.x_m;
  return residual;
}

Eigen::Vector3d measured_increment(const Stop& from, const Stop& to, const Eigen::Vector2d& point_m) {
  return motion_between(odometry_of_point(odometry_at(from), point_m), odometry_of_point(odometry_at(to), point_m));
}

VeeringIncrement veering_increment(const Stop& from, const Stop& to, const Eigen::Vector2d& point_m) {
  return {measured_increment(from, to, point_m), OdometryWay(from, to, point_m).motion(1.0).by_veer, point_m};
}

}  // namespace rigproof::ml
