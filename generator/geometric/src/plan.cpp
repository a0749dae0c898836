#include "plan.h"

#include <cmath>

namespace rigproof {
namespace {

constexpr double kImageMargin_px = 6.0;
constexpr double kMaxObliquity = 1.13;  // 65 degrees

}  // namespace

Rigid3 board_in_plan(const GeometricRig& rig) {
  Eigen::Matrix3d upright;  // x along plan y, y down, z away from the viewers
  upright << 0, 0, -1, 1, 0, 0, 0, -1, 0;
  const Eigen::Quaterniond rotation = so3_exp({0.0, rig.board_inclination_rad, 0.0}) * Eigen::Quaterniond(upright) *
                                      so3_exp({0.0, 0.0, rig.board_spin_rad});
  const Eigen::Vector3d centre(0.0, 0.0, rig.board_centre_height_m);
  return Rigid3(rotation, centre - rotation * rig.board.centre());
}

bool sees_board(const RigCamera& camera, const Rigid3& T_camera_board, const Board& board) {
  const Eigen::Vector3d normal = T_camera_board.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d centre = T_camera_board * board.centre();
  if (normal.dot(centre.normalized()) < std::cos(kMaxObliquity)) return false;
  for (const Eigen::Vector3d& corner : board.outline()) {
    Eigen::Vector2d pixel;
    if (!camera.camera.project(T_camera_board * corner, &pixel)) return false;
    if (!camera.camera.contains(pixel, kImageMargin_px)) return false;
  }
  return true;
}

}  // namespace rigproof
