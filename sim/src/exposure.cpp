#include "rigproof/sim/exposure.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

// Parts that a row has in part count as whole, so that what moves would lie off by up to an eighth of a part's way,
// rows of one band alike. Share goes from one end to the other until the mean moment is the middle of the exposure.
void settle_mean(double middle, std::size_t parts, RowParts* row) {
  double off = middle;
  for (std::size_t i = 0; i < row->shares.size(); ++i)
    off -= row->shares[i] * (static_cast<double>(row->first + i) + 0.5);
  if (std::abs(off) < 1e-9) return;
  if (row->shares.size() == 1 && off > 0.0 && row->first + 1 < parts) row->shares.push_back(0.0);
  if (row->shares.size() == 1 && off < 0.0 && row->first > 0) {
    row->shares.insert(row->shares.begin(), 0.0);
    --row->first;
  }
  if (row->shares.size() == 1) return;
  const double moved = off / static_cast<double>(row->shares.size() - 1);
  row->shares.front() -= moved;
  row->shares.back() += moved;
}

}  // namespace

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
  settle_mean(begin + 0.5 * length, exposure.parts(), &result);
  return result;
}

}  // namespace rigproof
