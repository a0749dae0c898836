#include "rigproof/calib/plan/accept.h"

#include <algorithm>
#include <cmath>

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

class Acceptance {
 public:
  Acceptance(const Method& method, const Result& result, const Observations& observations,
             const AcceptCriteria& criteria)
      : method_(method), result_(result), observations_(observations), criteria_(criteria) {}

  AcceptReport report() {
    if (criteria_.uncertainty) check_uncertainty(*criteria_.uncertainty);
    check_between_cameras();
    if (criteria_.split_half_max_z) check_split_half(*criteria_.split_half_max_z);
    if (criteria_.held_out_max_ratio) check_held_out(*criteria_.held_out_max_ratio);
    return std::move(report_);
  }

 private:
  // One degree of freedom against a limit in metres or radians; 0 = not limited.
  void check_sigma(const EstimatedTransform* transform, const std::string& name, std::size_t axis, double limit) {
    if (!(limit > 0.0)) return;
    const bool length = axis < 3;
    const double unit = length ? 1000.0 : rad_to_deg(1.0);
    AcceptCheck check = start(name + ": " + kDegreeOfFreedomNames[axis], unit * limit, length ? "mm" : "deg");
    const Eigen::Index i = static_cast<Eigen::Index>(axis);
    if (transform == nullptr || !transform->observable[axis])
      check = failed(check, "gate.undetermined");
    else if (!transform->covariance)
      check = failed(check, "gate.no_uncertainty");
    else
      check = judged(check, unit * std::sqrt((*transform->covariance)(i, i)));
    report_.checks.push_back(std::move(check));
  }

  void check_uncertainty(const AcceptLimits& limits) {
    for (const RigCamera& camera : observations_.cameras) {
      const EstimatedTransform* transform = result_.find(observations_.robot_frame, camera.name);
      for (std::size_t axis = 0; axis < 6; ++axis)
        check_sigma(transform, camera.name + " in " + observations_.robot_frame, axis,
                    axis < 2   ? limits.xy_m
                    : axis < 3 ? limits.z_m
                               : limits.angle_rad);
    }
  }

  void check_between_cameras() {
    const double distance = criteria_.between_distance_m.value_or(0.0),
                 angle = criteria_.between_angle_rad.value_or(0.0);
    for (std::size_t j = 0; j < observations_.cameras.size(); ++j)
      for (std::size_t k = j + 1; k < observations_.cameras.size(); ++k) {
        const std::string &parent = observations_.cameras[j].name, &child = observations_.cameras[k].name;
        for (std::size_t axis = 0; axis < 6; ++axis)
          check_sigma(result_.find(parent, child), parent + "-" + child, axis, axis < 3 ? distance : angle);
      }
  }

  // Worst axis of every camera, in standard deviations of the difference.
  void check_split_half(double max_z) {
    const int stops = static_cast<int>(observations_.stops.size());
    const Result first = method_.solve(stops_of(observations_, 0, stops / 2));
    const Result second = method_.solve(stops_of(observations_, stops / 2, stops));
    for (const RigCamera& camera : observations_.cameras) {
      const EstimatedTransform* a = first.find(observations_.robot_frame, camera.name);
      const EstimatedTransform* b = second.find(observations_.robot_frame, camera.name);
      AcceptCheck check = start("split half: " + camera.name, max_z, "sigma");
      if (a == nullptr || b == nullptr || !a->fully_observable() || !b->fully_observable())
        check = failed(check, "gate.half_undetermined");
      else if (!a->covariance || !b->covariance)
        check = failed(check, "gate.no_uncertainty");
      else
        check = judged(check, worst_z(*a, *b));
      report_.checks.push_back(std::move(check));
    }
  }

  static double worst_z(const EstimatedTransform& a, const EstimatedTransform& b) {
    const Vector6d difference = transform_error(a.T_parent_child, b.T_parent_child);
    const Vector6d variance = a.covariance->diagonal() + b.covariance->diagonal();
    return difference.cwiseAbs().cwiseQuotient(variance.cwiseSqrt()).maxCoeff();
  }

  void check_held_out(double max_ratio) {
    AcceptCheck check = start("held-out stops: chi-square a dimension", max_ratio, "");
    const std::optional<MlOptions> options = method_.prediction_options();
    if (!options) {
      check = failed(check, "gate.only_ml");
    } else if (result_.status != ResultStatus::kSolved) {
      check = failed(check, "gate.unsolved");
    } else if (const std::optional<HeldOut> held_out =
                   predict_held_out(observations_, criteria_.held_out_folds, *options)) {
      check = judged(check, held_out->chi_square / held_out->expected);
      report_.notes.push_back(Finding("gate.held_out", {{"stops_left_out", held_out->stops}}));
    } else {
      check = failed(check, "gate.too_few_stops");
    }
    report_.checks.push_back(std::move(check));
  }

  const Method& method_;
  const Result& result_;
  const Observations& observations_;
  const AcceptCriteria& criteria_;
  AcceptReport report_;
};

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
  return Acceptance(method, result, observations, criteria).report();
}

}  // namespace rigproof
