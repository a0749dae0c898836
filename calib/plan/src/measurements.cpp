#include "measurements.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "remedies.h"
#include "rigproof/core/text.h"

namespace rigproof::suggest {
namespace {

// Of the variance: with less, what is seen counts for more.
constexpr double kMost = 0.5;

struct Worst {
  const EstimatedTransform* camera = nullptr;
  std::size_t axis = 0;
  double sigma_of_limit = 0.0;
};

// Of what is foretold.
Worst worst_of(const Result& result, const Suggestion& suggestion) {
  const AcceptLimits& limits = suggestion.limits;
  Worst worst;
  for (const EstimatedTransform& camera : result.camera_to_robot)
    for (const CameraForecast& forecast : suggestion.cameras)
      for (std::size_t axis = 0; forecast.camera == camera.child && axis < 6; ++axis) {
        const double limit = axis < 2 ? limits.xy_m : axis == 2 ? limits.z_m : limits.angle_rad;
        const double share = forecast.then[axis].value_or(0.0) / limit;
        if (share > worst.sigma_of_limit) worst = {&camera, axis, share};
      }
  return worst;
}

// "board 80 %, odometry 15 %": the lines of the budget that matter.
std::string largest_shares(const Worst& worst) {
  constexpr double kSmall = 0.1;
  std::vector<std::pair<double, std::string>> lines;
  for (const EstimatedTransform::Share& line : worst.camera->budget)
    if (line.share[worst.axis] >= kSmall) lines.emplace_back(line.share[worst.axis], line.source);
  std::sort(lines.rbegin(), lines.rend());
  std::vector<std::string> texts;
  for (const auto& [share, source] : lines) texts.push_back(source + " " + fixed_text(100.0 * share, 0) + " %");
  return joined(texts);
}

}  // namespace

Finding what_limits(const Result& then, const Suggestion& suggestion, double min_gain) {
  const Worst worst = worst_of(then, suggestion);
  Finding finding("suggest.nothing_helps", {{"which", suggestion.stops.empty() ? "no stop" : "no further stop"},
                                            {"gain_percent", 100.0 * min_gain}});
  if (worst.camera == nullptr || worst.camera->budget.empty()) return finding;
  return finding.with({{"limits", largest_shares(worst)}}).along({kRobotAxes[worst.axis]}).of(worst.camera->child);
}

std::optional<Finding> what_to_measure(const Result& then, const Suggestion& suggestion) {
  const Worst worst = worst_of(then, suggestion);
  if (worst.camera == nullptr || worst.camera->budget.empty()) return std::nullopt;
  const auto share = [&](const EstimatedTransform::Share& line) { return line.share[worst.axis]; };
  const auto largest = std::max_element(worst.camera->budget.begin(), worst.camera->budget.end(),
                                        [&](const auto& a, const auto& b) { return share(a) < share(b); });
  const std::optional<std::string> measure = measurement_for(largest->source);
  if (!measure || share(*largest) < kMost) return std::nullopt;
  return Finding("suggest.measure",
                 {{"source", largest->source}, {"share_percent", 100.0 * share(*largest)}, {"measure", *measure}})
      .along({kRobotAxes[worst.axis]})
      .of(worst.camera->child);
}

}  // namespace rigproof::suggest
