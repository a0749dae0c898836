// Robots that nobody here built: their cameras, board, world and wheels, drawn.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

namespace rigproof::bench {

struct StrangersRobot {
  std::string rig;      ///< its rig file
  std::string run;      ///< its run's configuration, without the line that names the rig file
  std::string summary;  ///< what it is, in a few words
};

/// How fine the lenses' fields are: cells across the image. Nobody states it, so that robots have all of them in turn.
inline constexpr std::array<int, 3> kLensCells = {8, 11, 16};
/// The shipped presets of sensors with each of these, NAME_8 and so on, for $RIGPROOF_PATH.
void write_sensors(const std::filesystem::path& folder);

/// Depends on the number alone. Robots count through the ten worlds, three ways to know how far the robot went (noise
/// on each motion, wheels whose radii, track and turning point are not what is stated, and physics) and, every ten
/// robots, how fine their lenses' fields are.
/// @param stops of the drive; @param image_scale as in a run's configuration.
StrangersRobot strangers_robot(std::uint64_t number, int stops, double image_scale);

}  // namespace rigproof::bench
