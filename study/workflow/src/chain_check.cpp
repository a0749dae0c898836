#include "rigproof/study/workflow/chain_check.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/chi_square.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

// One sigma of the chain's pose of a camera in another.
Vector6d sigmas_of_chain(const Rigid3& T) {
  constexpr double kSquares = 0.005, kLeast_m = 0.002, kLens_rad = deg_to_rad(0.1);
  Vector6d sigmas;
  sigmas << Eigen::Vector3d::Constant(std::hypot(kLeast_m, kSquares * T.translation.norm())),
      Eigen::Vector3d::Constant(kLens_rad);
  return sigmas;
}

Finding compare(const EstimatedTransform& pair, const Matrix6d& covariance, const Rigid3& T_of_chain) {
  constexpr double kByChance = 1e-4;
  const Vector6d off = transform_error(pair.T_parent_child, T_of_chain);
  const Matrix6d both = covariance + Matrix6d(sigmas_of_chain(T_of_chain).cwiseAbs2().asDiagonal());
  const double chi_square = off.dot(both.ldlt().solve(off));
  const bool agree = chi_square_tail(chi_square, 6.0) >= kByChance;
  return Finding(agree ? "cameras.as_in_chain" : "cameras.other_than_in_chain",
                 {{"off_mm", 1e3 * off.head<3>().norm()},
                  {"off_deg", rad_to_deg(off.tail<3>().norm())},
                  {"sigma_mm", 1e3 * std::sqrt(both.diagonal().head<3>().maxCoeff())},
                  {"sigma_deg", rad_to_deg(std::sqrt(both.diagonal().tail<3>().maxCoeff()))}})
      .of({pair.parent, pair.child});
}

}  // namespace

std::vector<Finding> compare_with_chain(const Result& result, const FrameTree& chain) {
  std::vector<Finding> findings;
  for (const EstimatedTransform& pair : result.camera_to_camera) {
    const bool whole = std::all_of(pair.observable.begin(), pair.observable.end(), [](bool seen) { return seen; });
    if (!whole || !pair.covariance || !chain.has(pair.parent) || !chain.has(pair.child)) continue;
    if (const auto T_parent_child = chain.between(pair.parent, pair.child))
      findings.push_back(compare(pair, *pair.covariance, *T_parent_child));
  }
  return findings;
}

std::vector<Finding> compare_with_chain(const Result& result, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kCamchainFile;
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored) ? compare_with_chain(result, load_frame_tree(file))
                                                         : std::vector<Finding>();
}

}  // namespace rigproof
