// A plane in a picture that a lens, or the plane's own bow, bends.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rigproof/calib/geometry/homography.h"

namespace rigproof::detection {

/// The picture of a plane around one of its places, to second order, by coordinates of the plane.
struct LocalPlane {
  Eigen::Matrix2d by_place;             ///< derivative of the pixel
  Eigen::Vector2d by_xx, by_xy, by_yy;  ///< second derivatives

  /// From the place to where a pixel lies on the plane; the pixel is given from the place's picture.
  Eigen::Vector2d place(const Eigen::Vector2d& pixel) const;
  /// Of the lines along the plane's x and y in the picture [1/px], positive where they bend from their direction
  /// towards what lies clockwise of it, as image axes turn.
  Eigen::Vector2d curvature() const;
};

/// A homography and a polynomial of second degree. They leave a hundredth of a square even at a fisheye's border.
class BentPlane {
 public:
  /// Numbers that a fit takes up: the homography's eight and six of the polynomial's twelve, as it follows the others.
  static constexpr int kUnknowns = 14;

  /// Absent where there are too few points to tell.
  static std::optional<BentPlane> fit(const std::vector<PlanePoint>& points);

  /// False where the homography has no picture of a place.
  bool map(const Eigen::Vector2d& place, Eigen::Vector2d* pixel) const;

  /// Absent where the homography has no picture.
  std::optional<LocalPlane> near(const Eigen::Vector2d& place) const;

 private:
  using Bends = Eigen::Matrix<double, 6, 2>;

  BentPlane(const Homography& H, const Bends& bends) : H_(H), bends_(bends) {}

  Homography H_;
  Bends bends_;
};

}  // namespace rigproof::detection
