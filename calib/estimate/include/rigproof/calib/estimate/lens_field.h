// What no distortion model follows of a lens: a smooth field over the image.
#pragma once

#include <Eigen/Core>

#include "rigproof/calib/estimate/lens_change.h"

namespace rigproof::ml {

/// Polynomials over a camera's image, without the part that a change of the lens (LensChange) or a turn of the camera
/// makes, and orthogonal to each other over the image.
class LensField {
 public:
  explicit LensField(const Camera& camera);
  const Camera& camera() const { return camera_; }
  /// Number of coefficients.
  int size() const { return static_cast<int>(combination_.cols()); }
  /// Displacement [px] by each coefficient, 2 x size; zero where the lens has no ray. Independent coefficients of unit
  /// variance make a field whose coordinates have a root mean square of 1 px over the image.
  Eigen::Matrix2Xd at(const Eigen::Vector2d& pixel) const;
  /// All that is followed: what a change of the lens and a turn of the camera make, then polynomials; 2 x columns, not
  /// independent. False where the lens has no ray.
  bool followed(const Eigen::Vector2d& pixel, Eigen::Matrix2Xd* columns) const;
  static int followed_size();

 private:
  Camera camera_;
  double coefficient_by_px_;
  Eigen::MatrixXd combination_;  // of raw columns
};

}  // namespace rigproof::ml
