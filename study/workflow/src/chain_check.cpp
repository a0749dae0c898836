#include "rigproof/study/workflow/chain_check.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/chi_square.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

// One sigma of the chain's pose of a camera in another.
Vector6d sigmas_of_chain(const Rigid3& T) {
  constexpr double kSquares = 0.005, kLens_m = 0.002, kLens_rad = deg_to_rad(0.1);
  Vector6d sigmas;
  sigmas << Eigen::Vector3d::Constant(std::hypot(kLens_m, kSquares * T.translation.norm())),
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
    if (!whole || !pair.covariance) continue;
    if (const auto T_parent_child = chain.between(pair.parent, pair.child))
      findings.push_back(compare(pair, *pair.covariance, *T_parent_child));
  }
  return findings;
}

FrameTree load_chain(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kCamchainFile;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return {};
  FrameTree chain = load_frame_tree(file);
  try {
    for (const auto& edge : chain.edges()) chain.way_up(edge.first);
  } catch (const Error&) {
    throw Error(file.string() +
                ": each camera must have one parent, and no circle; `rigproof init` writes it, and without this file "
                "nothing is compared");
  }
  return chain;
}

}  // namespace rigproof
