#include "rigproof/calib/estimate/odometry_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rigproof/core/conventions.h"

namespace rigproof::ml {
namespace {

// Probability of an odometry model above which another one's answer is of no account.
constexpr double kSureOfModel = 0.999;

bool at_floor(const NoiseLevels& noise) {
  return noise.odometry_xy_m < 2.0 * kMinOdometryXy_m && noise.odometry_yaw_rad < 2.0 * kMinOdometryYaw_rad;
}

void note_decision(const Fit& other, OdometryChoice* choice) {
  const OdometryDecision& decision = choice->decision;
  const char* name = odometry_model_name(decision.model);
  std::vector<Finding>& notes = choice->notes;
  const FindingValues noise = {{"log_likelihood_ratio", decision.log_likelihood_ratio},
                               {"xy_mm", 1e3 * choice->fit.noise.odometry_xy_m},
                               {"yaw_deg", rad_to_deg(choice->fit.noise.odometry_yaw_rad)}};
  if (!decision.compared)
    notes.push_back(Finding("odometry.model_not_compared", {{"model", name}}));
  else if (at_floor(choice->fit.noise) && at_floor(other.noise))
    notes.push_back(Finding("odometry.models_alike"));
  else if (decision.probability < 0.95)
    notes.push_back(Finding("odometry.model_unsure", {{"model", name}, {"probability", decision.probability}}));
  else if (decision.along_way)
    notes.push_back(Finding("odometry.noise_along_way", noise)
                        .with({{"straight_m", 1.0 / choice->fit.noise.law.metre_as_turn_rad}}));
  else
    notes.push_back(Finding("odometry.noise", noise).with({{"model", name}}));
}

bool has_ways(const Observations& observations) {
  return std::any_of(observations.stops.begin(), observations.stops.end(),
                     [](const Stop& stop) { return !stop.way.empty(); });
}

// Exchanges them where the other is likelier. One that leaves the equations open cannot be compared and comes last.
void keep_likelier(Fit* fit, Fit* other) {
  if (other->minus_two_log_likelihood < fit->minus_two_log_likelihood) std::swap(*fit, *other);
}

// Wheels that slip lose heading where they turn, two driven wheels wherever they roll: by the likeliest of figures that
// lie a decade apart.
Fit fit_along_way(const Preparation& prepared, const Fit& start) {
  const auto fit_with = [&](double metre_as_turn_rad, const Fit& other) {
    return fit_model(prepared, {OdometryModel::kPerIncrement, true, metre_as_turn_rad}, kLeaveOutRounds, &other);
  };
  Fit likeliest = fit_with(OdometryLaw().metre_as_turn_rad, start);
  const auto is_likelier = [&](double metre_as_turn_rad) {
    Fit fit = fit_with(metre_as_turn_rad, likeliest);
    const bool likelier = fit.minus_two_log_likelihood < likeliest.minus_two_log_likelihood;
    if (likelier) likeliest = std::move(fit);
    return likelier;
  };
  if (is_likelier(1.0))
    is_likelier(10.0);
  else
    is_likelier(0.01);
  return likeliest;
}

}  // namespace

OdometryLaw declared_law(OdometryModel model, const MlOptions& options) {
  return {model, options.along_way, options.metre_as_turn_rad};
}

OdometryChoice choose_odometry(const Preparation& prepared) {
  OdometryChoice choice;
  const OdometryModel declared = prepared.original.odometry_noise.model;
  OdometryDecision& decision = choice.decision;
  if (declared != OdometryModel::kUnknown) {
    decision.model = declared;
    decision.along_way = prepared.options.along_way;
    choice.fit = fit_model(prepared, declared_law(declared, prepared.options));
    return choice;
  }
  decision.decided_from_data = true;
  choice.fit = fit_model(prepared, {OdometryModel::kPerIncrement, false});
  Fit second = fit_model(prepared, {OdometryModel::kPerPose, false}, kLeaveOutRounds, &choice.fit);
  keep_likelier(&choice.fit, &second);
  if (has_ways(prepared.used)) {
    Fit third = fit_along_way(prepared, choice.fit);
    keep_likelier(&choice.fit, &third);
    keep_likelier(&second, &third);
  }
  const double difference = second.minus_two_log_likelihood - choice.fit.minus_two_log_likelihood;
  decision.compared = std::isfinite(difference);
  decision.model = choice.fit.noise.law.model;
  decision.along_way = choice.fit.noise.law.along_way;
  decision.log_likelihood_ratio = decision.compared ? 0.5 * difference : 0.0;
  decision.probability = 1.0 / (1.0 + std::exp(-decision.log_likelihood_ratio));
  note_decision(second, &choice);
  if (decision.probability < kSureOfModel) choice.other = std::move(second);
  return choice;
}

}  // namespace rigproof::ml
