// motion: drive of a configuration: viewpoints that can be driven to, the drive, and its odometry's errors in figures.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "rigproof/generator/config.h"
#include "rigproof/generator/drive.h"
#include "rigproof/generator/viewpoints.h"
#include "rigproof/sim/models.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

/// What the configuration's distributions gave: drawn once a run.
struct DrivePhysicsDraw {
  PhysicsOptions physics;
  std::map<std::string, double> drawn;  ///< for the truth, by field
};
DrivePhysicsDraw draw_physics(const DriveConfig& config, std::uint64_t seed);

/// The floor's unevenness and ramps: whole wherever wheels come in the scene's drivable area, and level farther off.
GroundRelief ground_of(const DriveConfig& config, const FloorArea& area, std::uint64_t seed);

/// Plans viewpoints with room around them and drives through them. `plan` is what was reached.
struct DrivenViewpoints {
  ViewpointPlan plan;
  Drive drive;
};
/// @param progress told of the viewpoints reached, and how many they are; return false to interrupt: Error kTryAgain
DrivenViewpoints drive_viewpoints(const GenerateConfig& config, const WorldDescription& description,
                                  const RobotModel& robot, const ViewpointSubject& subject, World& world,
                                  const PhysicsOptions& physics,
                                  const std::function<bool(std::size_t, std::size_t)>& progress = {});

/// The noise law that comes nearest to an odometry's errors from stop to stop: scale and yaw factor by least squares,
/// and what is left over.
struct OdometryFit {
  double scale = 1.0;
  double yaw_factor = 1.0;
  double rms_xy_m = 0.0;  ///< of x and of y
  double rms_yaw_rad = 0.0;
};
/// @param measured odometry at the stamps of the stops
OdometryFit fit_odometry(const std::vector<TrueStop>& stops, const std::vector<OdometrySample>& measured);
/// Odometry at a stamp, by straight interpolation.
OdometrySample odometry_at(const std::vector<OdometrySample>& odometry, double stamp_s);

}  // namespace rigproof
