// Changed intrinsics, and their effect on planes of registered depth images.
#pragma once

#include <Eigen/Core>

#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// Whether a plane comes from a depth image that is registered to the colour camera: its rays then use the stated
/// intrinsics, and share their error. Simulated planes (without a file) are exact.
bool is_registered(const PlaneObservation& plane, const RigCamera& camera);
/// Whether it comes from points in the colour camera's frame: a driver made them, mostly with the stated intrinsics.
bool is_cloud(const PlaneObservation& plane, const RigCamera& camera);
/// Either: what such a plane is depends on how wrong the stated lens is.
inline bool follows_lens(const PlaneObservation& plane, const RigCamera& camera) {
  return is_registered(plane, camera) || is_cloud(plane, camera);
}

/// By how much a lens differs from the stated one: both focal lengths (relative), principal point along x and y [px],
/// fx / fy (relative), radial displacement in the farthest corner of the image [px].
using LensChange = Eigen::Matrix<double, 5, 1>;

/// Derivative of the lens's leading coefficient, of the third power of radius or angle, by LensChange[4] [1/px].
double coefficient_by_px(const Camera& lens);

/// The lenses that a stated one may be.
class Lenses {
 public:
  explicit Lenses(const Camera& stated);
  Camera changed(const LensChange& change) const;
  double coefficient_by_px() const { return coefficient_by_px_; }
  /// Derivative of a registered plane [1/m] by a change: 1/z = a . ray(u) holds for the rays of all pixels u, so other
  /// rays need another a. Exact and linear in the first four; of the distortion as planes that fill the image show it.
  Eigen::Matrix<double, 3, 5> plane_by(const Eigen::Vector3d& plane_per_m) const;

 private:
  Camera stated_;
  double coefficient_by_px_;
  Eigen::Matrix3d plane_by_distortion_;
};

/// Changes a camera's focal length (relative) and principal point [px] and, accordingly, its registered planes.
void change_lens(int camera, const Eigen::Vector3d& change, Observations* observations);

}  // namespace rigproof::ml
