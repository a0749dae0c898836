// The images of a camera's folder and when they were taken.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/core/error.h"

namespace rigproof {

struct StampedFile {
  double stamp_s = 0.0;
  std::filesystem::path color;
  std::filesystem::path depth;  ///< of the same stem; empty: none
};

/// True if the folder, or one of those in it that recorders use, holds images.
bool has_images(const std::filesystem::path& folder);
/// By stamp, each once. Adds problems: names that are no stamps, lists of files that are not there.
std::vector<StampedFile> list_images(const std::filesystem::path& folder, Problems* problems);

}  // namespace rigproof
