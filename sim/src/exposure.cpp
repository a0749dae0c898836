#include "rigproof/sim/exposure.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/error.h"

namespace rigproof {

RowParts parts_of_row(const Exposure& exposure, int row, int height) {
  if (exposure.T_world_robot.empty()) throw Error("an exposure needs at least one pose of the robot");
  const double whole_s = exposure.exposure_s + exposure.readout_s;
  const auto parts = static_cast<double>(exposure.parts());
  if (exposure.parts() == 1 || !(whole_s > 0.0)) return {0, {1.0}};
  const double begin = parts * exposure.readout_s / whole_s * (row + 0.5) / height;
  const double length = parts * exposure.exposure_s / whole_s;
  const auto first = static_cast<std::size_t>(std::min(std::floor(begin), parts - 1.0));
  RowParts result{first, {}};
  double sum = 0.0;
  for (std::size_t part = first; part < exposure.parts(); ++part) {
    const auto from = static_cast<double>(part);
    const double share = std::min(begin + length, from + 1.0) - std::max(begin, from);
    if (share <= 0.0) break;
    result.shares.push_back(share);
    sum += share;
  }
  if (result.shares.empty()) return {first, {1.0}};
  for (double& share : result.shares) share /= sum;
  return result;
}

}  // namespace rigproof
