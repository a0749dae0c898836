#include "rigproof/core/lens_residual.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

constexpr int kReach = 4;  // nodes along an axis that a pixel depends on
// Samples of the image along its longer side, over which orthogonality and root mean square are meant.
constexpr int kSamples = 48;
// Coefficients are cut off here, so that no field has a spike.
constexpr double kMostSigmas = 2.5;

struct Taps {
  int first = 0;
  double weight[kReach] = {};
};

// Weights of the four nodes around a place along an axis of `nodes` nodes.
Taps taps_at(double pixel, double cell_px, int nodes) {
  const double place = std::clamp(pixel / cell_px + 1.0, 0.0, static_cast<double>(nodes - 3));
  Taps taps;
  taps.first = std::min(static_cast<int>(place), nodes - kReach);
  const double t = place - taps.first, u = 1.0 - t;
  taps.weight[0] = u * u * u / 6.0;
  taps.weight[1] = (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0;
  taps.weight[2] = (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0;
  taps.weight[3] = t * t * t / 6.0;
  return taps;
}

std::vector<Eigen::Vector2d> sample_pixels(const Camera& camera) {
  const double step = static_cast<double>(std::max(camera.width_px, camera.height_px)) / kSamples;
  std::vector<Eigen::Vector2d> pixels;
  for (double y = 0.5 * step - 0.5; y < camera.height_px - 0.5; y += step)
    for (double x = 0.5 * step - 0.5; x < camera.width_px - 0.5; x += step) pixels.emplace_back(x, y);
  return pixels;
}

// What calibration follows at a pixel, a column each; lengths are in half diagonals from the principal point.
Eigen::Matrix<double, 2, Eigen::Dynamic> followed_at(const Camera& camera, const Eigen::Vector2d& pixel) {
  const int radial = camera.lens == Lens::kKannalaBrandt ? 4 : 3;
  const Eigen::Vector2d p =
      (pixel - Eigen::Vector2d(camera.cx_px, camera.cy_px)) / (0.5 * std::hypot(camera.width_px, camera.height_px));
  const double x = p.x(), y = p.y(), r2 = p.squaredNorm();
  Eigen::Matrix<double, 2, Eigen::Dynamic> motions(2, 7 + radial);
  motions.leftCols<7>() << 1.0, 0.0, x, 0.0, -y, 2.0 * x * y, r2 + 2.0 * x * x,  //
      0.0, 1.0, 0.0, y, x, r2 + 2.0 * y * y, 2.0 * x * y;
  for (int k = 0; k < radial; ++k) motions.col(7 + k) = std::pow(r2, k + 1) * p;
  return motions;
}

// Values of the field at the samples, x and y below one another, from its coefficients: the same for either axis.
Eigen::MatrixXd values_of_nodes(const LensResidual& field, const std::vector<Eigen::Vector2d>& pixels) {
  Eigen::MatrixXd values =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(pixels.size()), static_cast<Eigen::Index>(field.dx_px.size()));
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Taps across = taps_at(pixels[i].x(), field.cell_px, field.columns);
    const Taps down = taps_at(pixels[i].y(), field.cell_px, field.rows());
    for (int j = 0; j < kReach; ++j)
      for (int k = 0; k < kReach; ++k)
        values(static_cast<Eigen::Index>(i), (down.first + j) * field.columns + across.first + k) =
            down.weight[j] * across.weight[k];
  }
  return values;
}

// The nearest coefficients whose field has no part in what calibration follows.
Eigen::MatrixX2d orthogonal_part(const Camera& camera, const std::vector<Eigen::Vector2d>& pixels,
                                 const Eigen::MatrixXd& values, const Eigen::MatrixX2d& drawn) {
  const auto samples = static_cast<Eigen::Index>(pixels.size());
  const Eigen::Index followed = followed_at(camera, pixels.front()).cols(), nodes = values.cols();
  Eigen::MatrixXd x(samples, followed), y(samples, followed);
  for (Eigen::Index i = 0; i < samples; ++i) {
    const auto motions = followed_at(camera, pixels[static_cast<std::size_t>(i)]);
    x.row(i) = motions.row(0);
    y.row(i) = motions.row(1);
  }
  Eigen::MatrixXd constraints(2 * nodes, followed);
  constraints << values.transpose() * x, values.transpose() * y;
  Eigen::VectorXd stacked(2 * nodes);
  stacked << drawn.col(0), drawn.col(1);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(constraints);
  const Eigen::MatrixXd basis = qr.householderQ() * Eigen::MatrixXd::Identity(2 * nodes, followed);
  stacked -= basis * (basis.transpose() * stacked);
  Eigen::MatrixX2d result(nodes, 2);
  result << stacked.head(nodes), stacked.tail(nodes);
  return result;
}

}  // namespace

Eigen::Vector2d LensResidual::at(const Eigen::Vector2d& pixel) const {
  const Taps across = taps_at(pixel.x(), cell_px, columns), down = taps_at(pixel.y(), cell_px, rows());
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int j = 0; j < kReach; ++j) {
    for (int k = 0; k < kReach; ++k) {
      const auto node = static_cast<std::size_t>((down.first + j) * columns + across.first + k);
      sum += down.weight[j] * across.weight[k] * Eigen::Vector2d(dx_px[node], dy_px[node]);
    }
  }
  return sum;
}

LensResidual draw_lens_residual(const Camera& camera, double rms_px, double cells, RandomStream random) {
  if (!(cells >= 4.0) || camera.width_px < 8 || camera.height_px < 8)
    throw Error("lens field: needs an image of 8x8 px or more and 4 cells across it or more");
  LensResidual field;
  field.cell_px = std::max(camera.width_px, camera.height_px) / cells;
  // A cell to spare on every side, and the splines' reach.
  const auto nodes_along = [&field](int size) { return static_cast<int>(std::ceil(size / field.cell_px)) + 5; };
  field.columns = nodes_along(camera.width_px);
  const auto nodes = static_cast<std::size_t>(field.columns * nodes_along(camera.height_px));
  field.dx_px.assign(nodes, 0.0);
  field.dy_px.assign(nodes, 0.0);
  Eigen::MatrixX2d coefficients(static_cast<Eigen::Index>(nodes), 2);
  for (Eigen::Index i = 0; i < coefficients.rows(); ++i)
    for (int axis = 0; axis < 2; ++axis) coefficients(i, axis) = std::clamp(random.normal(), -kMostSigmas, kMostSigmas);
  const std::vector<Eigen::Vector2d> pixels = sample_pixels(camera);
  const Eigen::MatrixXd values = values_of_nodes(field, pixels);
  coefficients = orthogonal_part(camera, pixels, values, coefficients);
  const Eigen::MatrixX2d displacements = values * coefficients;
  coefficients *= rms_px / std::sqrt(0.5 * displacements.squaredNorm() / static_cast<double>(pixels.size()));
  Eigen::VectorXd::Map(field.dx_px.data(), coefficients.rows()) = coefficients.col(0);
  Eigen::VectorXd::Map(field.dy_px.data(), coefficients.rows()) = coefficients.col(1);
  return field;
}

bool project(const Camera& camera, const std::optional<LensResidual>& field, const Eigen::Vector3d& p_camera,
             Eigen::Vector2d* pixel) {
  if (!camera.project(p_camera, pixel)) return false;
  if (field) *pixel += field->at(*pixel);
  return true;
}

bool unproject(const Camera& camera, const std::optional<LensResidual>& field, const Eigen::Vector2d& pixel,
               Eigen::Vector3d* ray) {
  if (!field) return camera.unproject(pixel, ray);
  // Fields change by a thousandth of the way: every round gains three digits.
  Eigen::Vector2d modelled = pixel;
  for (int round = 0; round < 5; ++round) modelled = pixel - field->at(modelled);
  return camera.unproject(modelled, ray);
}

}  // namespace rigproof
