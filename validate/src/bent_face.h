// The printed face of a board that is not flat.
#pragma once

#include <Eigen/Core>

#include "rigproof/truth/truth.h"

namespace rigproof {

/// How far the face stands out of the board's plane, as its corners tell: a paraboloid through them.
class BentFace {
 public:
  explicit BentFace(const TrueBoard& board);
  /// z of the face at a place [board frame, m]; 0 where nothing bends it, beside the board as at its edge.
  double z_m(double x_m, double y_m) const;

 private:
  using Terms = Eigen::Matrix<double, 6, 1>;
  Terms terms(double x_m, double y_m) const;

  Eigen::Vector3d centre_;
  double scale_m_;
  Terms factors_ = Terms::Zero();
};

}  // namespace rigproof
