// A picture of how a depth sensor's noise grows with distance.
#pragma once

#include <filesystem>
#include <vector>

#include "rigproof/core/rig_yaml.h"

namespace rigproof {

/// What the simulated sensor makes of a wall.
struct NoisePoint {
  double z_m = 0.0;
  double law_m = 0.0;       ///< sigma by the preset's law
  double recorded_m = 0.0;  ///< sigma by the law, with rounding to disparity steps and to the unit
  double realised_m = 0.0;  ///< standard deviation of simulated depth
  double mean_error_m = 0.0;
};

/// Walls at `count` distances spread over the sensor's range, and at 0.8, 1, 2 and 4 m where these are inside of it;
/// 640x480 pixels each, in the order of distance. Throws Error if the sensor has no depth.
std::vector<NoisePoint> measure_noise(const SensorPreset& preset, int count = 8);

/// Draws law, rounding and realised noise over distance as a PNG. Throws Error.
void write_noise_curve(const SensorPreset& preset, const std::filesystem::path& file);

}  // namespace rigproof
