// The ground (or the board) as a plane in one depth image.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/image.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/rig.h"

namespace rigproof {

/// Depth measurements of one frame as points in the colour camera's frame.
struct DepthPoints {
  std::vector<Eigen::Vector3f> points;  ///< [m], z > 0, in the order of the image's rows
  double points_per_measurement = 1.0;  ///< points that share one independent measurement (correlated noise)
  double unit_m = 0.0;                  ///< step to which depth was rounded; part of the noise
  /// Range of the sensor: near its ends noise is cut off on one side, so such points are not fitted.
  double min_m = 0.0;
  double max_m = std::numeric_limits<double>::infinity();
  /// Sigma of 1/z of each point [1/m]; empty: that of the sensor's noise.
  std::vector<double> inverse_depth_sigmas_per_m = {};
  /// Of the whole image, for messages; 0: unknown, or no depth at all.
  double nearest_m = 0.0;
  double farthest_m = 0.0;
};

/// Points of a 16-bit depth image on a grid of every `stride` pixels, inside the sensor's range. Throws Error if the
/// camera has no depth stream or the image another size.
DepthPoints points_from_depth(const Image16& depth, const RigCamera& camera, int stride);
/// The smallest stride at which there are no more than `most` pixels.
int sampling_stride(int width, int height, int most);
/// With that stride.
DepthPoints sampled_depth(const Image16& depth, const RigCamera& camera, int most);
/// Points of a cloud in the colour camera's frame [m] that are inside the sensor's range; of more than `most` every
/// second, third .. one.
DepthPoints points_from_cloud(std::vector<Eigen::Vector3f> cloud, const DepthStream& depth, int most);

struct GroundPlaneOptions {
  /// Largest angle between the plane's normal and the expected up direction, if that is known [rad].
  double max_tilt_rad = 0.35;
  /// Inliers lie within this many of the sensor's standard deviations.
  double inlier_sigmas = 3.0;
  int min_inliers = 100;
};

/// A plane or why there is none.
struct GroundPlaneFit {
  std::optional<PlaneObservation> plane;
  std::optional<Finding> why_not;
};

/// PCL RANSAC at a threshold derived from the sensor's noise, then least squares in inverse depth on the inliers
/// (1/z = a . ray is linear, and Gaussian for stereo), repeated until the inliers settle. RANSAC too runs on
/// (x/z, y/z, 1/z), where planes are planes and the noise is the same near and far. The covariance counts only the
/// independent points, by the stated correlation or by that of the residuals if it is longer.
/// Deterministic; about a millisecond for 10,000 points.
/// @param up_camera expected up direction in the camera frame, from the rotation axis of the camera's own motion: the
///        lowest plane of that normal is taken, so that a table is not the floor; absent: the largest plane below the
/// camera is taken, and the later trajectory check rejects walls.
GroundPlaneFit fit_ground_plane(const DepthPoints& points, const DepthNoise& noise,
                                const std::optional<Eigen::Vector3d>& up_camera,
                                const GroundPlaneOptions& options = {});

/// Which of the points lie on the plane as a fit takes its inliers, but for those beside something that stands on it:
/// within `sigmas` standard deviations, the sensor's times what the plane's own inliers leave of it.
std::vector<bool> lie_on_plane(const DepthPoints& points, const DepthNoise& noise, const PlaneObservation& plane,
                               double sigmas = 3.0);

}  // namespace rigproof
