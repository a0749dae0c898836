// Opens whatever a user points at: a run, a bare recording, bare observations, or the MEMROC layout.
#pragma once

#include <filesystem>
#include <optional>

#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/run_folder.h"

namespace rigproof {

/// Exactly one of `recording` and `observations` may be absent.
struct Input {
  InputKind kind = InputKind::kRecording;
  std::filesystem::path path;
  std::optional<Recording> recording;
  std::optional<Observations> observations;  ///< only where the input itself is observations
};

/// Tells the kind by the shape of the folder and reads it. Throws Error with every problem found.
Input open_input(const std::filesystem::path& path);

}  // namespace rigproof
