// The robot on its wheels: MuJoCo moves it by contact and friction, at a fixed step, in one thread, so that one
// configuration gives one drive.
//
// The robot is driven by <velocity> actuators on its wheels' hinges. It slips where wheels must slip, tilts and settles
// where its tyres give way. What it touches is told; a scene whose floor is a plane is stepped without its furniture,
// which is some times faster, so that nothing is pushed.
#pragma once

#include <memory>
#include <string>

#include "rigproof/core/rigid3.h"
#include "rigproof/sim/world.h"

namespace rigproof {

struct PhysicsOptions {
  double wheel_diameter_ratio = 1.0;                              ///< right over left (UMBmark's E_d), the mean stays
  double friction = 0.0;                                          ///< of the wheels; 0 = the robot's own
  double payload_kg = 0.0;                                        ///< a point of mass fixed to the chassis
  Eigen::Vector3d payload_at_m = Eigen::Vector3d(0.0, 0.0, 0.4);  ///< robot frame

  /// Whether the robot stands otherwise than its model.
  bool changes_stance() const { return wheel_diameter_ratio != 1.0 || payload_kg > 0.0; }
};

/// One robot in one world. One thread at a time; copies of nothing are shared with the World that renders.
class DrivePhysics {
 public:
  /// Throws Error where the robot has no wheels to drive: <velocity> actuators on hinges on both sides.
  DrivePhysics(const WorldDescription& description, const PhysicsOptions& options);
  ~DrivePhysics();
  DrivePhysics(const DrivePhysics&) = delete;
  DrivePhysics& operator=(const DrivePhysics&) = delete;

  /// Puts the robot on the ground, at rest, and the clock to zero. The first steps let it settle.
  void place(double x_m, double y_m, double yaw_rad);
  /// One step of step_s(), with the wheels of each side commanded to a speed [rad/s].
  void step(double left_rad_s, double right_rad_s);

  double step_s() const;
  double time_s() const;
  /// The model's robot frame, fixed to the chassis: at rest on flat ground, on equal wheels and without payload, it
  /// lies in the ground.
  Rigid3 T_world_robot() const;
  /// The same on these wheels and with this payload, at rest on flat ground, which lies below it and has its heading:
  /// how the robot leans and how deep it sinks. Identity where nothing changes its stance.
  Rigid3 T_ground_robot() const;
  /// Angle that the wheels of a side have turned, their mean [rad].
  double left_wheels_rad() const;
  double right_wheels_rad() const;
  /// Speed of the robot's origin [m/s] and largest angular speed [rad/s].
  double speed_m_s() const;
  double turn_rate_rad_s() const;
  /// Angle between the chassis and the vertical [rad].
  double tilt_rad() const;
  /// Name of something other than the ground that the robot touches now, or empty. Costs as much as several steps.
  std::string touched() const;

  /// Name of something nearer than `clearance_m` to a robot that stood there on level ground, or empty. At most
  /// kMaxClearance_m. Does not disturb the drive.
  std::string obstacle(const Rigid3& T_world_robot, double clearance_m) const;
  static constexpr double kMaxClearance_m = 0.15;

  /// The state of the drive, to go back to.
  class Snapshot;
  std::shared_ptr<const Snapshot> save() const;
  void restore(const Snapshot& snapshot);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigproof
