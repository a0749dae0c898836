// Trajectories as other programs write them: poses in space by time. A format is one file in core/formats/src that
// tells whether a text is of it and reads it, and one line of the registry in trajectory.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

struct TrajectoryPose {
  double stamp_s = 0.0;
  Rigid3 T_world_body;  ///< x forward, y left, z up, as far as the file says
};

struct TrajectoryFormat {
  std::string name;    ///< "tum"
  std::string layout;  ///< "stamp_s tx ty tz qx qy qz qw"
  /// By the first line that is no comment, split at commas or blanks; comments come in `head`.
  bool (*detect)(const std::vector<std::string_view>& fields, std::string_view head) = nullptr;
  /// Adds problems with file and line.
  std::vector<TrajectoryPose> (*read)(const std::filesystem::path& file, std::string_view text,
                                      Problems* problems) = nullptr;
};

/// All of them, in the order in which a file is tried.
const std::vector<TrajectoryFormat>& trajectory_formats();

/// Reads a trajectory of whichever format it is. Throws Error with every problem, with what was looked for where it is
/// none of them, and for stamps that do not increase.
std::vector<TrajectoryPose> read_trajectory(const std::filesystem::path& file);

/// Whether its first line is one of a trajectory; reading it may still fail.
bool looks_like_trajectory(const std::filesystem::path& file);

// For the files of the formats.

/// The numbers of the lines that are no comments, each line with its number; `width` of them in each, more are left
/// out. Adds problems for lines that have fewer, or hold what is no number.
struct NumberLine {
  int line = 0;
  std::vector<double> numbers;
};
std::vector<NumberLine> number_lines(const std::filesystem::path& file, std::string_view text, std::size_t width,
                                     const std::string& layout, Problems* problems);
/// The fields of a line, between commas or blanks.
std::vector<std::string_view> fields_of(std::string_view line);
/// A unit quaternion of x y z w. Adds a problem where the norm is not 1 within 1 %.
Eigen::Quaterniond quaternion_of(double x, double y, double z, double w, const std::filesystem::path& file, int line,
                                 Problems* problems);

}  // namespace rigproof
