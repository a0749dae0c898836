// The frames of one camera: from frames.csv, or from the images that lie in its folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/core/recording.h"

namespace rigproof {

/// Frames of the camera, sorted by stamp. Depth images and clouds of the same stem are attached.
std::vector<CameraFrame> list_frames(const std::filesystem::path& recording, const RigCamera& camera,
                                     const std::vector<OdometrySample>& odometry, Problems* problems);

/// frames.csv for the frames; files relative to the camera's folder. Columns for depth and clouds are written only
/// where the names would not tell.
std::string frames_csv(const std::vector<CameraFrame>& frames, const std::string& camera_folder);

}  // namespace rigproof
