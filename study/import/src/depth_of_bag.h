// Whether and how a topic of depth images goes with a camera.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bag_survey.h"
#include "rigproof/core/rig.h"

namespace rigproof {

/// Where depth lies: in the colour camera (no camera of its own), or in one of its own, whose pose /tf_static tells.
/// Nothing, with a note that says what to do, where neither is known.
std::optional<DepthStream> depth_of_topic(const BagSurvey& survey, const ImageTopic& depth, const ImageTopic& images,
                                          const Camera& camera, std::vector<std::string>* notes);

/// For each image the depth that is nearest in time, within 20 ms.
struct DepthPairs {
  std::vector<std::optional<std::size_t>> nearest;  ///< [image] index into the depth images
  double largest_gap_s = 0.0;                       ///< of those that have one
  double least_gap_s = 0.0;                         ///< of all images
};
/// Both by stamp, not empty.
DepthPairs pair_depth(const std::vector<StampedPlace>& images, const std::vector<StampedPlace>& depth);

}  // namespace rigproof
