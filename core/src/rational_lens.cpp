#include "rigproof/core/rational_lens.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "rigproof/core/camera_info.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/text.h"

namespace rigproof {

// x (1 + k1 r2 + k2 r4 + k3 r6) / (1 + k4 r2 + k5 r4 + k6 r6) + tangential.
Eigen::Vector2d rational_distorted(const std::vector<double>& d, const Eigen::Vector2d& p) {
  const double r2 = p.squaredNorm(), xy = p.x() * p.y();
  const double ratio = (1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]))) / (1.0 + r2 * (d[5] + r2 * (d[6] + r2 * d[7])));
  return {p.x() * ratio + 2.0 * d[2] * xy + d[3] * (r2 + 2.0 * p.x() * p.x()),
          p.y() * ratio + d[2] * (r2 + 2.0 * p.y() * p.y()) + 2.0 * d[3] * xy};
}

namespace {

constexpr double kAllowed_px = 0.25;

Eigen::Vector2d pixel_of(const Camera& camera, const Eigen::Vector2d& p) {
  return {camera.fx_px * p.x() + camera.cx_px, camera.fy_px * p.y() + camera.cy_px};
}

struct Sample {
  Eigen::Vector2d ray, seen;  // before and after the lens, normalised
};

constexpr int kSpokes = 48;

struct Samples {
  std::vector<Sample> rays;
  int folded_spokes = 0;  // those that do not reach the border of the image
};

// Rays outwards along spokes until they leave the image, or the lens folds back.
Samples samples_of(const std::vector<double>& d, const Camera& camera) {
  constexpr double kStep = 0.01, kFarthest = 6.0;
  Samples samples;
  for (int spoke = 0; spoke < kSpokes; ++spoke) {
    const double angle = 2.0 * kPi * spoke / kSpokes;
    double before = 0.0;
    for (double r = kStep; r < kFarthest; r += kStep) {
      const Eigen::Vector2d ray(r * std::cos(angle), r * std::sin(angle));
      const Eigen::Vector2d seen = rational_distorted(d, ray);
      const bool folds = !(seen.norm() > before);
      samples.folded_spokes += folds ? 1 : 0;
      if (folds || !camera.contains(pixel_of(camera, seen))) break;
      before = seen.norm();
      samples.rays.push_back({ray, seen});
    }
  }
  return samples;
}

// Both lenses are linear in their coefficients.
Eigen::Matrix<double, 2, 5> derivative(Lens lens, const Eigen::Vector2d& p, Eigen::Vector2d* constant) {
  Eigen::Matrix<double, 2, 5> J = Eigen::Matrix<double, 2, 5>::Zero();
  const double r2 = p.squaredNorm(), r = std::sqrt(r2);
  if (lens == Lens::kBrownConrady) {
    *constant = p;
    J << p.x() * r2, p.x() * r2 * r2, 2.0 * p.x() * p.y(), r2 + 2.0 * p.x() * p.x(), p.x() * r2 * r2 * r2, p.y() * r2,
        p.y() * r2 * r2, r2 + 2.0 * p.y() * p.y(), 2.0 * p.x() * p.y(), p.y() * r2 * r2 * r2;
    return J;
  }
  const double theta = std::atan(r);
  *constant = p * (theta / r);
  double power = theta;
  for (int i = 0; i < 4; ++i) J.col(i) = p * ((power *= theta * theta) / r);
  return J;
}

struct LensFit {
  Lens lens = Lens::kPinhole;
  std::array<double, 5> coefficients{};
  double worst_px = 0.0;
};

LensFit fit(Lens lens, const std::vector<Sample>& samples, const Camera& camera) {
  const int count = coefficient_count(lens);
  const auto rows = static_cast<Eigen::Index>(2 * samples.size());
  Eigen::MatrixXd A(rows, count);
  Eigen::VectorXd b(rows);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Eigen::Vector2d constant;
    const auto row = static_cast<Eigen::Index>(2 * i);
    A.middleRows(row, 2) = derivative(lens, samples[i].ray, &constant).leftCols(count);
    b.segment(row, 2) = samples[i].seen - constant;
  }
  const Eigen::VectorXd solution = A.colPivHouseholderQr().solve(b);
  LensFit result;
  result.lens = lens;
  std::copy_n(solution.data(), count, result.coefficients.begin());
  const double focal_px = std::max(camera.fx_px, camera.fy_px);
  for (Eigen::Index row = 0; row < rows; row += 2)
    result.worst_px =
        std::max(result.worst_px, focal_px * (A.middleRows(row, 2) * solution - b.segment(row, 2)).norm());
  return result;
}

}  // namespace

RationalFit fit_rational_lens(const std::vector<double>& d, Camera* camera) {
  const bool prism = std::any_of(d.begin() + std::min<std::ptrdiff_t>(8, static_cast<std::ptrdiff_t>(d.size())),
                                 d.end(), [](double value) { return value != 0.0; });
  if (d.size() < 8 || prism)
    throw CameraInfoError(
        "d", "D has " + std::to_string(d.size()) +
                 " coefficients; 5 of plumb_bob and 8 of rational_polynomial are supported, others must be 0");
  const Samples along = samples_of(d, *camera);
  const std::vector<Sample>& samples = along.rays;
  if (samples.size() < 100 || along.folded_spokes > kSpokes / 2)
    throw CameraInfoError("d", "D folds the image back into itself, as no lens does");
  const LensFit brown = fit(Lens::kBrownConrady, samples, *camera),
                kannala = fit(Lens::kKannalaBrandt, samples, *camera);
  const LensFit& best = kannala.worst_px < brown.worst_px ? kannala : brown;
  if (!(best.worst_px <= kAllowed_px))
    return {false, "the eight coefficients of rational_polynomial differ from every lens of ours by " +
                       short_text(best.worst_px, 2) +
                       " px and more: the images are rectified as they are read, with the matrix K and no distortion"};
  camera->lens = best.lens;
  camera->distortion = best.coefficients;
  return {true, std::string("rational_polynomial is written as ") + lens_name(best.lens) + ", within " +
                    short_text(best.worst_px, 2) + " px all over the image"};
}

}  // namespace rigproof
