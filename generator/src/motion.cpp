#include "rigproof/generator/motion.h"

#include <algorithm>

#include "rigproof/core/error.h"

namespace rigproof {

void RampConfig::visit(FieldVisitor& visitor) {
  const NumberRange place{-1000.0, 1000.0};
  visitor.field("x_m", x_m, place, "middle of the ramp in the scene's frame");
  visitor.field("y_m", y_m, place, "middle of the ramp in the scene's frame");
  visitor.field("heading_deg", heading_deg, {-360.0, 360.0}, "direction in which it rises and falls");
  visitor.field("height_cm", height_cm, {-30.0, 30.0}, "of the level part over the floor; negative = a dip");
  visitor.field("level_m", level_m, {0.0, 20.0}, "length of the level part");
  visitor.field("rise_m", rise_m, {0.2, 20.0}, "horizontal length of a slope; the sides fall as fast");
  visitor.field("width_m", width_m, {0.1, 50.0}, "across the heading");
}

void DriveConfig::visit(FieldVisitor& visitor) {
  visitor.field("capture", capture, TextChoices{{"standing", "moving"}},
                "standing: one image a camera at every viewpoint, when the robot has come to rest; moving: images all "
                "along the way through the viewpoints");
  visitor.field("frame_rate_hz", frame_rate_hz, {0.05, 50.0}, "capture moving: images a second");
  visitor.field("max_speed_m_s", max_speed_m_s, {0.05, 2.0}, "between viewpoints");
  visitor.field("max_turn_deg_s", max_turn_deg_s, {5.0, 180.0}, "between viewpoints");
  visitor.field("acceleration_m_s2", acceleration_m_s2, {0.1, 5.0}, "of starting and braking");
  visitor.field("settle_s", settle_s, {0.2, 60.0}, "the robot stands for this long before its cameras expose");
  visitor.field("tolerance_cm", tolerance_cm, {0.2, 50.0},
                "largest distance from the planned viewpoint; the robot corrects its place until it is kept");
  visitor.field("tolerance_deg", tolerance_deg, {0.1, 20.0}, "largest difference from the planned heading");
  visitor.field("clearance_cm", clearance_cm, {0.0, 10.0}, "distance that a planned way keeps from everything");
  visitor.field("max_plans", max_plans, {1.0, 20.0}, "ways that are tried to a viewpoint before it is given up");
  visitor.field("wheel_diameter_ratio", wheel_diameter_ratio, {0.8, 1.25}, "right over left wheels (UMBmark's E_d)");
  visitor.field("friction", friction, {0.0, 3.0}, "of the wheels on the ground; 0 = the robot's own");
  visitor.field("payload_kg", payload_kg, {0.0, 500.0}, "load fixed to the chassis; tilts it");
  visitor.field("payload_x_m", payload_x_m, {-2.0, 2.0}, "where the load is, robot frame");
  visitor.field("payload_y_m", payload_y_m, {-2.0, 2.0}, "where the load is, robot frame");
  visitor.field("payload_z_m", payload_z_m, {0.0, 3.0}, "where the load is, robot frame");
  visitor.field("unevenness_mm", unevenness_mm, {0.0, 50.0}, "standard deviation of the floor's height; 0 = flat");
  visitor.field("unevenness_length_m", unevenness_length_m, {0.5, 20.0}, "typical length of its waves");
  visitor.nested_list("ramps", ramps, "bumps and dips of the floor");
}

void RobotTrajectory::add(double stamp_s, const Rigid3& T_scene_robot) {
  if (!empty() && stamp_s <= end_s()) throw Error("trajectory: stamps must increase");
  stamps_s_.push_back(stamp_s);
  poses_.push_back(T_scene_robot);
}

void RobotTrajectory::cut_after(double stamp_s) {
  const auto end = std::upper_bound(stamps_s_.begin(), stamps_s_.end(), stamp_s);
  poses_.resize(static_cast<std::size_t>(end - stamps_s_.begin()));
  stamps_s_.erase(end, stamps_s_.end());
}

Rigid3 RobotTrajectory::at(double stamp_s) const {
  if (empty()) throw Error("trajectory: has no pose");
  const auto after = std::upper_bound(stamps_s_.begin(), stamps_s_.end(), stamp_s);
  if (after == stamps_s_.begin()) return poses_.front();
  if (after == stamps_s_.end()) return poses_.back();
  const auto i = static_cast<std::size_t>(after - stamps_s_.begin());
  const double duration_s = stamps_s_[i] - stamps_s_[i - 1], s = (stamp_s - stamps_s_[i - 1]) / duration_s;
  const Vector6d whole = duration_s * mean_velocity(i);
  const Vector6d bend =
      (s - 1.0) * (velocity_at_sample(i - 1) * duration_s - whole) + s * (velocity_at_sample(i) * duration_s - whole);
  return poses_[i - 1] * se3_exp(s * whole + s * (s - 1.0) * bend);
}
Vector6d RobotTrajectory::mean_velocity(std::size_t i) const {
  return se3_log(poses_[i - 1].inverse() * poses_[i]) / (stamps_s_[i] - stamps_s_[i - 1]);
}
Vector6d RobotTrajectory::velocity_at_sample(std::size_t i) const {
  if (i == 0) return mean_velocity(1);
  if (i + 1 == poses_.size()) return mean_velocity(i);
  const double share = (stamps_s_[i] - stamps_s_[i - 1]) / (stamps_s_[i + 1] - stamps_s_[i - 1]);
  return (1.0 - share) * mean_velocity(i) + share * mean_velocity(i + 1);
}

Vector6d RobotTrajectory::velocity(double stamp_s) const {
  constexpr double kHalf_s = 0.01;
  return se3_log(at(stamp_s - kHalf_s).inverse() * at(stamp_s + kHalf_s)) / (2.0 * kHalf_s);
}

std::vector<Rigid3> RobotTrajectory::during(double middle_s, double exposure_s, int count) const {
  std::vector<Rigid3> poses;
  for (int i = 0; i < count; ++i) poses.push_back(at(middle_s + exposure_s * ((i + 0.5) / count - 0.5)));
  return poses;
}

double RobotTrajectory::length_m() const {
  double length = 0.0;
  for (std::size_t i = 1; i < poses_.size(); ++i) length += (poses_[i].translation - poses_[i - 1].translation).norm();
  return length;
}

}  // namespace rigproof
