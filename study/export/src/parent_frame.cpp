#include "parent_frame.h"

#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/text.h"

namespace rigproof::exporting {
namespace {

constexpr double kSame_m = 1e-4, kSame_rad = deg_to_rad(0.01);

bool is_other_place(const Rigid3& T) {
  const Vector6d off = transform_error(T, Rigid3());
  return off.head<3>().norm() > kSame_m || off.tail<3>().norm() > kSame_rad;
}

// What is calibrated is the point on the ground below the frame that is called the robot's.
Rigid3 on_ground(const Rigid3& T_ground_robot) {
  return planar_pose(T_ground_robot.translation.x(), T_ground_robot.translation.y(), yaw_of(T_ground_robot));
}

std::string height_text(double height_m) { return short_text(100.0 * height_m, 4) + " cm"; }

ParentFrame at_height(const std::string& name, double height_m) {
  ParentFrame frame{name, Rigid3(), {}};
  frame.T_robot_parent.translation.z() = height_m;
  frame.notes.push_back("poses are given in " + name + ", " + height_text(height_m) +
                        " above the ground, as --parent-height-mm says");
  return frame;
}

// A recording may call a frame the robot's that its tree has above the ground.
ParentFrame of_result(const std::string& robot, const FrameTree& tree) {
  ParentFrame frame{robot, Rigid3(), {}};
  const std::optional<std::string> ground = tree.ground_frame(robot);
  if (!ground) return frame;
  const Rigid3 T_ground_robot = tree.between(*ground, robot).value();
  frame.T_robot_parent = on_ground(T_ground_robot).inverse() * T_ground_robot;
  if (!is_other_place(frame.T_robot_parent)) return {robot, Rigid3(), {}};
  frame.notes.push_back("poses are given in " + robot + ", " + height_text(T_ground_robot.translation.z()) + " above " +
                        *ground + " in the robot's tree; the result has them in the point on the ground below it");
  return frame;
}

}  // namespace

std::string place_text(const Rigid3& T) {
  std::vector<std::string> words;
  for (Eigen::Index i = 0; i < 3; ++i) words.push_back(number_text(std::round(1e4 * T.translation[i]) / 100.0 + 0.0));
  return joined(words) + " cm";
}

EstimatedTransform ParentFrame::given_here(EstimatedTransform estimate) const {
  const bool moves = is_other_place(T_robot_parent);
  if (moves && !estimate.fully_observable()) return estimate;
  estimate.parent = name;
  if (!moves) return estimate;
  const Rigid3 T_parent_robot = T_robot_parent.inverse();
  estimate.T_parent_child = T_parent_robot * estimate.T_parent_child;
  if (!estimate.covariance) return estimate;
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = T_parent_robot.rotation_matrix();
  estimate.covariance = J * *estimate.covariance * J.transpose();
  return estimate;
}

ParentFrame parent_frame(const std::string& robot, const FrameTree& tree, const ExportOptions& options) {
  const std::string& name = options.parent.empty() ? robot : options.parent;
  if (options.parent_height_m) return at_height(name, *options.parent_height_m);
  const ParentFrame own = of_result(robot, tree);
  if (name == robot) return own;
  if (const std::optional<Rigid3> T = tree.between(robot, name)) {
    ParentFrame frame{name, own.T_robot_parent * *T, {}};
    if (is_other_place(frame.T_robot_parent))
      frame.notes.push_back("poses are given in " + name + ", in the robot's tree at " +
                            place_text(frame.T_robot_parent) + " in " + (own.notes.empty() ? "" : "the ground below ") +
                            robot);
    return frame;
  }
  ParentFrame frame{name, Rigid3(), {}};
  frame.notes.push_back(name + " is taken to be what the result calls " + robot +
                        ", the robot's point on the ground; if it stands above the ground, all heights are too large "
                        "by that: --parent-height-mm says how high");
  return frame;
}

std::string note_of_other_parents(const std::vector<ExportCamera>& cameras, const FrameTree& tree) {
  std::vector<std::string> links;
  std::string root, robot;
  for (const ExportCamera& camera : cameras) {
    const auto edge = tree.edges().find(camera.link);
    const bool is_elsewhere = edge != tree.edges().end() && edge->second.parent != camera.estimate.parent &&
                              !tree.between(camera.estimate.parent, edge->second.parent);
    if (!is_elsewhere) continue;
    links.push_back(camera.link);
    root = tree.way_up(camera.link).back();
    robot = camera.estimate.parent;
  }
  if (links.empty()) return "";
  return "the robot's tree hangs " + joined(links) + " below " + root + ", which nothing joins with " + robot +
         ", the point on the ground: exported is where it is in " + robot + ". `--parent " + root +
         " --parent-height-mm H` gives it in " + root + ", H above the ground";
}

}  // namespace rigproof::exporting
