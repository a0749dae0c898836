#include "bent_face.h"

#include <Eigen/QR>
#include <algorithm>
#include <vector>

namespace rigproof {

BentFace::BentFace(const TrueBoard& board)
    : centre_(board.board.centre()), scale_m_((board.board.outline()[2] - board.board.outline()[0]).norm()) {
  const std::vector<Eigen::Vector3d>& corners = board.printed_corners;
  if (corners.size() < static_cast<std::size_t>(factors_.size())) return;
  Eigen::Matrix<double, Eigen::Dynamic, 6> A(static_cast<Eigen::Index>(corners.size()), 6);
  Eigen::VectorXd z(A.rows());
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const Eigen::Vector3d& corner = corners[static_cast<std::size_t>(i)];
    A.row(i) = terms(corner.x(), corner.y()).transpose();
    z[i] = corner.z();
  }
  // Two rows of corners tell no bend across them: then there is the least.
  factors_ = A.completeOrthogonalDecomposition().solve(z);
}

double BentFace::z_m(double x_m, double y_m) const {
  // Far off the board the paraboloid would come back to it.
  const double reach = 0.5 * scale_m_;
  return terms(std::clamp(x_m, centre_.x() - reach, centre_.x() + reach),
               std::clamp(y_m, centre_.y() - reach, centre_.y() + reach))
      .dot(factors_);
}

BentFace::Terms BentFace::terms(double x_m, double y_m) const {
  const double x = (x_m - centre_.x()) / scale_m_, y = (y_m - centre_.y()) / scale_m_;
  return (Terms() << 1.0, x, y, x * x, x * y, y * y).finished();
}

}  // namespace rigproof
