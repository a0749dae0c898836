#include "fine_level.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <map>

namespace rigproof::ml {
namespace {

// Of what is strongest: what is weaker is rounding, where the board never was.
constexpr double kIndependent = 1e-7;

// r = B f + e without what the views' poses follow: A = B' B, u = B' r. The last of f is what is smooth: a change of
// the lens, a turn of the camera, polynomials.
struct NormalEquations {
  explicit NormalEquations(int size) : A(Eigen::MatrixXd::Zero(size, size)), u(Eigen::VectorXd::Zero(size)) {}
  Eigen::MatrixXd A;
  Eigen::VectorXd u;
  double squares = 0.0;  // of r
  double degrees = 0.0;  // of freedom of r
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

void add(const LeftOver& view, const FineField& fine, const LensField& smooth, NormalEquations* sum) {
  const ViewRows& rows = *view.rows;
  const auto [places, B] = columns_of(view, fine, smooth);
  const Eigen::VectorXd roots = view.weights.cwiseSqrt();
  const Eigen::MatrixXd P = roots.asDiagonal() * rows.by_pose;
  Eigen::VectorXd r = roots.asDiagonal() * view.residual;
  const Eigen::LDLT<Eigen::MatrixXd> poses(P.transpose() * P);
  r -= P * poses.solve(P.transpose() * r);
  const Eigen::MatrixXd PtB = P.transpose() * B;
  const Eigen::MatrixXd A = B.transpose() * B - PtB.transpose() * poses.solve(PtB);
  const Eigen::VectorXd u = B.transpose() * r;
  for (std::size_t i = 0; i < places.size(); ++i) {
    sum->u[places[i]] += u[static_cast<Eigen::Index>(i)];
    for (std::size_t j = 0; j < places.size(); ++j)
      sum->A(places[j], places[i]) += A(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i));
  }
  sum->squares += r.squaredNorm();
  for (const Eigen::Matrix2d& whitening : rows.whitening) sum->degrees += whitening.isZero(0.0) ? 0.0 : 2.0;
  sum->degrees -= 6.0;
}

// Without what is smooth.
NormalEquations of_fine_alone(const NormalEquations& all, int fines) {
  const Eigen::Index smooth = all.u.size() - fines;
  NormalEquations fine(fines);
  const Eigen::VectorXd scale = all.A.diagonal().tail(smooth).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd across = all.A.topRightCorner(fines, smooth) * scale.asDiagonal();
  const Eigen::VectorXd u = scale.cwiseProduct(all.u.tail(smooth));
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse;
  inverse.setThreshold(kIndependent);
  inverse.compute(scale.asDiagonal() * all.A.bottomRightCorner(smooth, smooth) * scale.asDiagonal());
  const Eigen::VectorXd by_u = inverse.solve(u);
  fine.squares = all.squares - u.dot(by_u);
  fine.degrees = all.degrees - static_cast<double>(inverse.rank());
  fine.u = all.u.head(fines) - across * by_u;
  fine.A = all.A.topLeftCorner(fines, fines) - across * inverse.solve(across.transpose());
  return fine;
}

// Of independent numbers: c_i has variance v d_i^2 + s d_i, and the rest of the squares has s a degree of freedom.
class Spectrum {
 public:
  explicit Spectrum(const NormalEquations& sums) : degrees_(sums.degrees), rest_(sums.squares) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(sums.A);
    const double least = kIndependent * std::max(eigen.eigenvalues().maxCoeff(), 0.0);
    for (Eigen::Index i = 0; i < sums.u.size(); ++i) {
      const double d = eigen.eigenvalues()[i];
      if (!(d > least)) continue;
      const double c = eigen.eigenvectors().col(i).dot(sums.u);
      strengths_.push_back(d);
      squares_.push_back(c * c / d);
      rest_ -= squares_.back();
    }
    rest_ = std::max(rest_, 0.0);
  }
  bool tells() const { return degrees_ > static_cast<double>(strengths_.size()) && !strengths_.empty(); }

  // Log likelihood of a variance of the nodes, at the noise that fits best with it.
  double log_likelihood(double variance, double* noise) const {
    double sum = 0.0;
    for (int round = 0; round < 8; ++round) {
      sum = rest_;
      for (std::size_t i = 0; i < strengths_.size(); ++i)
        sum += squares_[i] / (1.0 + variance * strengths_[i] / *noise);
      *noise = std::max(sum / degrees_, 1e-12);
    }
    double logs = (degrees_ - static_cast<double>(strengths_.size())) * std::log(*noise);
    for (const double d : strengths_) logs += std::log(*noise + variance * d);
    double fit = rest_ / *noise;
    for (std::size_t i = 0; i < strengths_.size(); ++i) fit += squares_[i] / (*noise + variance * strengths_[i]);
    return -0.5 * (logs + fit);
  }
  double noise_at_first() const { return std::max(rest_, 1e-9) / degrees_; }

 private:
  double degrees_, rest_;
  std::vector<double> strengths_, squares_;
};

// Its tails are those of Student's t of four degrees of freedom: data decide where they speak.
double log_prior(double sigma_px, double scale_px) {
  return std::log(sigma_px) - 2.5 * std::log1p(0.25 * std::pow(sigma_px / scale_px, 2));  // on a logarithmic grid
}

}  // namespace

FineLevel fine_level(const std::vector<LeftOver>& views, const FineField& fine, const LensField& smooth,
                     double prior_px) {
  constexpr int kPoints = 48;
  constexpr double kLeast = 0.02, kMost = 20.0;  // of the prior's scale
  NormalEquations all(fine.size() + smooth.followed_size());
  for (const LeftOver& view : views) add(view, fine, smooth, &all);
  const NormalEquations sums = of_fine_alone(all, fine.size());
  const Spectrum spectrum(sums);
  double noise = spectrum.noise_at_first(), best = -1e300;
  std::vector<double> variances, logs;
  for (int i = 0; i < kPoints; ++i) {
    const double sigma = prior_px * kLeast * std::pow(kMost / kLeast, i / (kPoints - 1.0));
    variances.push_back(sigma * sigma);
    logs.push_back(log_prior(sigma, prior_px) +
                   (spectrum.tells() ? spectrum.log_likelihood(sigma * sigma, &noise) : 0.0));
    best = std::max(best, logs.back());
  }
  double weights = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const double weight = std::exp(logs[i] - best);
    weights += weight;
    mean += weight * variances[i];
  }
  return {std::sqrt(mean / weights), best + std::log(weights)};
}

}  // namespace rigproof::ml
