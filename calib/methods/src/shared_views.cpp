#include "shared_views.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "rival_result.h"

namespace rigproof {
namespace {

struct Sample {
  Rigid3 T_j_k;
  Matrix6d information;
};

// T_j_k = T_j_board T_k_board^-1 with the noise of both.
Sample make_sample(const SharedView& view) {
  const rivals::Quotient T_j_k(view.j->T_camera_board, view.k->T_camera_board);
  const Matrix6d covariance = T_j_k.by_A * view.j->covariance * T_j_k.by_A.transpose() +
                              T_j_k.by_B * view.k->covariance * T_j_k.by_B.transpose();
  return {T_j_k.T, covariance.ldlt().solve(Matrix6d::Identity())};
}

}  // namespace

std::vector<SharedView> shared_views(const std::vector<ViewPose>& views, int camera_j, int camera_k) {
  std::vector<SharedView> shared;
  for (std::size_t first = 0; first < views.size();) {
    std::size_t end = first;
    const ViewPose *j = nullptr, *k = nullptr;
    for (; end < views.size() && views[end].stop == views[first].stop; ++end) {
      if (views[end].camera == camera_j) j = &views[end];
      if (views[end].camera == camera_k) k = &views[end];
    }
    if (j != nullptr && k != nullptr) shared.push_back({j, k});
    first = end;
  }
  return shared;
}

std::optional<SharedViewTransform> transform_from_shared_views(const std::vector<ViewPose>& views, int camera_j,
                                                               int camera_k) {
  std::vector<Sample> samples;
  for (const SharedView& view : shared_views(views, camera_j, camera_k)) samples.push_back(make_sample(view));
  if (samples.empty()) return std::nullopt;
  SharedViewTransform result{samples.front().T_j_k, Matrix6d::Zero(), static_cast<int>(samples.size())};
  // Cauchy at 3 sigma of a six-dimensional error, soft at first: a flipped pose counts nothing in the end.
  double softness = 1e4, chi_square = 0.0;
  Matrix6d H;
  for (int round = 0; round < 20; ++round) {
    H.setZero();
    Vector6d g = Vector6d::Zero();
    chi_square = 0.0;
    for (const Sample& sample : samples) {
      const Vector6d error = transform_error(sample.T_j_k, result.T_j_k);
      const double squared = error.dot(sample.information * error) / 6.0;
      const double weight = 1.0 / (1.0 + squared / (9.0 * softness * softness));
      H += weight * sample.information;
      g += weight * sample.information * error;
      chi_square += weight * squared;
    }
    result.T_j_k = apply_transform_error(result.T_j_k, H.ldlt().solve(g));
    softness = std::max(1.0, 0.3 * softness);
  }
  const double scale = samples.size() > 1 ? chi_square / static_cast<double>(samples.size() - 1) : 1.0;
  result.covariance = std::max(1.0, scale) * H.ldlt().solve(Matrix6d::Identity());
  return result;
}

}  // namespace rigproof
