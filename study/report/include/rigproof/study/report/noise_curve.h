// How a depth sensor's noise grows with distance.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/generator/sensor_device.h"

namespace rigproof {

/// The simulated depth of a wall.
struct NoisePoint {
  double z_m = 0.0;
  double law_m = 0.0;       ///< sigma by the preset's law
  double recorded_m = 0.0;  ///< sigma by the law, with rounding to disparity steps and to the unit
  double realised_m = 0.0;  ///< standard deviation of simulated depth
  double mean_error_m = 0.0;
};

/// Walls at `count` distances spread over the sensor's range, and at 0.8, 1, 2 and 4 m where these are inside of it;
/// 640x480 pixels each, in the order of distance. Throws Error if the sensor has no depth.
std::vector<NoisePoint> measure_noise(const SensorDevice& device, int count = 8);

/// Law and rounding at many distances, and the simulation at some: columns z_m, law_mm, recorded_mm, simulated_mm,
/// mean_error_mm; the last two are empty without a simulation.
std::string noise_csv(const SensorDevice& device, const std::vector<NoisePoint>& points);

/// Draws that into a PNG, PDF or SVG by draw_figures(); the CSV lies beside it. Throws Error.
void write_noise_curve(const SensorDevice& device, const std::vector<NoisePoint>& points,
                       const std::filesystem::path& file);

}  // namespace rigproof
