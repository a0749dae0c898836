// RobotAutocalib (Zuniga-Noel et al., RA-L 2019): planar hand-eye calibration of sensors whose motions have an unknown
// scale, and whose height and tilt come from points on the ground.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"
#include "rigproof/core/rigid3.h"

namespace rigproof::rivals {

/// One motion of a sensor between two stops.
struct SensorMotion {
  int from = 0, to = 0;  ///< stops
  Rigid3 A;              ///< T_Ri_Ri+1 by odometry, planar
  Rigid3 B;              ///< T_Ci_Ci+1; the translation may have any scale, the same for all motions of a sensor
};

struct AutocalibSensor {
  std::string name;
  std::vector<SensorMotion> motions;
  std::vector<Eigen::Vector3d> ground_points;  ///< in the sensor's frame, in the unit of `motions`' B
  bool metric_ground = false;                  ///< the points are metres whatever the motions' scale is
};

struct AutocalibPose {
  Rigid3 T_robot_sensor;
  double scale = 1.0;         ///< metres a unit of the sensor's motions
  std::vector<bool> inliers;  ///< of the sensor's motions
};

/// A pose or the reason why there is none; in the order of the sensors.
struct AutocalibResult {
  std::vector<std::optional<AutocalibPose>> poses;
  std::vector<std::optional<Finding>> reasons;  ///< absent where there is a pose
};

/// Ground by least squares in 1/|x|, refined with Cauchy's loss; motions levelled; closed form with free scale inside
/// LO-RANSAC; then all sensors together with a term for every pair that shares six motions. Deterministic.
AutocalibResult robot_autocalib(const std::vector<AutocalibSensor>& sensors);

/// As a result: poses, pairs, scales as notes, reasons for sensors without a pose. Sensors are the rig's cameras.
Result result_of(const Observations& observations, const std::vector<AutocalibSensor>& sensors,
                 const AutocalibResult& found);

/// Roll and pitch that level a sensor, and its height.
struct GroundLevel {
  double roll_rad = 0.0, pitch_rad = 0.0;  ///< R = R_y(pitch) R_x(roll) turns sensor axes to level ones
  double height = 0.0;

  Eigen::Quaterniond levelling() const;
};
/// Absent with fewer than three points or points on a line.
std::optional<GroundLevel> fit_ground_level(const std::vector<Eigen::Vector3d>& points);

}  // namespace rigproof::rivals
