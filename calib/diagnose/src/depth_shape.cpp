#include "depth_shape.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "bending.h"
#include "rigproof/calib/estimate/depth_bias.h"

namespace rigproof::ml {
namespace {

// Chi-squares of six dimensions: of the score at the solution, which chance exceeds three times in a thousand, and of
// the shape itself by all that is uncertain, which it exceeds once in 100,000.
constexpr double kWorthASolution = 20.0, kSure = 33.0;
// Depth is rounded, and no lens is exact to the last digit.
constexpr double kNoFault_px = 0.02;
// Far beyond what any depth camera is off by.
constexpr double kDoubted = 0.1;

Priors with_doubted_shape(Priors priors, const std::vector<int>& cameras) {
  for (const int c : cameras)
    priors.covariance(Nuisance::kDepthShape, c) = kDoubted * kDoubted * Eigen::MatrixXd::Identity(6, 6);
  return priors;
}

// Depth on the board tells its shape from a pose of the camera.
std::vector<int> cameras_with_planes(const Preparation& prepared) {
  std::vector<int> cameras;
  const std::vector<PlaneObservation>& planes = prepared.used.board_planes;
  for (const int c : prepared.solved_cameras())
    if (std::any_of(planes.begin(), planes.end(), [c](const PlaneObservation& plane) { return plane.camera == c; }))
      cameras.push_back(c);
  return cameras;
}

// Chi-square of a value of six dimensions.
double square_of(const Eigen::VectorXd& value, const Eigen::MatrixXd& covariance) {
  return value.dot(covariance.ldlt().solve(value));
}

// One step of a camera's shape from the solution, all else following but the shapes of other cameras.
double score_of(const Layout& layout, const EliminatedSystem& eliminated, int camera) {
  std::vector<Eigen::Index> kept;
  const int first = layout.place(Nuisance::kDepthShape, 0), last = first + 6 * layout.cameras,
            own = layout.place(Nuisance::kDepthShape, camera);
  for (int i = 0; i < layout.globals(); ++i)
    if (i < first || i >= last) kept.push_back(i);
  for (int i = own; i < own + 6; ++i) kept.push_back(i);
  const Eigen::Index n = static_cast<Eigen::Index>(kept.size());
  Eigen::MatrixXd H(n, n);
  Eigen::VectorXd g(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    g[i] = eliminated.schur_gradient()[kept[static_cast<std::size_t>(i)]];
    for (Eigen::Index j = 0; j < n; ++j)
      H(i, j) = eliminated.schur()(kept[static_cast<std::size_t>(i)], kept[static_cast<std::size_t>(j)]);
  }
  const Eigen::LLT<Eigen::MatrixXd> llt(H);
  if (llt.info() != Eigen::Success) return 0.0;
  const Eigen::MatrixXd inverse = llt.solve(Eigen::MatrixXd::Identity(n, n));
  return square_of((inverse * g).tail(6), inverse.bottomRightCorner(6, 6));
}

// The solution with a free shape of the camera's depth: how far that is from none, by all that is uncertain.
std::optional<Finding> look_again(const Preparation& prepared, const Fit& fit, int camera) {
  Preparation free = prepared;
  free.priors = with_doubted_shape(prepared.priors, {camera});
  const Fit with = fit_model(free, fit.noise.law);
  const std::optional<GlobalCovariance> covariance = stated_covariance(free, with);
  if (!covariance) return std::nullopt;
  const int at = Layout::of(free.used, free.priors).place(Nuisance::kDepthShape, camera);
  const RigCamera& seeing = prepared.original.cameras[static_cast<std::size_t>(camera)];
  const double no_fault = kNoFault_px / seeing.depth_optics().fx_px;
  const Eigen::MatrixXd told = covariance->covariance.block(at, at, 6, 6);
  const Eigen::MatrixXd expected = told + prepared.priors.covariance(Nuisance::kDepthShape, camera) +
                                   no_fault * no_fault * Eigen::MatrixXd::Identity(6, 6);
  const double square = square_of(with.state.nuisances.of(Nuisance::kDepthShape, camera), expected);
  if (!(square > kSure)) return std::nullopt;
  return Finding("depth.misplaced", {{"deviations", std::sqrt(square)}}).of(seeing.name);
}

}  // namespace

std::vector<Finding> find_misplaced_depth(const Preparation& prepared, const Fit& fit) {
  const std::vector<int> cameras = cameras_with_planes(prepared);
  if (cameras.empty()) return {};
  const Problem problem = problem_at(prepared, fit, fit.noise, with_doubted_shape(prepared.priors, cameras));
  const ArrowSystem system = problem.linearise(fit.state, Weighting::kInformation, nullptr, nullptr);
  const std::optional<EliminatedSystem> eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return {};
  std::vector<Finding> findings;
  for (const int c : cameras)
    if (score_of(problem.layout(), *eliminated, c) > kWorthASolution)
      if (const std::optional<Finding> finding = look_again(prepared, fit, c)) findings.push_back(*finding);
  return findings;
}

}  // namespace rigproof::ml
