// Intrinsics of several cameras in one file, as Kalibr writes them: camchain-NAME.yaml.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/camera_info.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

struct CamchainCamera {
  std::string name;                       ///< "cam0"
  std::string rostopic;                   ///< of the images that it was calibrated with; empty: not told
  CameraInfo info;                        ///< without P
  std::optional<Rigid3> T_this_previous;  ///< T_cn_cnm1: of the camera before it in the chain
};

/// In the file's order. Empty: the file is no camchain. Throws Error with every problem of one.
std::optional<std::vector<CamchainCamera>> read_camchain(const std::filesystem::path& file);

}  // namespace rigproof
