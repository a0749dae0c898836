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

// The three values of a camera's lens that are tested.
Eigen::Index tested(const Layout& layout, int camera) { return layout.place(Nuisance::kLens, camera); }

// What is free in a test: all globals, each lens with its stated prior (none where it is believed), then the last
// `size` of the tested values, an error beyond that which the listed cameras share.
struct Freedom {
  Eigen::MatrixXd combinations;
  Eigen::VectorXd information, pull;  // of the priors, and their gradient
};
Freedom freedom_of(const Layout& layout, const Priors& stated, const State& state, const std::vector<int>& sharing,
                   Eigen::Index size) {
  std::vector<Eigen::Index> kept;
  std::vector<double> information, pull;
  for (Eigen::Index i = 0; i < layout.globals(); ++i) {
    const Eigen::Index lens = i - tested(layout, 0), parts = row_of(Nuisance::kLens).size();
    const Eigen::Index c = lens / parts, part = lens % parts;
    const bool is_tested = lens >= 0 && c < layout.cameras && part < 3;
    const double sigma = is_tested ? stated.sigma(Nuisance::kLens, static_cast<int>(c), static_cast<int>(part)) : 0.0;
    if (is_tested && !(sigma > 0.0)) continue;
    kept.push_back(i);
    information.push_back(is_tested ? 1.0 / (sigma * sigma) : 0.0);
    pull.push_back(is_tested ? information.back() * state.nuisances.of(Nuisance::kLens, static_cast<int>(c))[part]
                             : 0.0);
  }
  const Eigen::Index others = static_cast<Eigen::Index>(kept.size());
  Freedom freedom{Eigen::MatrixXd::Zero(layout.globals(), others + size), Eigen::VectorXd::Zero(others + size),
                  Eigen::VectorXd::Zero(others + size)};
  for (Eigen::Index k = 0; k < others; ++k) {
    const std::size_t from = static_cast<std::size_t>(k);
    freedom.combinations(kept[from], k) = 1.0;
    freedom.information[k] = information[from];
    freedom.pull[k] = pull[from];
  }
  for (const int c : sharing)
    freedom.combinations.block(tested(layout, c) + 3 - size, others, size, size).setIdentity();
  return freedom;
}

// Normal equations of the first globals, the others following.
Eigen::MatrixXd of_own(const Eigen::MatrixXd& schur, Eigen::Index own) {
  const Eigen::Index others = schur.rows() - own;
  if (others == 0) return schur;
  const Eigen::LLT<Eigen::MatrixXd> of_others(schur.bottomRightCorner(others, others));
  return schur.topLeftCorner(own, own) -
         schur.topRightCorner(own, others) * of_others.solve(schur.bottomLeftCorner(others, own));
}

// One step from the solution.
struct Score {
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;
};

std::optional<Score> step_within(const Eigen::MatrixXd& schur, const Eigen::VectorXd& gradient,
                                 const Freedom& freedom) {
  const Eigen::MatrixXd& C = freedom.combinations;
  Eigen::MatrixXd H = C.transpose() * schur * C;
  H.diagonal() += freedom.information;
  const Eigen::LLT<Eigen::MatrixXd> llt(H);
  if (llt.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXd inverse = llt.solve(Eigen::MatrixXd::Identity(H.rows(), H.cols()));
  return Score{-inverse * (C.transpose() * gradient + freedom.pull), inverse};
}

// Of the last `size` of focal length, cx and cy; the others are as stated.
LensEstimate estimate_of(const std::optional<Score>& score, Eigen::Index size) {
  LensEstimate estimate;
  if (!score) return estimate;
  const Eigen::VectorXd value = score->value.tail(size);
  const Eigen::MatrixXd covariance = score->covariance.bottomRightCorner(size, size);
  estimate.value.tail(size) = value;
  estimate.sigma.setZero();
  estimate.sigma.tail(size) = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd information = covariance.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  estimate.information.bottomRightCorner(size, size) = information;
  estimate.deviations = std::sqrt(std::max(0.0, value.dot(information * value)));
  return estimate;
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
    priors.covariance(Nuisance::kLens, c).topLeftCorner<3, 3>() = sigmas.cwiseAbs2().asDiagonal();
  return priors;
}

std::optional<LensTest> test_lenses(const Problem& problem, const RemovedErrors& repeating, const Priors& stated,
                                    const State& state) {
  const Layout& layout = problem.layout();
  if (!layout.has(Nuisance::kLens)) return std::nullopt;
  const ArrowSystem system = repeating.errors.any() ? problem.linearise_with(repeating, state, Weighting::kRobust)
                                                    : problem.linearise(state, Weighting::kRobust, nullptr, nullptr);
  const std::optional<EliminatedSystem> eliminated = EliminatedSystem::eliminate(system, 0.0);
  Eigen::VectorXd pose_step, global_step;
  if (!eliminated || !eliminated->step(&pose_step, &global_step)) return std::nullopt;
  const Eigen::MatrixXd schur = of_own(eliminated->schur(), layout.globals());
  const Eigen::VectorXd gradient = -schur * global_step.head(layout.globals());
  const auto shared_by = [&](const std::vector<int>& cameras, Eigen::Index size) {
    return estimate_of(step_within(schur, gradient, freedom_of(layout, stated, state, cameras, size)), size);
  };

  LensTest test;
  std::vector<int> all;
  for (int c = 0; c < layout.cameras; ++c) all.push_back(c);
  for (const int c : all) test.alone.push_back(shared_by({c}, 3));
  test.common = shared_by(all, 3);
  test.common_shift = shared_by(all, 2);
  return test;
}

}  // namespace rigproof::ml
