#include "robot_frame.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr const char* kGroundFrame = "base_footprint";
constexpr double kOnGround_m = 1e-3, kLevel_rad = deg_to_rad(0.1);

std::string option_of(const std::string& given) { return "--robot-frame " + for_message(given) + ": "; }

void refuse_unknown(const FrameTree& tree, const PoseTopic& odometry, const std::string& given) {
  if (tree.empty() || tree.has(given) || given == kGroundFrame || given == odometry.child_frame_id) return;
  std::vector<std::string> known = tree.frames();
  if (!tree.has(odometry.child_frame_id)) known.push_back(odometry.child_frame_id);
  throw Error(option_of(given) + "/tf_static has no such frame; " + suggestion(given, known));
}

void refuse_above_ground(const FrameTree& tree, const std::string& given) {
  const std::optional<std::string> ground = tree.ground_frame(given);
  if (!ground) return;
  const Rigid3 T = tree.between(*ground, given).value();
  const double height_m = T.translation.z();
  const double tilt_rad = std::acos(std::min(1.0, (T.rotation * Eigen::Vector3d::UnitZ()).z()));
  if (std::abs(height_m) < kOnGround_m && tilt_rad < kLevel_rad) return;
  throw Error(option_of(given) + "/tf_static has it " + short_text(100.0 * height_m, 3) + " cm above " + *ground +
              (tilt_rad < kLevel_rad ? "" : " and tilted") +
              ", and what calibrates is the point on the ground; give --robot-frame " + *ground +
              (*ground == kGroundFrame ? ", or nothing" : "") +
              ". `export` hangs each camera where the robot's tree has it, at the right height");
}

std::string height_remark(const std::string& frame) {
  return "; how high " + for_message(frame) + " stands above the ground nothing says: `export --parent " +
         for_message(frame) + " --parent-height-mm H` counts it in";
}

// Odometry that does not say what it moves is taken to move the robot frame.
RobotFrame of_nameless_odometry(const FrameTree& tree, const PoseTopic& odometry, const std::string& name) {
  RobotFrame frame{name, Rigid3(), {}};
  frame.notes.push_back(odometry.name +
                        " does not say which frame it moves (child_frame_id is empty): " + for_message(name) +
                        " is taken to be it" + (tree.empty() || tree.has(name) ? "" : ", the point on the ground"));
  return frame;
}

RobotFrame of_given(const FrameTree& tree, const PoseTopic& odometry, const std::string& given) {
  refuse_unknown(tree, odometry, given);
  refuse_above_ground(tree, given);
  const std::string& child = odometry.child_frame_id;
  if (child.empty()) return of_nameless_odometry(tree, odometry, given);
  const std::optional<Rigid3> T = tree.between(child, given);
  if (!T && tree.has(given))
    throw Error(option_of(given) + "/tf_static does not join it with " + for_message(child) + ", which " +
                odometry.name + " moves");
  RobotFrame frame{given, T.value_or(Rigid3()), {}};
  if (!T)
    frame.notes.push_back(for_message(given) + " is not in /tf_static: it stands for the point on the ground below " +
                          for_message(child) + ", which " + odometry.name + " moves" + height_remark(child));
  else if (given != kGroundFrame && !tree.ground_frame(given))
    frame.notes.push_back("results are given on the ground below " + for_message(given) + height_remark(given));
  return frame;
}

}  // namespace

RobotFrame robot_frame_of(const FrameTree& tree, const PoseTopic& odometry, const std::string& given) {
  if (!given.empty()) return of_given(tree, odometry, given);
  const std::string& child = odometry.child_frame_id;
  if (child.empty()) return of_nameless_odometry(tree, odometry, kGroundFrame);
  if (const std::optional<Rigid3> T = tree.between(child, kGroundFrame)) return {kGroundFrame, *T, {}};
  if (!tree.has(kGroundFrame))
    return {kGroundFrame,
            Rigid3(),
            {"/tf_static has no " + std::string(kGroundFrame) + ": it stands for the point on the ground below " +
             for_message(child) + ", which " + odometry.name + " moves" + height_remark(child)}};
  // It would be a guess that what moves is the frame that the tree knows.
  return {tree.way_up(child).front(),  // as tf2 has it, without a slash
          Rigid3(),
          {"/tf_static does not join " + std::string(kGroundFrame) + " with " + for_message(child) + ", which " +
           odometry.name + " moves: results are given in " + for_message(child) +
           ", on the ground; if both are one, `export --parent " + kGroundFrame + "`"}};
}

}  // namespace rigproof
