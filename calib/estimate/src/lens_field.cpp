#include "rigproof/calib/estimate/lens_field.h"

#include <array>
#include <cmath>

#include "corner_model.h"

namespace rigproof::ml {
namespace {

// Of polynomials of both coordinates together: a field that swings twice across the image.
constexpr int kDegree = 5;
constexpr int kPolynomials = (kDegree + 1) * (kDegree + 2) / 2;
constexpr int kOfLensAndTurn = 8;
constexpr int kRaw = kOfLensAndTurn + 2 * kPolynomials;
constexpr int kPointsAcross = 24, kPointsDown = 16;
constexpr double kIndependent = 1e-3;  // of a column's length: what is left of it is no combination of the others

// Legendre's polynomials of x and y in -1 .. 1, by rising degree.
Eigen::Matrix<double, kPolynomials, 1> polynomials(double x, double y) {
  std::array<double, kDegree + 1> of_x{1.0, x}, of_y{1.0, y};
  for (std::size_t n = 1; n < kDegree; ++n) {
    const double a = static_cast<double>(2 * n + 1), b = static_cast<double>(n), c = static_cast<double>(n + 1);
    of_x[n + 1] = (a * x * of_x[n] - b * of_x[n - 1]) / c;
    of_y[n + 1] = (a * y * of_y[n] - b * of_y[n - 1]) / c;
  }
  Eigen::Matrix<double, kPolynomials, 1> all;
  int next = 0;
  for (std::size_t degree = 0; degree <= kDegree; ++degree)
    for (std::size_t i = 0; i <= degree; ++i) all[next++] = of_x[degree - i] * of_y[i];
  return all;
}

// Gram and Schmidt, column by column, of A with A'A = G: A * combination has orthonormal columns, without those that
// begin among the first `dropped` ones or are made of others.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& G, int dropped) {
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(G.rows(), G.cols());
  int kept = 0, kept_dropped = 0;
  for (Eigen::Index j = 0; j < G.cols(); ++j) {
    Eigen::VectorXd by = Eigen::VectorXd::Unit(G.cols(), j);
    for (int pass = 0; pass < 2; ++pass) {  // once more for what rounding left
      const Eigen::VectorXd along = T.leftCols(kept).transpose() * (G * by);
      by -= T.leftCols(kept) * along;
    }
    const double length = std::sqrt(by.dot(G * by));
    if (!(length > kIndependent * std::sqrt(G(j, j)))) continue;
    T.col(kept++) = by / length;
    if (j < dropped) kept_dropped = kept;
  }
  return T.middleCols(kept_dropped, kept - kept_dropped);
}

}  // namespace

LensField::LensField(const Camera& camera) : camera_(camera), coefficient_by_px_(coefficient_by_px(camera)) {
  constexpr int kPoints = kPointsAcross * kPointsDown;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * kPoints, kRaw);
  Eigen::Matrix2Xd columns;
  int points = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double x = (i % kPointsAcross + 0.5) / kPointsAcross, y = (i / kPointsAcross + 0.5) / kPointsDown;
    if (followed({x * camera.width_px - 0.5, y * camera.height_px - 0.5}, &columns))
      A.middleRows<2>(2 * points++) = columns;
  }
  combination_ = orthonormal(A.transpose() * A, kOfLensAndTurn);
  // All alike: how smooth a lens is nobody states.
  combination_ *= std::sqrt(2.0 * points / static_cast<double>(combination_.cols()));
}

int LensField::followed_size() { return kRaw; }

bool LensField::followed(const Eigen::Vector2d& pixel, Eigen::Matrix2Xd* columns) const {
  Eigen::Vector3d ray;
  Eigen::Vector2d projected;
  Eigen::Matrix<double, 2, 3> by_point;
  if (!camera_.unproject(pixel, &ray) || !camera_.project(ray, &projected, &by_point)) return false;
  columns->setZero(2, kRaw);
  columns->leftCols<5>() = pixel_by_lens(camera_, LensChange::Zero(), coefficient_by_px_, ray, pixel);
  columns->middleCols<3>(5) = by_point * skew(ray);
  const auto p =
      polynomials(2.0 * (pixel.x() + 0.5) / camera_.width_px - 1.0, 2.0 * (pixel.y() + 0.5) / camera_.height_px - 1.0);
  for (int i = 0; i < kPolynomials; ++i)
    (*columns)(0, kOfLensAndTurn + 2 * i) = (*columns)(1, kOfLensAndTurn + 2 * i + 1) = p[i];
  return true;
}

Eigen::Matrix2Xd LensField::at(const Eigen::Vector2d& pixel) const {
  Eigen::Matrix2Xd columns;
  if (!followed(pixel, &columns)) return Eigen::Matrix2Xd::Zero(2, size());
  return columns * combination_;
}

}  // namespace rigproof::ml
