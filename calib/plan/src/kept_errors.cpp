#include "kept_errors.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

#include "rigproof/calib/estimate/lasting.h"

namespace rigproof::moved {
namespace {

// Of what is stated, by how much an error differs from one day to the next: a lens's holder and a board of aluminium
// grow by .012 % where it is 5 K warmer, .5 % is what is usually stated.
constexpr double kDrift = 0.02;

// Files round: correlations of one are none that two drives could tell from it.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& covariance) {
  constexpr double kLeast = 1e-9;
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * covariance * scale.asDiagonal());
  const Eigen::MatrixXd V = scale.asDiagonal() * eigen.eigenvectors();
  return V * eigen.eigenvalues().cwiseMax(kLeast).cwiseInverse().asDiagonal() * V.transpose();
}

}  // namespace

bool is_of(const LastingErrors& lasting, const LastingErrors::Owner& owner) {
  return std::any_of(lasting.stated.begin(), lasting.stated.end(),
                     [&](const LastingErrors::Stated& stated) { return stated.of == owner; });
}

LastingErrors only_of(const std::function<bool(const LastingErrors::Stated&)>& keeps, LastingErrors lasting) {
  const auto drop = [&](const LastingErrors::Stated& stated) { return !keeps(stated); };
  lasting.stated.erase(std::remove_if(lasting.stated.begin(), lasting.stated.end(), drop), lasting.stated.end());
  std::vector<Eigen::Index> kept;
  std::vector<LastingErrors::Unknown> unknowns;
  for (std::size_t i = 0; i < lasting.unknowns.size(); ++i) {
    if (!is_of(lasting, lasting.unknowns[i].of)) continue;
    kept.push_back(static_cast<Eigen::Index>(i));
    unknowns.push_back(lasting.unknowns[i]);
  }
  lasting.unknowns = std::move(unknowns);
  lasting.covariance = Eigen::MatrixXd(lasting.covariance(kept, kept));
  lasting.with_cameras = Eigen::MatrixXd(lasting.with_cameras(Eigen::all, kept));
  return lasting;
}

KeptErrors::KeptErrors(const LastingErrors& lasting, const ml::Problem& problem) : problem_(problem) {
  std::vector<Eigen::Index> rows;
  std::vector<ml::LastingUnknown> kept;
  for (const ml::LastingUnknown& unknown : ml::lasting_unknowns(problem.observations(), problem.priors())) {
    const auto found = std::find_if(
        lasting.unknowns.begin(), lasting.unknowns.end(),
        [&](const LastingErrors::Unknown& known) { return known.of == unknown.of && known.name == unknown.name; });
    if (found == lasting.unknowns.end()) continue;
    rows.push_back(found - lasting.unknowns.begin());
    kept.push_back(unknown);
    at_.push_back(unknown.place);
  }
  const auto size = static_cast<Eigen::Index>(rows.size());
  Eigen::VectorXd si_per_unit(size), drift(size);
  value_.resize(size);
  stated_.resize(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const ml::LastingUnknown& unknown = kept[static_cast<std::size_t>(i)];
    si_per_unit[i] = 1.0 / unknown.units_per_si;
    value_[i] = si_per_unit[i] * lasting.unknowns[static_cast<std::size_t>(rows[static_cast<std::size_t>(i)])].value;
    stated_[i] = 1.0 / (unknown.stated_sigma * unknown.stated_sigma);
    drift[i] = kDrift * kDrift / stated_[i];
  }
  Eigen::MatrixXd covariance = si_per_unit.asDiagonal() * lasting.covariance(rows, rows) * si_per_unit.asDiagonal();
  covariance.diagonal() += drift;
  information_ = inverse(covariance);
  with_cameras_ = lasting.with_cameras(Eigen::all, rows) * si_per_unit.asDiagonal();
  by_each_ = with_cameras_ * information_;
}

Eigen::VectorXd KeptErrors::now(const ml::State& state) const {
  return ml::lasting_among_globals(state, problem_.layout())(at_);
}

void KeptErrors::add_to(const ml::State& state, ml::ArrowSystem* system) const {
  const Eigen::VectorXd values = now(state);
  const Eigen::VectorXd gradient = information_ * (values - value_) - stated_.cwiseProduct(values);
  Eigen::MatrixXd information = information_;
  information.diagonal() -= stated_;
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    system->global_gradient[at_[i]] += gradient[row];
    for (std::size_t j = 0; j < at_.size(); ++j)
      system->global(at_[i], at_[j]) += information(row, static_cast<Eigen::Index>(j));
  }
}

Eigen::MatrixXd KeptErrors::cameras_by_globals() const {
  Eigen::MatrixXd by_globals = Eigen::MatrixXd::Zero(by_each_.rows(), problem_.layout().globals());
  by_globals(Eigen::all, at_) = by_each_;
  return by_globals;
}

Eigen::VectorXd KeptErrors::shift_of_cameras(const ml::State& state) const { return by_each_ * (now(state) - value_); }

// What the other odometry model adds to the cameras, for one, is not in the lasting errors.
Eigen::MatrixXd KeptErrors::covariance_left(const Eigen::MatrixXd& of_cameras) const {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> rest(of_cameras - by_each_ * with_cameras_.transpose());
  return rest.eigenvectors() * rest.eigenvalues().cwiseMax(0.0).asDiagonal() * rest.eigenvectors().transpose();
}

}  // namespace rigproof::moved
