// Drives past a board whose corners are exact, and what can be done to them.
#pragma once

#include <algorithm>
#include <cstdint>

#include "rigproof/core/result.h"
#include "synthetic_drive.h"

namespace rigproof {

/// Three forward cameras with depth, exact corners, exact odometry, exact planes.
SyntheticDrive exact_drive(std::uint64_t seed, int stops = 20);

/// The same with the noise of a good robot: 0.02 px, 0.2 mm and 0.2 mrad a step.
SyntheticDrive fine_drive(std::uint64_t seed, int stops = 20);

/// The same drive with the board turned in its plane, about its centre: corners are drawn anew, without noise.
void turn_board(double angle_rad, SyntheticDrive* drive);

/// Drops every view (and plane) for which `keep(stop, camera)` is false.
template <typename Keep>
void keep_views(const Keep& keep, SyntheticDrive* drive) {
  Observations& o = drive->observations;
  const auto drop = [&keep](const auto& item) { return !keep(item.stop, item.camera); };
  o.board_views.erase(std::remove_if(o.board_views.begin(), o.board_views.end(), drop), o.board_views.end());
  o.ground_planes.erase(std::remove_if(o.ground_planes.begin(), o.ground_planes.end(), drop), o.ground_planes.end());
}

/// Largest distance [m] and angle [rad] of any camera's pose in the robot from the truth. Fails the test where a pose
/// is missing or not whole.
struct WorstError {
  double distance_m = 0.0, height_m = 0.0, angle_rad = 0.0;
};
WorstError worst_error(const Result& result, const SyntheticDrive& drive);
/// The same for the pairs of cameras.
WorstError worst_pair_error(const Result& result, const SyntheticDrive& drive);

}  // namespace rigproof
