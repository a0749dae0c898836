// A recording of six files that no one has to look at: two cameras, three stops, one of them with depth.
#pragma once

#include <filesystem>

#include "rigproof/core/recording.h"

namespace rigproof {

/// Writes it below `folder` and reads it back. Images are no pictures; depth images are.
Recording small_recording(const std::filesystem::path& folder);

}  // namespace rigproof
