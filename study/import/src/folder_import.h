// A folder of images with a trajectory as a recording.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/core/recording.h"
#include "rigproof/study/import/init.h"

namespace rigproof {

struct FolderPlan {
  Recording recording;
  /// Files of the source and what they become in the recording.
  std::vector<std::pair<std::filesystem::path, std::string>> copies;
  InitReport report;
};

/// Cameras are the folders of the source that hold images, or the source itself; stamps are their names, or come from
/// frames.csv (file,stamp_s), EuRoC's data.csv (stamp_ns,file) or TUM's rgb.txt (stamp_s file). Throws Error with every
/// problem.
FolderPlan plan_folder_import(const InitOptions& options);

/// Where the trajectory of a folder is: the one that the options name, or the only one in it. Throws Error.
std::filesystem::path find_trajectory(const InitOptions& options);

}  // namespace rigproof
