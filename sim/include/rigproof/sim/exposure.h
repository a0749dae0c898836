// How a picture comes about while the robot moves: each row is exposed for a while, rows one after the other.
#pragma once

#include <cstddef>
#include <vector>

#include "rigproof/core/rigid3.h"

namespace rigproof {

/// A moving robot and a shutter. The time from the opening of the first row to the closing of the last is cut into
/// equal parts; in each of them the robot counts as standing where it is in the part's middle.
///
/// Row v of a picture of height h is exposed from readout (v + 1/2) / h on, for `exposure_s`. The middle of the whole
/// time is therefore the middle of the middle row's exposure. A global shutter has readout_s = 0; exposure_s = 0
/// freezes every row.
struct Exposure {
  std::vector<Rigid3> T_world_robot;  ///< in the middles of the parts; at least one
  double exposure_s = 0.0;            ///< of a row
  double readout_s = 0.0;             ///< from the first row's opening to the last row's
  double gamma = 2.2;                 ///< of the picture's levels: light = level^gamma

  std::size_t parts() const { return T_world_robot.size(); }
};

/// The parts in which a row is exposed: `shares` sums to 1, the first entry belongs to part `first`. The mean of the
/// parts' middles is the middle of the row's exposure; a frozen row is of one part.
struct RowParts {
  std::size_t first = 0;
  std::vector<double> shares;
};
RowParts parts_of_row(const Exposure& exposure, int row, int height);

}  // namespace rigproof
