#include "fine_level.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

namespace rigproof::ml {
namespace {

// Of what is strongest, or of what it was before something was taken out: what is weaker is rounding.
constexpr double kIndependent = 1e-7;

// r = B f + e without what the views' poses follow: A = B' B, u = B' r. The last of f is what is smooth: a change of
// the lens, a turn of the camera, polynomials.
struct NormalEquations {
  explicit NormalEquations(int size)
      : A(Eigen::MatrixXd::Zero(size, size)), u(Eigen::VectorXd::Zero(size)), with_poses(Eigen::VectorXd::Zero(size)) {}
  Eigen::MatrixXd A;  // the lower triangle
  Eigen::VectorXd u;
  Eigen::VectorXd with_poses;  // squares of the columns of B before what poses follow is taken out
  double squares = 0.0;        // of r
  double degrees = 0.0;        // of freedom of r
};

// Of a view: which of f its columns are.
struct Columns {
  std::vector<int> places;
  Eigen::MatrixXd B;  // weighted
};

Columns columns_of(const LeftOver& view, const FineField& fine, const LensField& smooth) {
  const ViewRows& rows = *view.rows;
  Columns columns;
  std::map<int, int> of_node;
  for (const Eigen::Vector2d& pixel : rows.pixels)
    for (const FineField::Share& share : fine.at(pixel))
      if (of_node.emplace(share.node, static_cast<int>(columns.places.size())).second)
        columns.places.insert(columns.places.end(), {2 * share.node, 2 * share.node + 1});
  const int fines = static_cast<int>(columns.places.size());
  for (int i = 0; i < smooth.followed_size(); ++i) columns.places.push_back(fine.size() + i);
  columns.B = Eigen::MatrixXd::Zero(rows.residual.size(), static_cast<Eigen::Index>(columns.places.size()));
  Eigen::Matrix2Xd followed;
  for (std::size_t i = 0; i < rows.pixels.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    const Eigen::Matrix2d root = std::sqrt(view.weights[row]) * rows.whitening[i];
    for (const FineField::Share& share : fine.at(rows.pixels[i]))
      columns.B.block<2, 2>(row, of_node[share.node]) += share.weight * root;
    if (smooth.followed(rows.pixels[i], &followed)) columns.B.block(row, fines, 2, followed.cols()) = root * followed;
  }
  return columns;
}

// Of freedom of the corners that count.
double degrees_of(const LeftOver& view) {
  double degrees = 0.0;
  for (std::size_t i = 0; i < view.rows->whitening.size(); ++i)
    if (view.weights[static_cast<Eigen::Index>(2 * i)] > 0.0 && !view.rows->whitening[i].isZero(0.0)) degrees += 2.0;
  return degrees;
}

void add(const LeftOver& view, const FineField& fine, const LensField& smooth, NormalEquations* sum) {
  const ViewRows& rows = *view.rows;
  const auto [places, B] = columns_of(view, fine, smooth);
  const Eigen::VectorXd roots = view.weights.cwiseSqrt();
  const Eigen::MatrixXd P = roots.asDiagonal() * rows.by_pose;
  Eigen::VectorXd r = roots.asDiagonal() * view.residual;
  const Eigen::LDLT<Eigen::MatrixXd> poses(P.transpose() * P);
  r -= P * poses.solve(P.transpose() * r);
  const Eigen::MatrixXd left = B - P * poses.solve(P.transpose() * B);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(B.cols(), B.cols());
  A.selfadjointView<Eigen::Lower>().rankUpdate(left.transpose());
  const Eigen::VectorXd u = B.transpose() * r;
  for (std::size_t i = 0; i < places.size(); ++i) {
    sum->u[places[i]] += u[static_cast<Eigen::Index>(i)];
    sum->with_poses[places[i]] += B.col(static_cast<Eigen::Index>(i)).squaredNorm();
    for (std::size_t j = i; j < places.size(); ++j)
      sum->A(std::max(places[i], places[j]), std::min(places[i], places[j])) +=
          A(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i));
  }
  sum->squares += r.squaredNorm();
  sum->degrees += std::max(0.0, degrees_of(view) - 6.0);
}

// Without what is smooth.
NormalEquations of_fine_alone(const NormalEquations& all, int fines) {
  const Eigen::Index smooth = all.u.size() - fines;
  NormalEquations fine(fines);
  Eigen::VectorXd scale = Eigen::VectorXd::Zero(smooth);
  for (Eigen::Index i = 0; i < smooth; ++i)  // of what poses follow rounding is left
    if (const double square = all.A(fines + i, fines + i); square > kIndependent * all.with_poses[fines + i])
      scale[i] = 1.0 / std::sqrt(square);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      scale.asDiagonal() * all.A.bottomRightCorner(smooth, smooth) * scale.asDiagonal());
  const Eigen::Index kept = (eigen.eigenvalues().array() > kIndependent * eigen.eigenvalues()[smooth - 1]).count();
  const Eigen::MatrixXd orthonormal = scale.asDiagonal() * eigen.eigenvectors().rightCols(kept) *
                                      eigen.eigenvalues().tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd across = all.A.bottomLeftCorner(smooth, fines).transpose() * orthonormal;
  const Eigen::VectorXd u = orthonormal.transpose() * all.u.tail(smooth);
  fine.squares = all.squares - u.squaredNorm();
  fine.degrees = all.degrees - static_cast<double>(kept);
  fine.with_poses = all.with_poses.head(fines);
  fine.u = all.u.head(fines) - across * u;
  fine.A = all.A.topLeftCorner(fines, fines);
  if (kept > 0) fine.A.selfadjointView<Eigen::Lower>().rankUpdate(across, -1.0);  // of none Eigen divides by zero
  return fine;
}

// Independent numbers of variance v displace: u has variance v A A + s A, and all of the squares have s a degree of
// freedom besides. A is reduced to three diagonals once, so that each v costs little.
class Likelihood {
 public:
  explicit Likelihood(const NormalEquations& sums) : degrees_(sums.degrees), squares_(sums.squares) {
    std::vector<int> seen;
    for (Eigen::Index i = 0; i < sums.u.size(); ++i)
      if (sums.A(i, i) > kIndependent * sums.with_poses[i]) seen.push_back(static_cast<int>(i));
    if (seen.empty()) return;
    trace_ = sums.A(seen, seen).trace();
    const Eigen::Tridiagonalization<Eigen::MatrixXd> tridiagonal(sums.A(seen, seen));
    diagonal_ = tridiagonal.diagonal();
    beside_ = tridiagonal.subDiagonal();
    u_ = tridiagonal.matrixQ().adjoint() * Eigen::VectorXd(sums.u(seen));
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;
    eigen.computeFromTridiagonal(diagonal_, beside_, Eigen::EigenvaluesOnly);
    strengths_ = eigen.eigenvalues().cwiseMax(0.0);
    rank_ = static_cast<double>((strengths_.array() > kIndependent * strengths_.maxCoeff()).count());
  }
  struct At {
    double noise;  // its variance that fits best
    double log;    // of the likelihood with it
  };
  // Where the variance of the coefficients is t times the noise's. Data that tell nothing have the noise that is
  // stated.
  At at(double t) const {
    if (!tells()) return {1.0, 0.0};
    const double noise = std::max(squares_ - explained(t), 1e-9) / degrees_;
    return {noise, -0.5 * (degrees_ * std::log(noise) + (t * strengths_).array().log1p().sum())};
  }

  // Variance of the coefficients that makes squares as large as they are, beside the noise; of data that tell nothing
  // what is given. Numbers of splines that do not fit are large where corners hardly see them.
  double shown(double noise, double otherwise) const {
    return tells() ? std::max(0.0, squares_ - noise * degrees_) / trace_ : otherwise;
  }

 private:
  bool tells() const { return rank_ > 0.0 && degrees_ > rank_; }

  // By the numbers, of the squares: t u' (I + t A)^-1 u.
  double explained(double t) const {
    double sum = 0.0, pivot = 0.0, forward = 0.0;  // of Gaussian elimination, row by row
    for (Eigen::Index i = 0; i < u_.size(); ++i) {
      const double before = i > 0 ? t * beside_[i - 1] : 0.0, by = i > 0 ? before / pivot : 0.0;
      pivot = std::max(1.0, 1.0 + t * diagonal_[i] - by * before);  // less is rounding
      forward = u_[i] - by * forward;
      sum += forward * forward / pivot;
    }
    return t * sum;
  }

  double degrees_, squares_, rank_ = 0.0, trace_ = 0.0;
  Eigen::VectorXd diagonal_, beside_, u_, strengths_;
};

// Logarithm of the density of the logarithm of a size, a multiple of what is stated: Student's t of four degrees of
// freedom around it, so that data decide where they speak.
double log_prior(double size) {
  constexpr double kSigma = 0.25;      // a factor of 1.3
  constexpr double kAtMedian = 0.375;  // density of Student's t of four degrees of freedom
  return std::log(kAtMedian / kSigma) - 2.5 * std::log1p(0.25 * std::pow(std::log(size) / kSigma, 2));
}

}  // namespace

FineLevel fine_level(const std::vector<LeftOver>& views, const FineField& fine, const LensField& smooth,
                     double prior_px) {
  constexpr double kLeast = 0.02, kMost = 20.0;  // of what is stated
  constexpr double kStep = 0.25;                 // of the logarithm of a variance
  constexpr std::size_t kMostSteps = 400;        // where nothing but the field is left, its variance does not grow on
  NormalEquations all(fine.size() + smooth.followed_size());
  for (const LeftOver& view : views) add(view, fine, smooth, &all);
  const Likelihood likelihood(of_fine_alone(all, fine.size()));
  const Likelihood::At none = likelihood.at(0.0);
  const double least = std::pow(kLeast * prior_px, 2), most = std::pow(kMost * prior_px, 2);
  // The noise is known far better than the field: for each multiple of it one noise is enough.
  std::vector<double> variances, noises, logs;
  for (double t = least / none.noise; logs.size() < kMostSteps; t *= std::exp(kStep)) {
    const Likelihood::At at = likelihood.at(t);
    if (t * at.noise > most) break;
    variances.push_back(t * at.noise);
    noises.push_back(at.noise);
    logs.push_back(log_prior(std::sqrt(variances.back()) / prior_px) + at.log - none.log);
  }
  const auto likeliest = std::max_element(logs.begin(), logs.end());
  const double best = *likeliest, noise = noises[static_cast<std::size_t>(likeliest - logs.begin())];
  double weights = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const double weight = std::exp(logs[i] - best);
    weights += weight;
    mean += weight * variances[i];
  }
  constexpr double kStepOfSize = 0.5 * kStep;
  mean /= weights;
  return {std::sqrt(mean), std::sqrt(likelihood.shown(noise, mean)), noise, best + std::log(kStepOfSize * weights)};
}

}  // namespace rigproof::ml
