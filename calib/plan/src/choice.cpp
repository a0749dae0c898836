#include "choice.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace rigproof::suggest {
namespace {

constexpr double kImpossible = std::numeric_limits<double>::infinity();
constexpr auto kSteerable = Forecast::Errors::kBesideTurningPoint;  // what stops can change

// Smooth enough that every candidate that helps a little is told from one that does not.
double worst_axis(const Eigen::VectorXd& relative_sigmas) {
  constexpr double kPower = 8.0;
  const double largest = relative_sigmas.maxCoeff();
  return largest * std::pow((relative_sigmas / largest).array().pow(kPower).mean(), 1.0 / kPower);
}

double limit_of(const AcceptLimits& limits, std::size_t axis) {
  return axis < 2 ? limits.xy_m : axis == 2 ? limits.z_m : limits.angle_rad;
}

// All axes one after the other; 0 where nothing is determined.
Eigen::VectorXd in_a_row(const std::vector<AxisSigmas>& cameras) {
  Eigen::VectorXd row(6 * static_cast<Eigen::Index>(cameras.size()));
  for (std::size_t i = 0; i < 6 * cameras.size(); ++i)
    row[static_cast<Eigen::Index>(i)] = cameras[i / 6][i % 6].value_or(0.0);
  return row;
}

// One over the limits, times what is stated over what the forecast holds of it.
Eigen::VectorXd weights(const Eigen::VectorXd& stated, const Eigen::VectorXd& foreseen, const AcceptLimits& limits) {
  Eigen::VectorXd weight(foreseen.size());
  for (Eigen::Index i = 0; i < weight.size(); ++i) {
    const bool both = stated[i] > 0.0 && foreseen[i] > 0.0;
    weight[i] = (both ? stated[i] / foreseen[i] : 1.0) / limit_of(limits, static_cast<std::size_t>(i) % 6);
  }
  return weight;
}

}  // namespace

bool Choice::may_take(std::size_t candidate) const {
  return given_up.count(candidate) == 0 && std::find(places.begin(), places.end(), candidate) == places.end();
}

Choice Choice::without(std::size_t candidate) const {
  Choice rest = *this;
  rest.given_up.insert(candidate);
  rest.places.erase(std::find(rest.places.begin(), rest.places.end(), candidate));
  return rest;
}

double cost_between(const Outlook& outlook, const Place& from, const Place& to) {
  constexpr double kBlocked = 1e3;
  const DriveCommand command = command_between(from, to, 0.0, outlook.turns_about_m());
  return std::abs(command.distance_m) + std::abs(command.turn_before_rad) + std::abs(command.turn_after_rad) +
         (outlook.floor.may_drive(from, to) ? 0.0 : kBlocked);
}

Chooser::Chooser(const Outlook& outlook, const AcceptLimits& limits, const std::vector<AxisSigmas>& stated,
                 const std::vector<Place>& places, const std::vector<Place>& first)
    : outlook_(outlook),
      places_(places),
      wanted_(std::min(static_cast<std::size_t>(outlook.options.stops) - first.size(), places.size())) {
  const auto inform = [&](const std::vector<Place>& from, std::vector<StopInformation>* information) {
    for (const Place& place : from) information->push_back(outlook.forecast.information_of(outlook.foresight, place));
  };
  inform(first, &first_);
  inform(places, &information_);
  const Place start = first.empty() ? outlook.last_place() : first.back();
  for (const Place& place : places) cost_.push_back(cost_between(outlook, start, place));
  weight_ = weights(in_a_row(stated), in_a_row(outlook.forecast.sigmas({}, kSteerable)), limits);
  matters_ = axes_that_matter();
}

std::vector<const StopInformation*> Chooser::stops_of(const std::vector<std::size_t>& chosen) const {
  std::vector<const StopInformation*> stops;
  for (const StopInformation& stop : first_) stops.push_back(&stop);
  for (const std::size_t i : chosen) stops.push_back(&information_[i]);
  return stops;
}

// Those beyond a limit that the user gave, or near the worst one, as far as all places together would make them
// smaller: what limits the others was stated beforehand, and no drive changes it.
std::vector<bool> Chooser::axes_that_matter() const {
  constexpr double kHelped = 0.9, kNearWorst = 0.25;
  std::vector<std::size_t> everywhere(places_.size());
  std::iota(everywhere.begin(), everywhere.end(), std::size_t{0});
  const Eigen::VectorXd now = in_a_row(outlook_.forecast.sigmas({}, kSteerable)).cwiseProduct(weight_);
  if (!outlook_.knowledge.determined || places_.empty())
    return std::vector<bool>(static_cast<std::size_t>(now.size()), true);
  const Eigen::VectorXd best =
      in_a_row(outlook_.forecast.sigmas(stops_of(everywhere), kSteerable)).cwiseProduct(weight_);
  const double worst = now.maxCoeff();
  const double least = outlook_.used().accept && worst > 1.0 ? 1.0 : kNearWorst * worst;
  std::vector<bool> matters;
  for (Eigen::Index i = 0; i < now.size(); ++i) matters.push_back(now[i] >= least && best[i] <= kHelped * now[i]);
  return matters;
}

// In standard deviations relative to the limits, by the criterion.
double Chooser::score(const std::vector<std::size_t>& chosen) const {
  const std::optional<Eigen::MatrixXd> joint = outlook_.forecast.regular_covariance(stops_of(chosen));
  if (!joint) return kImpossible;
  const Eigen::MatrixXd relative = weight_.asDiagonal() * *joint * weight_.asDiagonal();
  switch (outlook_.options.criterion) {
    case SuggestCriterion::kDeterminant:
      return std::exp(relative.llt().matrixLLT().diagonal().array().log().mean());
    case SuggestCriterion::kEigenvalue:
      return std::sqrt(
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(relative, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff());
    case SuggestCriterion::kWorstAxis:
      break;
  }
  std::vector<Eigen::Index> axes;
  for (std::size_t i = 0; i < matters_.size(); ++i)
    if (matters_[i]) axes.push_back(static_cast<Eigen::Index>(i));
  return worst_axis(relative.diagonal()(axes).cwiseMax(0.0).cwiseSqrt());
}

// The nearest candidate of those that are about as good as the best one, at the given position of the choice; false if
// it is what is there.
bool Chooser::improve(std::size_t position, Choice* choice) const {
  constexpr double kOfGain = 0.1, kOfScore = 0.02;  // about as good
  std::vector<std::size_t> trial = choice->places;
  const std::size_t present = trial[position];
  trial.erase(trial.begin() + static_cast<std::ptrdiff_t>(position));
  const double without = score(trial);
  trial.insert(trial.begin() + static_cast<std::ptrdiff_t>(position), present);
  std::vector<double> scores(places_.size(), kImpossible);
  double best = kImpossible;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (i != present && !choice->may_take(i)) continue;
    trial[position] = i;
    scores[i] = score(trial);
    best = std::min(best, scores[i]);
  }
  if (!std::isfinite(best)) return false;
  const double good = best + std::max(0.0, std::min(kOfGain * (without - best), kOfScore * best));
  std::size_t taken = present;
  for (std::size_t i = 0; i < places_.size(); ++i)
    if (scores[i] <= good && (taken >= places_.size() || scores[taken] > good || cost_[i] < cost_[taken])) taken = i;
  choice->places[position] = taken;
  choice->score = scores[taken];
  return taken != present;
}

Choice Chooser::completed(Choice choice) const {
  constexpr int kExchanges = 2;
  const bool measured = outlook_.knowledge.determined;  // else what one stop tells may show with the next one only
  choice.nothing_helps = wanted_ > 0 && outlook_.options.criterion == SuggestCriterion::kWorstAxis &&
                         std::find(matters_.begin(), matters_.end(), true) == matters_.end();
  while (choice.places.size() < wanted_ && !choice.nothing_helps) {
    const Choice before = choice;
    choice.places.push_back(places_.size());  // no candidate yet
    const bool any = improve(choice.places.size() - 1, &choice);
    choice.nothing_helps = any && measured && choice.score > (1.0 - outlook_.options.min_gain) * score(before.places);
    if (any && !choice.nothing_helps) continue;
    choice.places = before.places;
    choice.score = before.score;
    break;
  }
  bool better = choice.places.size() > 1;
  for (int round = 0; better && round < kExchanges; ++round) {
    better = false;
    for (std::size_t i = 0; i < choice.places.size(); ++i) better = improve(i, &choice) || better;
  }
  return choice;
}

}  // namespace rigproof::suggest
