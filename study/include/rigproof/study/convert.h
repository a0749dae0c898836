// Recordings from one layout to another, images included.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "rigproof/core/recording.h"

namespace rigproof {

struct ConvertOptions {
  /// Clouds made of depth images are thinned to at most this many points.
  int max_cloud_points = 12000;
  /// Called with (images done, images in all); return false to interrupt, which throws Error with kTryAgain.
  std::function<bool(std::size_t, std::size_t)> progress;
};

struct ConvertReport {
  std::size_t images = 0;
  std::size_t clouds = 0;
  std::vector<std::string> notes;  ///< what the other layout has no place for, in sentences
};

/// Writes a recording of our own with copies of every image, depth image and cloud that its frames name, and nothing
/// else. The folder appears whole or not at all; throws Error if there is something in its place.
ConvertReport copy_recording(const Recording& recording, const std::filesystem::path& folder,
                             const ConvertOptions& options = {});

/// Writes the layout of the MEMROC authors' program. A stop is a frame number; of several images of a camera at one
/// stop the middle one is taken. Depth images become clouds in the colour camera's frame. Throws Error if there is
/// something in the folder's place, and with every problem for what the layout cannot say (a fisheye lens, a board
/// that is ambiguous under half a turn).
ConvertReport write_memroc_layout(const Recording& recording, const std::filesystem::path& folder,
                                  const ConvertOptions& options = {});

}  // namespace rigproof
