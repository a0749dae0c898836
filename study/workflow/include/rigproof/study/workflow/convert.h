// Recordings from one format to another, images included.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "rigproof/formats/format.h"

namespace rigproof {

struct ConvertOptions {
  /// Clouds made of depth images are thinned to at most this many points.
  int max_cloud_points = 12000;
  /// What was observed in the recording, if it was: formats with corners then search none.
  const Observations* observations = nullptr;
  /// Called with (images done, images in all); return false to interrupt, which throws Error with kTryAgain.
  std::function<bool(std::size_t, std::size_t)> progress;
};

/// Writes a recording in one of writable_formats(). The folder appears whole or not at all; throws Error if there is
/// something in its place, and with every problem for what the format cannot say.
ConvertReport convert(const Recording& recording, const std::string& format, const std::filesystem::path& folder,
                      const ConvertOptions& options = {});

}  // namespace rigproof
