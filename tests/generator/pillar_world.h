// A floor with a pillar on it, a board, and cameras that look ahead: for tests of plans.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "looking_forward.h"
#include "rigproof/core/conventions.h"
#include "rigproof/generator/viewpoints.h"

namespace rigproof {

// An empty floor with one round pillar.
class PillarWorld : public ViewpointWorld {
 public:
  FloorArea area{-5.0, 5.0, -5.0, 5.0};
  Eigen::Vector2d pillar{0.0, 1.5};
  double pillar_radius_m = 0.2;

  FloorArea drivable_area() override { return area; }
  std::string obstacle(const Rigid3& T_scene_robot) override {
    return (T_scene_robot.translation.head<2>() - pillar).norm() < pillar_radius_m + 0.6 ? "pillar" : "";
  }
  bool in_sight(const Eigen::Vector3d& origin, const Eigen::Vector3d& target, std::size_t) override {
    const Eigen::Vector2d a = origin.head<2>(), b = target.head<2>();
    const double along = std::clamp((pillar - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (a + along * (b - a) - pillar).norm() > pillar_radius_m;
  }
};

// A camera at (0.25, y, z) in the robot that looks ahead, turned by yaw and down by pitch.
inline WorldCamera camera_at(double y_m, double z_m, double yaw_deg, double pitch_deg) {
  const Eigen::Quaterniond body = rotation_z(deg_to_rad(yaw_deg)) * so3_exp({0.0, deg_to_rad(pitch_deg), 0.0});
  return {"camera", Rigid3(body * looking_forward(), {0.25, y_m, z_m}), Camera::symmetric(1280, 720, 640.0)};
}

// The board faces scene x, its middle at (0, 0, 0.8).
inline ViewpointSubject subject() {
  ViewpointSubject subject;
  subject.cameras = {camera_at(0.2, 0.7, 14.0, 14.0), camera_at(0.0, 0.65, 0.0, 12.0),
                     camera_at(-0.2, 0.7, -14.0, 16.0)};
  Eigen::Matrix3d upright;  // board x = to a viewer's right, y = down, z = into the board, away from the viewer
  upright << 0, 0, -1, 1, 0, 0, 0, -1, 0;
  const Eigen::Quaterniond rotation(upright);
  subject.T_scene_board = Rigid3(rotation, Eigen::Vector3d(0, 0, 0.8) - rotation * subject.board.centre());
  return subject;
}

}  // namespace rigproof
