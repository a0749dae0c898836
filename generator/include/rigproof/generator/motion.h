// How the robot gets from viewpoint to viewpoint, and where it was at any time.
#pragma once

#include <cstdint>
#include <vector>

#include "rigproof/core/fields.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// A bump that lies across the floor of a driven run.
struct RampConfig {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_deg = 0.0;
  double height_cm = 5.0;
  double level_m = 0.5;
  double rise_m = 1.0;
  double width_m = 2.0;

  void visit(FieldVisitor& visitor);
};

/// motion: drive. The robot drives by MuJoCo's physics; nothing else of the configuration changes.
struct DriveConfig {
  std::string capture = "standing";  ///< standing | moving
  double frame_rate_hz = 2.0;
  double max_speed_m_s = 0.8;
  double max_turn_deg_s = 57.0;
  double acceleration_m_s2 = 1.0;
  double settle_s = 0.7;
  double tolerance_cm = 1.5;
  double tolerance_deg = 0.7;
  double clearance_cm = 5.0;
  std::int64_t max_plans = 4;
  Distribution wheel_diameter_ratio = 1.0;
  Distribution friction = 0.0;
  Distribution payload_kg = 0.0;
  Distribution payload_x_m = 0.0;
  Distribution payload_y_m = 0.0;
  Distribution payload_z_m = 0.4;
  double unevenness_mm = 0.0;
  double unevenness_length_m = 1.5;
  std::vector<RampConfig> ramps;

  void visit(FieldVisitor& visitor);
};

/// Poses of the robot over time, dense enough to interpolate between. What a camera saw during an exposure follows.
class RobotTrajectory {
 public:
  /// Stamps increase strictly.
  void add(double stamp_s, const Rigid3& T_scene_robot);
  /// Forgets what lies after a stamp.
  void cut_after(double stamp_s);

  bool empty() const { return stamps_s_.empty(); }
  double begin_s() const { return stamps_s_.front(); }
  double end_s() const { return stamps_s_.back(); }
  const std::vector<double>& stamps_s() const { return stamps_s_; }
  /// T_scene_robot, one a stamp.
  const std::vector<Rigid3>& poses() const { return poses_; }
  /// T_scene_robot at a stamp, with a velocity that is continuous: it must not jump at samples, at whose stamps images
  /// are taken. Before the first sample and after the last, the robot stands.
  Rigid3 at(double stamp_s) const;
  /// Velocity at a stamp, linear [m/s] and angular [rad/s], in the robot's frame: the mean over 20 ms around it.
  Vector6d velocity(double stamp_s) const;
  /// The poses in the middles of `count` equal parts of an exposure: what motion blur sums, and at which a rolling
  /// shutter reads its rows.
  std::vector<Rigid3> during(double middle_s, double exposure_s, int count) const;
  /// Length of the way of the robot's origin [m].
  double length_m() const;

 private:
  Vector6d mean_velocity(std::size_t i) const;  // from sample i - 1 to i, in the frame of the first
  Vector6d velocity_at_sample(std::size_t i) const;

  std::vector<double> stamps_s_;
  std::vector<Rigid3> poses_;
};

}  // namespace rigproof
