// odometry.csv: stamp_s,x_m,y_m,yaw_rad and any other columns, with or without a header.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/core/recording.h"

namespace rigproof {

/// Reads every row; numbers that are not finite, missing columns, and stamps that repeat or go back are reported.
std::vector<OdometrySample> read_odometry_csv(const std::filesystem::path& file, Problems* problems);
/// Whether its first line names its columns; true also of what read_odometry_csv() refuses for another reason.
bool has_odometry_header(const std::filesystem::path& file);
/// With a header; each number reads back to the same double.
std::string odometry_csv(const std::vector<OdometrySample>& odometry);

}  // namespace rigproof
