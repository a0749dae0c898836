// The files of a recording that describe it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/camera_info.h"
#include "rigproof/core/recording.h"

namespace rigproof {

struct RigText {
  const Rig& rig;
  bool has_board = false;
  std::vector<std::string> comments;  ///< lines before it
};

/// rig.yaml as a person would write it: the depth block of a camera without a sensor holds only what is known.
std::string rig_yaml_text(const RigText& text);

/// Intrinsics of a camera_info file. Throws Error with every problem.
InfoReading camera_of_file(const std::filesystem::path& file, bool rectified);

}  // namespace rigproof
