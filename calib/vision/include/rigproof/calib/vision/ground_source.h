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

/// Cameras, by index, whose depth shows the ground too rarely: in fewer than three images, or in less than a fifth of
/// the images that show the board. Only planes that agree with the vertical and with each other count.
std::vector<int> cameras_without_trusted_depth(const Observations& observations);

/// What take_ground_from() did.
struct GroundReport {
  std::vector<Finding> findings;  ///< one for each camera that was to take its ground from images
  std::vector<int> cameras;       ///< that now do, by index
};
/// Chooses cameras by `source` and replaces their ground planes by planes triangulated from images (image_ground.h).
/// The depth of such a camera is no longer used: its board planes are removed, and its depth stream now describes the
/// triangulation, whose heights share an error of 0.1 % (one sigma). Pairs of images that show no ground become
/// exclusions of depth. Under kAuto a camera whose images show no ground keeps what its depth gave. Without a recording
/// nothing changes. Deterministic. Throws Error with ExitCode::kTryAgain if MethodInput::progress says so.
/// @param input with the recording, features and progress; its observations are not looked at
GroundReport take_ground_from(GroundSource source, const MethodInput& input, Observations* observations);

}  // namespace rigproof
