// The ground from images alone: for cameras without depth, and where depth sensors are blind.
#pragma once

#include <string>
#include <vector>

#include "rigproof/calib/input/method_input.h"
#include "rigproof/calib/vision/feature_source.h"

namespace rigproof {

struct ImageGroundOptions {
  double match_sigma_px = 0.4;    ///< standard deviation of a matched feature
  double max_depth_m = 8.0;       ///< points that may lie beyond it, by three of their standard deviations, are too far
  double max_depth_sigma = 0.05;  ///< of a point, as a share of its depth: others take what stands on the floor into
                                  ///< it; four times as much where these show no floor
  int min_points = 40;            ///< on the ground in one pair of images
};

struct ImageGround {
  /// As the depth sensor's would be, of the first image of each pair; sorted by (stop, camera).
  std::vector<PlaneObservation> planes;
  std::vector<Exclusion> rejected;  ///< pairs of images that show no ground, with the reason
};

/// Looks at cameras that have no ground plane in the observations. Each image that shows the board is paired with the
/// image of the same camera that best shows the same floor from a little aside, whenever it was taken; the board gives
/// both poses. Features are matched and triangulated by DLT, and the ground is fitted by RANSAC and least squares in
/// inverse depth, as in a depth image, each point with the weight that the step between the images gives it. Planes off
/// the vertical of the cameras' motion, or at another height than their camera's other planes, are rejected.
/// Deterministic. Needs MethodInput::recording; without it there are no planes. See docs/guides/ground-from-images.md.
ImageGround ground_from_images(const MethodInput& input, const FeatureSource& source,
                               const ImageGroundOptions& options = {});

}  // namespace rigproof
