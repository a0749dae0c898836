// The ground from images alone: for cameras without depth, and where depth sensors are blind.
#pragma once

#include <string>
#include <vector>

#include "rigproof/calib/feature_source.h"
#include "rigproof/calib/method.h"

namespace rigproof {

struct ImageGroundOptions {
  double match_sigma_px = 0.4;    ///< standard deviation of a matched feature
  double min_parallax_deg = 1.0;  ///< points seen under a smaller angle are too uncertain
  double max_distance_m = 8.0;    ///< of a point from the camera
  int min_points = 40;            ///< on the ground in one pair of images
};

struct ImageGround {
  /// As the depth sensor's would be, of the first image of each pair; sorted by (stop, camera).
  std::vector<PlaneObservation> planes;
  std::vector<Exclusion> rejected;  ///< pairs of images that show no ground, with the reason
};

/// Matches features between consecutive images of a camera that both show the board, whose poses the board gives;
/// triangulates them by DLT (refined by the covariance of depth), and fits the ground by RANSAC and least squares in
/// inverse depth, as in a depth image. Planes off the vertical of the cameras' motion, or at another height than their
/// camera's other planes, are rejected. Only cameras without a ground plane in the observations are looked at.
/// Deterministic. Needs MethodInput::recording; without it there are no planes.
ImageGround ground_from_images(const MethodInput& input, const FeatureSource& source,
                               const ImageGroundOptions& options = {});

}  // namespace rigproof
