#include "rigproof/truth/stop_at.h"

#include <algorithm>
#include <cmath>

namespace rigproof {

std::optional<std::size_t> stop_at(const std::vector<TrueStop>& stops, double stamp_s) {
  constexpr double kLargest = 0.5;
  std::optional<std::size_t> nearest;
  for (std::size_t i = 0; i < stops.size(); ++i)
    if (!nearest || std::abs(stops[i].stamp_s - stamp_s) < std::abs(stops[*nearest].stamp_s - stamp_s)) nearest = i;
  if (!nearest) return std::nullopt;
  double tolerance = kLargest;
  for (const std::size_t other : {*nearest - 1, *nearest + 1})  // one of them may wrap beyond the end: no neighbour
    if (other < stops.size())
      tolerance = std::min(tolerance, 0.5 * std::abs(stops[other].stamp_s - stops[*nearest].stamp_s));
  if (std::abs(stops[*nearest].stamp_s - stamp_s) > tolerance) return std::nullopt;
  return nearest;
}

std::optional<Rigid3> robot_at(const Truth& truth, double stamp_s) {
  const TrueStop* nearest = nullptr;
  const auto look = [&](const std::vector<TrueStop>& stops) {
    const std::optional<std::size_t> match = stop_at(stops, stamp_s);
    if (!match) return;
    const TrueStop& stop = stops[*match];
    if (nearest == nullptr || std::abs(stop.stamp_s - stamp_s) < std::abs(nearest->stamp_s - stamp_s)) nearest = &stop;
  };
  look(truth.stops);
  for (const TrueCamera& camera : truth.cameras) look(camera.stops);
  return nearest == nullptr ? std::nullopt : std::optional<Rigid3>(nearest->T_world_robot);
}

}  // namespace rigproof
