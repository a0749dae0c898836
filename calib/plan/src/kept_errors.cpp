#include "kept_errors.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

namespace rigproof::moved {
namespace {

// Files round: correlations of one are none that two drives could tell from it.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& covariance) {
  constexpr double kLeast = 1e-9;
  if (covariance.rows() == 0) return covariance;  // all is believed today
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * covariance * scale.asDiagonal());
  const Eigen::MatrixXd V = scale.asDiagonal() * eigen.eigenvectors();
  return V * eigen.eigenvalues().cwiseMax(kLeast).cwiseInverse().asDiagonal() * V.transpose();
}

}  // namespace

LastingErrors only_of(const std::function<bool(const LastingErrors::Owner&)>& keeps, LastingErrors lasting) {
  std::vector<Eigen::Index> kept;
  std::vector<LastingErrors::Unknown> unknowns;
  for (std::size_t i = 0; i < lasting.unknowns.size(); ++i) {
    if (!keeps(lasting.unknowns[i].of)) continue;
    kept.push_back(static_cast<Eigen::Index>(i));
    unknowns.push_back(lasting.unknowns[i]);
  }
  lasting.unknowns = std::move(unknowns);
  lasting.covariance = Eigen::MatrixXd(lasting.covariance(kept, kept));
  lasting.with_cameras = Eigen::MatrixXd(lasting.with_cameras(Eigen::all, kept));
  return lasting;
}

std::vector<KeptErrors::Kept> KeptErrors::common_to(const LastingErrors& lasting, const ml::Problem& problem) {
  std::vector<Kept> common;
  for (const ml::LastingUnknown& unknown : ml::lasting_unknowns(problem.observations(), problem.priors())) {
    const auto found = std::find_if(
        lasting.unknowns.begin(), lasting.unknowns.end(),
        [&](const LastingErrors::Unknown& known) { return known.of == unknown.of && known.name == unknown.name; });
    if (found != lasting.unknowns.end()) common.push_back({unknown, found - lasting.unknowns.begin()});
  }
  return common;
}

KeptErrors::KeptErrors(const LastingErrors& lasting, const ml::Problem& problem) : problem_(problem) {
  const std::vector<Kept> kept = common_to(lasting, problem);
  const auto size = static_cast<Eigen::Index>(kept.size());
  std::vector<Eigen::Index> rows;
  Eigen::VectorXd si_per_unit(size), drift(size);
  value_.resize(size);
  stated_information_.resize(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto& [unknown, row] = kept[static_cast<std::size_t>(i)];
    places_.push_back(unknown.place);
    rows.push_back(row);
    si_per_unit[i] = 1.0 / unknown.units_per_si;
    value_[i] = si_per_unit[i] * lasting.unknowns[static_cast<std::size_t>(row)].value;
    stated_information_[i] = 1.0 / (unknown.stated_sigma * unknown.stated_sigma);
    drift[i] = unknown.drift;
  }
  Eigen::MatrixXd covariance = si_per_unit.asDiagonal() * lasting.covariance(rows, rows) * si_per_unit.asDiagonal();
  covariance.diagonal() += drift.cwiseAbs2();
  information_ = inverse(covariance);
  with_cameras_ = lasting.with_cameras(Eigen::all, rows) * si_per_unit.asDiagonal();
  by_each_ = with_cameras_ * information_;
}

Eigen::VectorXd KeptErrors::now(const ml::State& state) const {
  return ml::lasting_among_globals(state, problem_.layout())(places_);
}

void KeptErrors::add_to(const ml::State& state, ml::ArrowSystem* system) const {
  const Eigen::VectorXd values = now(state);
  const Eigen::VectorXd gradient = information_ * (values - value_) - stated_information_.cwiseProduct(values);
  Eigen::MatrixXd information = information_;
  information.diagonal() -= stated_information_;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    system->global_gradient[places_[i]] += gradient[row];
    for (std::size_t j = 0; j < places_.size(); ++j)
      system->global(places_[i], places_[j]) += information(row, static_cast<Eigen::Index>(j));
  }
}

Eigen::MatrixXd KeptErrors::cameras_by_globals() const {
  Eigen::MatrixXd by_globals = Eigen::MatrixXd::Zero(by_each_.rows(), problem_.layout().globals());
  by_globals(Eigen::all, places_) = by_each_;
  return by_globals;
}

Eigen::VectorXd KeptErrors::shift_of_cameras(const ml::State& state) const { return by_each_ * (now(state) - value_); }

// Files round, and so it may be a little less than nothing.
Eigen::MatrixXd KeptErrors::covariance_left(const Eigen::MatrixXd& of_cameras) const {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> rest(of_cameras - by_each_ * with_cameras_.transpose());
  return rest.eigenvectors() * rest.eigenvalues().cwiseMax(0.0).asDiagonal() * rest.eigenvectors().transpose();
}

}  // namespace rigproof::moved
