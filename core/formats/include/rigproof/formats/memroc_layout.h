// The layout of the MEMROC authors' program: CalibrationInfo.yaml and cameraN/{image,clouds,pose}.
#pragma once

#include <filesystem>

#include "rigproof/core/recording.h"

namespace rigproof {

/// True if the folder holds CalibrationInfo.yaml.
bool is_memroc_layout(const std::filesystem::path& folder);

/// Reads it as a recording. `number_of_rows` counts the inner corners along the board's x axis, as that program's
/// cv::Size(rows, columns); poses are T_world_robot; clouds are text, x y z in the camera frame, metres. Frames with
/// the same number belong to the same stop. Throws Error with every problem found.
Recording load_memroc_layout(const std::filesystem::path& folder);

}  // namespace rigproof
