#include "lens_check.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rigproof::ml {
namespace {

constexpr double kWorthALook = 2.5;
constexpr double kMinOfAxis = 2.5;
const Eigen::Vector3d kTolerance(0.01, 0.25, 0.25);

bool beyond(const LensEstimate& estimate, double deviations) {
  if (estimate.deviations < deviations) return false;
  for (int i = 0; i < 3; ++i)
    if (std::abs(estimate.value[i]) > kTolerance[i] && std::abs(estimate.value[i]) > kMinOfAxis * estimate.sigma[i])
      return true;
  return false;
}

// Unknowns x = C y: which combinations of the globals are free.
struct Score {
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;
};

std::optional<Score> step_within(const Eigen::MatrixXd& schur, const Eigen::VectorXd& gradient,
                                 const Eigen::MatrixXd& C) {
  const Eigen::MatrixXd H = C.transpose() * schur * C;
  const Eigen::LLT<Eigen::MatrixXd> llt(H);
  if (llt.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXd inverse = llt.solve(Eigen::MatrixXd::Identity(H.rows(), H.cols()));
  return Score{-inverse * (C.transpose() * gradient), inverse};
}

// The last `size` of focal length, cx and cy stand at the offset; the others are believed.
LensEstimate estimate_at(const std::optional<Score>& score, Eigen::Index offset, Eigen::Index size = 3) {
  LensEstimate estimate;
  if (!score) return estimate;
  const Eigen::VectorXd value = score->value.segment(offset, size);
  const Eigen::MatrixXd covariance = score->covariance.block(offset, offset, size, size);
  estimate.value.tail(size) = value;
  estimate.sigma.setZero();
  estimate.sigma.tail(size) = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd information = covariance.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  estimate.information.bottomRightCorner(size, size) = information;
  estimate.deviations = std::sqrt(std::max(0.0, value.dot(information * value)));
  return estimate;
}

// All globals but the intrinsics of the cameras, then the last `size` of the intrinsics, shared by the listed cameras.
Eigen::MatrixXd combinations(const Layout& layout, const std::vector<int>& sharing, Eigen::Index size = 3) {
  const Eigen::Index others = layout.globals() - 3 * layout.cameras;
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(layout.globals(), others + size);
  const int first = layout.place(Nuisance::kLens), end = first + 3 * layout.cameras;
  Eigen::Index column = 0;
  for (int i = 0; i < layout.globals(); ++i)
    if (i < first || i >= end) C(i, column++) = 1.0;
  for (const int c : sharing) C.block(layout.place(Nuisance::kLens, c) + 3 - size, others, size, size).setIdentity();
  return C;
}

}  // namespace

bool LensEstimate::contradicts() const { return beyond(*this, kLensMinDeviations); }

bool LensEstimate::may_contradict() const { return beyond(*this, kWorthALook); }

void LensEstimate::move_by(const Eigen::Vector3d& moved) {
  value += moved;
  deviations = std::sqrt(value.dot(information * value));
}

bool LensTest::suspicious() const {
  return common.contradicts() || common_shift.contradicts() ||
         std::any_of(alone.begin(), alone.end(), [](const LensEstimate& e) { return e.contradicts(); });
}

Priors with_doubted_lenses(Priors priors) {
  const Eigen::Vector3d sigmas(kDoubtedFocal, kDoubtedPrincipalPoint_px, kDoubtedPrincipalPoint_px);
  for (int c = 0; c < priors.count(Nuisance::kLens); ++c)
    priors.covariance(Nuisance::kLens, c) = sigmas.cwiseAbs2().asDiagonal();
  return priors;
}

std::optional<LensTest> test_lenses(const Problem& problem, const State& state) {
  const Layout& layout = problem.layout();
  if (!layout.has(Nuisance::kLens)) return std::nullopt;
  const ArrowSystem system = problem.linearise(state, Weighting::kRobust, nullptr, nullptr);
  const std::optional<EliminatedSystem> eliminated = EliminatedSystem::eliminate(system, 0.0);
  Eigen::VectorXd pose_step, global_step;
  if (!eliminated || !eliminated->step(&pose_step, &global_step)) return std::nullopt;
  const Eigen::MatrixXd& schur = eliminated->schur();
  const Eigen::VectorXd gradient = -schur * global_step;
  const Eigen::Index others = layout.globals() - 3 * layout.cameras;

  LensTest test;
  std::vector<int> all;
  for (int c = 0; c < layout.cameras; ++c) all.push_back(c);
  for (const int c : all)
    test.alone.push_back(estimate_at(step_within(schur, gradient, combinations(layout, {c})), others));
  test.common = estimate_at(step_within(schur, gradient, combinations(layout, all)), others);
  test.common_shift = estimate_at(step_within(schur, gradient, combinations(layout, all, 2)), others, 2);
  const std::optional<Score> free =
      step_within(schur, gradient, Eigen::MatrixXd::Identity(layout.globals(), layout.globals()));
  for (const int c : all) test.together.push_back(estimate_at(free, layout.place(Nuisance::kLens, c)));
  return test;
}

}  // namespace rigproof::ml
