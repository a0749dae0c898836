// What polynomials do not follow of a lens: displacements that differ from place to place of the image.
#pragma once

#include <Eigen/Core>
#include <array>

#include "rigproof/core/camera.h"

namespace rigproof::ml {

/// Cells of the grids, of which how fine the field is is not known: of eight and sixteen alone, eight made up for
/// fields of twelve, many times too large.
inline constexpr std::array<int, 3> kFineGrids = {8, 12, 16};

/// Cubic B-splines over a grid on a camera's image, with independent coefficients along x and along y: as smooth as
/// what lenses do.
class FineField {
 public:
  /// @param cells across the longer side, from 8: what is coarser polynomials follow
  FineField(const Camera& camera, int cells);
  /// Root mean square of a coordinate over the image where coefficients have unit variance.
  static constexpr double kRms = 151.0 / 315.0;

  int nodes() const { return across_ * down_; }
  /// Two for each node.
  int size() const { return 2 * nodes(); }
  struct Share {
    int node;
    double weight;
  };
  /// The nodes around a pixel, and how much each makes of the displacement there.
  std::array<Share, 16> at(const Eigen::Vector2d& pixel) const;
  /// Where a node lies [px]; the outermost ones are beyond the image.
  Eigen::Vector2d pixel_of(int node) const;

 private:
  double cell_px_;
  int across_, down_;
};

}  // namespace rigproof::ml
