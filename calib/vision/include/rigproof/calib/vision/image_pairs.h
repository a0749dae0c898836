// Matches between the consecutive images of a camera.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rigproof/calib/input/method_input.h"
#include "rigproof/calib/vision/feature_source.h"
#include "rigproof/calib/vision/relative_pose.h"

namespace rigproof::rivals {

struct ImagePair {
  int camera = 0;
  int from = 0, to = 0;  ///< stops; -1 for images of a segment
  std::vector<RayMatch> matches;
  const CameraFrame *image_from = nullptr, *image_to = nullptr;  ///< in the recording
  std::string key = {};  ///< of the matches in MethodInput::memory; empty: they are not kept
};

/// Where features of an input come from: what the input names, else SIFT.
class Features {
 public:
  explicit Features(const MethodInput& input)
      : own_(input.features == nullptr ? sift_features() : nullptr),
        source_(input.features == nullptr ? *own_ : *input.features) {}
  const FeatureSource& source() const { return source_; }

 private:
  std::unique_ptr<FeatureSource> own_;
  const FeatureSource& source_;
};

/// work(i) for every image, in parallel as the input says and with its progress. Throws Error with
/// ExitCode::kTryAgain if it is interrupted.
void for_each_image(const MethodInput& input, std::size_t count, const std::function<void(std::size_t)>& work);
/// The same for pieces that are no images: without telling progress.
void for_each_piece(const MethodInput& input, std::size_t count, const std::function<void(std::size_t)>& work);

/// Of every camera, each image with the next one, by (camera, stop). Images that cannot be read are skipped, as are
/// steps that `wanted` turns down. Does not depend on the number of threads.
/// @param wanted is asked with (camera, from, to)
std::vector<ImagePair> match_consecutive_images(const MethodInput& input, const FeatureSource& source,
                                                const std::function<bool(int, int, int)>& wanted);

/// Pairs of stops of a camera, in the order in which they are to stand.
using StopPairs = std::vector<std::pair<int, int>>;
/// Of every camera, the images of those pairs of stops that `choose` takes. Images that cannot be read have no matches.
/// Does not depend on the number of threads.
/// @param choose is given a camera and the stops at which it has an image
std::vector<ImagePair> match_images(const MethodInput& input, const FeatureSource& source,
                                    const std::function<StopPairs(int, const std::vector<int>&)>& choose);

/// Of every camera, each image of a straight segment of the recording with the next one, which the robot reached by
/// driving ahead.
std::vector<ImagePair> match_straight_segments(const MethodInput& input, const FeatureSource& source);

/// Of every camera, the images of straight segments, in the order in which they were taken.
std::vector<std::pair<int, const CameraFrame*>> straight_segment_images(const Recording& recording);

/// How many steps straight segments have, at most, for one camera; no image is opened.
std::size_t straight_segment_steps(const Recording& recording);

/// How many steps from image to image turn, at most, for one camera; no image is opened.
std::size_t turning_steps(const Observations& observations, const Recording& recording);

/// estimate_relative_pose() of a pair's matches, or what the input's memory holds of it. Throws as
/// throw_if_interrupted().
/// @param sigma_px of a match
std::optional<RelativePose> relative_pose_of(const MethodInput& input, const ImagePair& pair, double sigma_px);

/// A pixel of this camera as a difference of rays.
double ray_sigma(const Camera& camera, double sigma_px);

}  // namespace rigproof::rivals
