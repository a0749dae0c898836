#include <cmath>
#include <string>

#include "plan.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof {
namespace {

// Optical axes (x right, y down, z forward) in a body that looks along x with y left and z up.
const Eigen::Quaterniond kBodyOptical(Eigen::Matrix3d((Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished()));

Rigid3 mount(const Eigen::Vector3d& position, double yaw, double pitch_down, double roll) {
  const Eigen::Quaterniond tilt = so3_exp({0.0, pitch_down, 0.0}) * so3_exp({roll, 0.0, 0.0});
  return Rigid3(rotation_z(yaw) * tilt * kBodyOptical, position);
}

RigCamera depth_camera(const std::string& name) {
  RigCamera camera;
  camera.sensor = "geometric";  // all are of one make
  camera.name = camera.folder = name;
  camera.camera = Camera::symmetric(1280, 720, 640.0);
  camera.intrinsics_sigma = IntrinsicsSigma::exact();
  camera.readout_sigma_s = 0.0;
  camera.depth = DepthStream();
  camera.depth->noise.believe_place_and_common_scale();
  return camera;
}

GeometricRig exact_rig() {
  GeometricRig rig;
  rig.board.believe();
  return rig;
}

// A camera mounted in any direction.
Rigid3 random_mount(RandomStream& random) {
  const double z = random.uniform(0.4, 1.0), y = random.uniform(-0.4, 0.4), x = random.uniform(-0.5, 0.5);
  const double yaw = random.uniform(-kPi, kPi);
  const double pitch_down = deg_to_rad(random.uniform(-10.0, 40.0));
  // A quarter of the cameras hangs upside down, another is turned on its side.
  const double turn[] = {0.0, 0.0, kPi, 0.5 * kPi};
  const double roll = turn[random.below(4)] + deg_to_rad(random.uniform(-10.0, 10.0));
  return mount({x, y, z}, yaw, pitch_down, roll);
}

// Whether the camera, turned towards the board, sees all of it from a good part of the distances.
bool useful(const GeometricRig& rig, const RigCamera& camera, const Rigid3& T_robot_camera) {
  const Eigen::Vector3d axis = T_robot_camera.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Quaterniond turn = rotation_z(kPi - std::atan2(axis.y(), axis.x()));
  constexpr int kDistances = 9;
  int seen = 0;
  for (int i = 0; i < kDistances; ++i) {
    const double distance = rig.min_distance_m + (rig.max_distance_m - rig.min_distance_m) * i / (kDistances - 1);
    const Rigid3 T_plan_camera(turn * T_robot_camera.rotation, {distance, 0.0, T_robot_camera.translation.z()});
    if (sees_board(camera, T_plan_camera.inverse() * board_in_plan(rig), rig.board)) ++seen;
  }
  return seen >= kDistances / 2;
}

}  // namespace

GeometricRig reference_rig() {
  GeometricRig rig = exact_rig();
  const double yaw[] = {deg_to_rad(20.0), 0.0, deg_to_rad(-20.0)};
  const double y_m[] = {0.22, 0.0, -0.22};
  const char* names[] = {"left", "center", "right"};
  for (int i = 0; i < 3; ++i) {
    rig.cameras.push_back(depth_camera(names[i]));
    rig.T_robot_camera.push_back(mount({i == 1 ? 0.35 : 0.30, y_m[i], 0.62}, yaw[i], deg_to_rad(12.0), 0.0));
  }
  rig.min_cameras_per_stop = 3;
  rig.min_distance_m = 0.9;
  rig.max_distance_m = 3.8;
  rig.max_bearing_rad = 0.62;
  rig.max_aim_error_rad = 0.3;
  return rig;
}

GeometricRig random_rig(std::uint64_t seed, int cameras) {
  RandomStream random(seed, "geometric rig");
  GeometricRig rig = exact_rig();
  rig.board_centre_height_m = random.uniform(0.35, 0.6);
  rig.board_spin_rad = random.uniform(-kPi, kPi);
  rig.board_inclination_rad = deg_to_rad(random.uniform(-25.0, 25.0));
  for (int i = 0; i < cameras; ++i) {
    const RigCamera camera = depth_camera("camera" + std::to_string(i + 1));
    Rigid3 T_robot_camera = random_mount(random);
    while (!useful(rig, camera, T_robot_camera)) T_robot_camera = random_mount(random);
    rig.cameras.push_back(camera);
    rig.T_robot_camera.push_back(T_robot_camera);
  }
  return rig;
}

}  // namespace rigproof
