// A plane in a picture that a lens, or the plane's own bow, bends.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rigproof/calib/geometry/homography.h"

namespace rigproof::detection {

/// Around a place of a plane, in units of the plane: its picture to second order.
struct LocalPlane {
  Eigen::Matrix2d by_place;             ///< derivative of the pixel
  Eigen::Vector2d by_xx, by_xy, by_yy;  ///< second derivatives

  /// Where on the plane, from that place, a pixel lies, which is given from the picture of the place.
  Eigen::Vector2d place(const Eigen::Vector2d& pixel) const;
};

/// A homography and a polynomial of second degree. They leave a hundredth of a square even at a fisheye's border.
class BentPlane {
 public:
  /// What points of both kinds of unknowns a fit takes from, beside the points: the homography follows six of the
  /// polynomial's twelve.
  static constexpr int kUnknowns = 14;

  /// Absent where there are too few points to tell.
  static std::optional<BentPlane> fit(const std::vector<PlanePoint>& points);

  /// False where the homography has no picture of a place.
  bool map(const Eigen::Vector2d& place, Eigen::Vector2d* pixel) const;

  /// Absent where the homography has no picture.
  std::optional<LocalPlane> near(const Eigen::Vector2d& place) const;

  /// Of the lines of the plane along its x and its y in the picture [1/px]: from the line's direction towards what lies
  /// clockwise of it, as image axes turn. Zero where the homography has no picture.
  Eigen::Vector2d curvature(const Eigen::Vector2d& place) const;

 private:
  using Bends = Eigen::Matrix<double, 6, 2>;

  BentPlane(const Homography& H, const Bends& bends) : H_(H), bends_(bends) {}

  Homography H_;
  Bends bends_;
};

}  // namespace rigproof::detection
