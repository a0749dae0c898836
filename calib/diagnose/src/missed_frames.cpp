#include "missed_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace rigproof::ml {
namespace {

double value_of(const Finding& finding, const char* name) {
  const FindingValue* value = finding.find(name);
  const double* number = value == nullptr ? nullptr : std::get_if<double>(&value->value);
  return number == nullptr ? 0.0 : *number;
}

// Frames whose last stamp is a thousand times that of the odometry, or a million times.
const char* unit_of(double last_frame, double last_odometry) {
  constexpr double kNear = 0.1;
  constexpr std::array<std::pair<double, const char*>, 3> kUnits = {
      {{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}}};
  for (const auto& [factor, unit] : kUnits)
    if (std::abs(last_frame - factor * last_odometry) < kNear * factor * last_odometry) return unit;
  return nullptr;
}

}  // namespace

std::optional<Finding> find_missed_frames(const Observations& observations) {
  std::size_t missed = 0, frames = observations.board_views.size();
  double last_frame = 0.0, last_odometry = 0.0;
  for (const Exclusion& exclusion : observations.exclusions) {
    const Finding& why = exclusion.why;
    if (!exclusion.depth) ++frames;
    if (!why.is("odometry.not_covering") && !why.is("odometry.gap")) continue;
    ++missed;
    last_frame = std::max(last_frame, value_of(why, "stamp_s"));
    last_odometry = std::max(last_odometry, value_of(why, "last_s"));
  }
  if (missed == 0 || 2 * missed < frames) return std::nullopt;
  const Finding found("odometry.misses_frames", {{"missed", missed}, {"frames", frames}});
  const char* unit = unit_of(last_frame, last_odometry);
  return unit == nullptr ? found : found.with({{"unit", unit}});
}

}  // namespace rigproof::ml
