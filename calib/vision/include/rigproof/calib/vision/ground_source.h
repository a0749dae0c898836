// Which cameras take their ground from depth and which from images.
#pragma once

#include <string>
#include <vector>

#include "rigproof/calib/input/method_input.h"
#include "rigproof/core/finding.h"

namespace rigproof {

enum class GroundSource {
  kDepth,   ///< what the depth images show; a camera without depth has no ground
  kImages,  ///< triangulated features for every camera, depth is not used
  kAuto,    ///< depth where it can be trusted, images for the other cameras
};
/// "depth", "images", "auto", in the order of the enumeration.
const std::vector<std::string>& ground_source_names();
/// Throws Error that names what is allowed.
GroundSource ground_source_by_name(const std::string& name);

/// Cameras whose depth shows the ground in too few of the images that show the board: at least three planes that agree
/// with the vertical and each other, and planes in a fifth of those images, are wanted. By index.
std::vector<int> cameras_without_trusted_depth(const Observations& observations);

/// What became of the observations: a note on each camera that was to take its ground from images, and those that do.
struct GroundReport {
  std::vector<Finding> findings;
  std::vector<int> cameras;  ///< by index
};
/// Replaces the ground planes of the cameras that `source` gives to images by triangulated ones (image_ground.h). The
/// depth of such a camera is not used any more: its board planes go, and its depth stream stands for the triangulation,
/// whose heights share an error of 0.2 %. Pairs of images that show no ground become exclusions of depth. A camera
/// whose images show no ground either keeps what its depth gave under kAuto. Without a recording there are no images,
/// and nothing changes. Deterministic. Throws Error with ExitCode::kTryAgain if MethodInput::progress says so.
/// @param input with the recording, features and progress; its observations are not looked at
GroundReport take_ground_from(GroundSource source, const MethodInput& input, Observations* observations);

}  // namespace rigproof
