#include "rigproof/calib/plan/accept.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rigproof/calib/diagnose/turning_point.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

AcceptCheck start(const std::string& name, double limit, const char* unit) {
  AcceptCheck check;
  check.name = name;
  check.limit = limit;
  check.unit = unit;
  return check;
}

AcceptCheck failed(AcceptCheck check, const char* code) {
  check.reason = Finding(code);
  return check;
}

AcceptCheck judged(AcceptCheck check, double value) {
  check.value = value;
  check.passed = value <= check.limit;
  return check;
}

// Each degree of freedom against its limit in metres or radians; 0 = not limited.
void check_sigmas(const Result& result, const std::string& parent, const std::string& child, const std::string& name,
                  const std::array<double, 6>& limits, std::vector<AcceptCheck>* checks) {
  const EstimatedTransform* transform = result.find(parent, child);
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!(limits[axis] > 0.0)) continue;
    const bool length = axis < 3;
    const double unit = length ? 1000.0 : rad_to_deg(1.0);
    AcceptCheck check = start(name + ": " + kDegreeOfFreedomNames[axis], unit * limits[axis], length ? "mm" : "deg");
    const Eigen::Index i = static_cast<Eigen::Index>(axis);
    if (transform == nullptr || !transform->observable[axis])
      check = failed(check, "gate.undetermined");
    else if (!transform->covariance)
      check = failed(check, "gate.no_uncertainty");
    else
      check = judged(check, unit * std::sqrt((*transform->covariance)(i, i)));
    checks->push_back(std::move(check));
  }
}

void check_uncertainty(const Result& result, const Observations& observations, const AcceptCriteria& criteria,
                       std::vector<AcceptCheck>* checks) {
  const AcceptLimits robot = criteria.uncertainty.value_or(AcceptLimits{0.0, 0.0, 0.0});
  const double distance = criteria.between_distance_m.value_or(0.0), angle = criteria.between_angle_rad.value_or(0.0);
  const std::vector<RigCamera>& cameras = observations.cameras;
  for (const RigCamera& camera : cameras)
    check_sigmas(result, observations.robot_frame, camera.name, camera.name + " in " + observations.robot_frame,
                 {robot.xy_m, robot.xy_m, robot.z_m, robot.angle_rad, robot.angle_rad, robot.angle_rad}, checks);
  for (std::size_t j = 0; j < cameras.size(); ++j)
    for (std::size_t k = j + 1; k < cameras.size(); ++k)
      check_sigmas(result, cameras[j].name, cameras[k].name, cameras[j].name + "-" + cameras[k].name,
                   {distance, distance, distance, angle, angle, angle}, checks);
}

// Whoever asks for a gate wants to hear of them.
void check_suspicions(const Result& result, std::vector<AcceptCheck>* checks) {
  for (const Finding& note : result.notes) {
    if (note.severity != Severity::kSuspect) continue;
    checks->push_back(start("nothing suspected", 0.0, ""));
    checks->back().reason = note;
  }
}

double worst_z(const EstimatedTransform& a, const EstimatedTransform& b) {
  const Vector6d difference = transform_error(a.T_parent_child, b.T_parent_child);
  Vector6d variance;
  for (std::size_t axis = 0; axis < 6; ++axis)
    variance[static_cast<Eigen::Index>(axis)] =
        variance_beside_turning_point(a, axis) + variance_beside_turning_point(b, axis);
  return difference.cwiseAbs().cwiseQuotient(variance.cwiseSqrt()).maxCoeff();
}

// Worst axis of every camera, in standard deviations of the difference.
void check_split_half(const Method& method, const Observations& observations, double max_z,
                      std::vector<AcceptCheck>* checks) {
  const int stops = static_cast<int>(observations.stops.size());
  const auto half = [&](int begin, int end) {
    const Observations part = stops_of(observations, begin, end);
    return refusal_of(method, {part, nullptr, 1}) ? Result() : method.solve(part);
  };
  const Result first = half(0, stops / 2), second = half(stops / 2, stops);
  for (const RigCamera& camera : observations.cameras) {
    const EstimatedTransform* a = first.find(observations.robot_frame, camera.name);
    const EstimatedTransform* b = second.find(observations.robot_frame, camera.name);
    AcceptCheck check = start("split half: " + camera.name, max_z, "sigma");
    if (a == nullptr || b == nullptr || !a->fully_observable() || !b->fully_observable())
      check = failed(check, "gate.half_undetermined");
    else if (!a->covariance || !b->covariance)
      check = failed(check, "gate.no_uncertainty");
    else
      check = judged(check, worst_z(*a, *b));
    checks->push_back(std::move(check));
  }
}

void check_held_out(const Method& method, const Result& result, const Observations& observations,
                    const AcceptCriteria& criteria, AcceptReport* report) {
  const AcceptCheck check = start("held-out stops: chi-square a dimension", *criteria.held_out_max_ratio, "");
  const auto fail = [&](const char* code) { report->checks.push_back(failed(check, code)); };
  const std::optional<MlOptions> options = method.prediction_options();
  if (!options) return fail("gate.only_ml");
  if (result.status != ResultStatus::kSolved) return fail("gate.unsolved");
  const std::optional<HeldOut> held_out = predict_held_out(observations, criteria.held_out_folds, *options);
  if (!held_out) return fail("gate.too_few_stops");
  report->checks.push_back(judged(check, held_out->chi_square / held_out->expected));
  report->notes.push_back(Finding("gate.held_out", {{"stops_left_out", held_out->stops}}));
}

template <typename Item>
void keep_stops(int first, int last, std::vector<Item>* items) {
  items->erase(std::remove_if(items->begin(), items->end(),
                              [first, last](const Item& item) { return item.stop < first || item.stop >= last; }),
               items->end());
  for (Item& item : *items) item.stop -= first;
}

}  // namespace

Observations stops_of(const Observations& observations, int first, int last) {
  Observations part = observations;
  part.stops.assign(observations.stops.begin() + first, observations.stops.begin() + last);
  keep_stops(first, last, &part.board_views);
  keep_stops(first, last, &part.ground_planes);
  keep_stops(first, last, &part.board_planes);
  keep_stops(first, last, &part.exclusions);
  return part;
}

AcceptReport check_acceptance(const Method& method, const Result& result, const Observations& observations,
                              const AcceptCriteria& criteria) {
  AcceptReport report;
  check_suspicions(result, &report.checks);
  check_uncertainty(result, observations, criteria, &report.checks);
  if (criteria.split_half_max_z) check_split_half(method, observations, *criteria.split_half_max_z, &report.checks);
  if (criteria.held_out_max_ratio) check_held_out(method, result, observations, criteria, &report);
  return report;
}

}  // namespace rigproof
