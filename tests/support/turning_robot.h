// Observations of a robot that turns about another point than its origin.
#pragma once

#include <functional>
#include <optional>

#include "rigproof/core/observations.h"

namespace rigproof {

/// As observed where the rig states the point: of the origin, by the yaw as recorded.
/// @param observations of the point
/// @param recorded what is wrong with the odometry's poses as they were recorded
inline Observations of_origin(
    Observations observations, const Eigen::Vector2d& point_m, std::optional<double> sigma_m,
    const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& recorded = [](const auto& pose) { return pose; }) {
  const auto moved = [&](const Eigen::Vector3d& pose) { return odometry_of_point(recorded(pose), -point_m); };
  for (Stop& stop : observations.stops) {
    const Eigen::Vector3d pose = moved({stop.x_m, stop.y_m, stop.yaw_rad});
    stop.x_m = pose.x();
    stop.y_m = pose.y();
    stop.yaw_rad = pose.z();
    for (Eigen::Vector3d& row : stop.way) row = moved(row);
  }
  observations.odometry_noise.rotation_centre_m = point_m;
  observations.odometry_noise.rotation_centre_sigma_m = sigma_m;
  return observations;
}

}  // namespace rigproof
