#include <cmath>
#include <optional>

#include "plan.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/random.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof {
namespace {

// Poses are planned in a frame whose z axis passes through the board's centre and whose x axis points to the viewers;
// the world is the first pose's frame.
struct PlanarPose {
  double x = 0.0, y = 0.0, yaw = 0.0;
};

constexpr int kTriesPerPose = 4000;
constexpr int kTriesPerDrive = 60;

class Planner {
 public:
  Planner(const GeometricConfig& config, const Rigid3& T_plan_board, int attempt)
      : config_(config), T_plan_board_(T_plan_board), random_(config.seed, "geometric drive", attempt) {}

  std::optional<std::vector<PlanarPose>> plan() {
    std::vector<PlanarPose> poses;
    for (int i = 0; i < config_.stops; ++i) {
      const std::optional<PlanarPose> pose = next(poses);
      if (!pose) return std::nullopt;
      poses.push_back(*pose);
    }
    return poses;
  }

 private:
  std::optional<PlanarPose> next(const std::vector<PlanarPose>& poses) {
    if (poses.empty()) kind_ = random_.uniform() < 0.5 ? -1.0 : 1.0;
    for (int i = 0; i < kTriesPerPose; ++i) {
      const PlanarPose pose = candidate(poses);
      if (accepted(pose, poses.size())) return pose;
    }
    return std::nullopt;
  }

  PlanarPose candidate(const std::vector<PlanarPose>& poses) {
    if (poses.empty() || config_.drive == GeometricDrive::kRandom) return aimed(poses.size());
    const PlanarPose& first = poses.front();
    switch (config_.drive) {
      case GeometricDrive::kSteps: {
        // Mean absolute values of 0.3 m and 8 degrees: forwards or back along a short arc.
        const double step = (random_.uniform() < 0.5 ? -1.0 : 1.0) * random_.uniform(0.15, 0.45);
        const double turn = random_.normal(0.0, deg_to_rad(8.0) * std::sqrt(0.5 * kPi));
        return moved(poses.back(), step, turn);
      }
      case GeometricDrive::kStraight:
        return moved(first, random_.uniform(-1.2, 1.2), 0.0);
      case GeometricDrive::kTurnInPlace:
        return {first.x, first.y, first.yaw + random_.uniform(-0.8, 0.8)};
      case GeometricDrive::kArc:
        return on_arc(first);
      case GeometricDrive::kRandom:
      case GeometricDrive::kStandstill:
        break;
    }
    return first;
  }

  static PlanarPose moved(const PlanarPose& from, double step, double turn) {
    const double heading = from.yaw + 0.5 * turn;
    return {from.x + step * std::cos(heading), from.y + step * std::sin(heading), from.yaw + turn};
  }

  PlanarPose on_arc(const PlanarPose& first) {
    const double radius = kind_ * 1.2, angle = random_.uniform(-0.8, 0.8);
    const double centre_x = first.x - radius * std::sin(first.yaw), centre_y = first.y + radius * std::cos(first.yaw);
    const double yaw = first.yaw + angle;
    return {centre_x + radius * std::sin(yaw), centre_y - radius * std::cos(yaw), yaw};
  }

  // A pose from which one camera (by turns) looks about at the board.
  PlanarPose aimed(std::size_t stop) {
    const GeometricRig& rig = config_.rig;
    const std::size_t c = rig.min_cameras_per_stop > 1 ? rig.cameras.size() / 2 : stop % rig.cameras.size();
    const double distance = random_.uniform(rig.min_distance_m, rig.max_distance_m);
    const double bearing = random_.uniform(-rig.max_bearing_rad, rig.max_bearing_rad);
    const Rigid3& X = rig.T_robot_camera[c];
    const Eigen::Vector3d axis = X.rotation * Eigen::Vector3d::UnitZ();
    const double towards_board = bearing + kPi + random_.uniform(-rig.max_aim_error_rad, rig.max_aim_error_rad);
    const double yaw = towards_board - std::atan2(axis.y(), axis.x());
    const Eigen::Vector3d lever = rotation_z(yaw) * X.translation;
    return {distance * std::cos(bearing) - lever.x(), distance * std::sin(bearing) - lever.y(), yaw};
  }

  bool accepted(const PlanarPose& pose, std::size_t stop) const {
    const GeometricRig& rig = config_.rig;
    const Rigid3 T_robot_board = planar_pose(pose.x, pose.y, pose.yaw).inverse() * T_plan_board_;
    int seen = 0;
    bool wanted = false;
    const std::size_t aimed_camera = stop % rig.cameras.size();
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      if (!sees_board(rig.cameras[c], rig.T_robot_camera[c].inverse() * T_robot_board, rig.board)) continue;
      ++seen;
      wanted = wanted || c == aimed_camera;
    }
    const bool by_turns = config_.drive == GeometricDrive::kRandom && rig.min_cameras_per_stop <= 1;
    return seen >= rig.min_cameras_per_stop && (!by_turns || wanted);
  }

  const GeometricConfig& config_;
  Rigid3 T_plan_board_;
  RandomStream random_;
  double kind_ = 1.0;
};

// The true pose rides on its suspension: a little height, roll and pitch about the planar one.
Rigid3 on_suspension(const PlanarPose& pose, const GeometricConfig& config, std::size_t stop) {
  RandomStream random(config.seed, "geometric suspension", static_cast<std::int64_t>(stop));
  const double roll = random.normal(0.0, config.suspension_tilt_sigma_rad);
  const double pitch = random.normal(0.0, config.suspension_tilt_sigma_rad);
  const double height = random.normal(0.0, config.suspension_height_sigma_m);
  return planar_pose(pose.x, pose.y, pose.yaw) * Rigid3(so3_exp({roll, pitch, 0.0}), {0.0, 0.0, height});
}

}  // namespace

GeometricScene draw_scene(const GeometricConfig& config) {
  const Rigid3 T_plan_board = board_in_plan(config.rig);
  for (int attempt = 0; attempt < kTriesPerDrive; ++attempt) {
    const std::optional<std::vector<PlanarPose>> poses = Planner(config, T_plan_board, attempt).plan();
    if (!poses) continue;
    GeometricScene scene;
    const Rigid3 T_world_plan =
        poses->empty() ? Rigid3() : planar_pose(poses->front().x, poses->front().y, poses->front().yaw).inverse();
    scene.T_world_board = T_world_plan * T_plan_board;
    for (std::size_t i = 0; i < poses->size(); ++i)
      scene.T_world_robot.push_back(T_world_plan * on_suspension((*poses)[i], config, i));
    return scene;
  }
  throw Error("geometric mode: no drive of " + std::to_string(config.stops) + " stops from which " +
              std::to_string(config.rig.min_cameras_per_stop) + " camera(s) see the whole board was found");
}

}  // namespace rigproof
