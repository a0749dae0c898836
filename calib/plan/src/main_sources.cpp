#include "rigproof/calib/plan/main_sources.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "remedies.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

struct AxisSource {
  std::size_t axis;
  std::string source;
  double sigma, part;  // cm, deg
  std::string worst;   // the camera, where others are known better
};

constexpr double kAlike = 1.05;  // sigmas that differ by less

double variance_of(const EstimatedTransform& camera, std::size_t axis) {
  const auto i = static_cast<Eigen::Index>(axis);
  return camera.covariance && camera.observable[axis] ? (*camera.covariance)(i, i) : 0.0;
}

// Of the camera that is known worst along or about the axis.
std::optional<AxisSource> source_of(const Result& result, std::size_t axis) {
  const auto worst =
      std::max_element(result.camera_to_robot.begin(), result.camera_to_robot.end(),
                       [axis](const auto& a, const auto& b) { return variance_of(a, axis) < variance_of(b, axis); });
  if (worst == result.camera_to_robot.end() || worst->budget.empty()) return std::nullopt;
  const double sigma = std::sqrt(variance_of(*worst, axis)) * (axis < 3 ? 100.0 : rad_to_deg(1.0));
  if (!(sigma > 0.0)) return std::nullopt;
  const auto most = std::max_element(worst->budget.begin(), worst->budget.end(),
                                     [axis](const auto& a, const auto& b) { return a.share[axis] < b.share[axis]; });
  const bool others_better =
      std::any_of(result.camera_to_robot.begin(), result.camera_to_robot.end(), [&](const EstimatedTransform& camera) {
        return variance_of(camera, axis) > 0.0 &&
               variance_of(*worst, axis) > kAlike * kAlike * variance_of(camera, axis);
      });
  return AxisSource{axis, most->source, sigma, sigma * std::sqrt(most->share[axis]), others_better ? worst->child : ""};
}

bool belong_together(const AxisSource& a, const AxisSource& b) {
  return a.source == b.source && (a.axis < 3) == (b.axis < 3);
}

Finding finding_of(const std::vector<AxisSource>& group) {
  const auto by_sigma = [](const AxisSource& a, const AxisSource& b) { return a.sigma < b.sigma; };
  const auto [least, most] = std::minmax_element(group.begin(), group.end(), by_sigma);
  Finding finding("uncertainty.source",
                  {{"sigma", most->sigma}, {"part", most->part}, {"unit", most->axis < 3 ? "cm" : "deg"}});
  if (most->sigma > kAlike * least->sigma) finding = finding.with({{"uneven", 1}});
  if (!most->worst.empty()) finding = finding.with({{"worst", most->worst}});
  const std::string measure = measurement_for(most->source).value_or("");
  if (measure != "centre") finding = finding.with({{"source", most->source}});
  if (!measure.empty()) finding = finding.with({{"measure", measure}});
  for (const AxisSource& axis : group) finding.axes.emplace_back(kRobotAxes[axis.axis]);
  return finding;
}

}  // namespace

std::vector<Finding> main_sources(const Result& result) {
  std::vector<std::vector<AxisSource>> groups;
  for (std::size_t axis = 0; axis < kRobotAxes.size(); ++axis) {
    const std::optional<AxisSource> found = source_of(result, axis);
    if (!found) continue;
    const auto group = std::find_if(groups.begin(), groups.end(),
                                    [&](const auto& other) { return belong_together(other.front(), *found); });
    if (group == groups.end())
      groups.push_back({*found});
    else
      group->push_back(*found);
  }
  std::vector<Finding> findings;
  for (const std::vector<AxisSource>& group : groups) findings.push_back(finding_of(group));
  return findings;
}

}  // namespace rigproof
