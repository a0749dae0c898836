// Frames that other cameras vouch for: by what cameras that see the board at one stop say of each other.
#pragma once

#include <vector>

#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// How two cameras sit to each other shows at every stop at which both see the board, without odometry or a solution. A
/// frame of another camera or another stop stands out; a lens or a board that is wrong in all frames does not.
class PairAgreement {
 public:
  explicit PairAgreement(const Observations& observations);

  /// Another camera sees the board there, too, and the two sit to each other as at most stops.
  bool vouches_for(int camera, int stop) const;
  /// Of nearly all its frames: had they been filed at other stops, from any stop on, they would stand out.
  bool vouches_for(int camera) const;

 private:
  std::vector<std::vector<bool>> agrees_;  // by camera and stop
  std::vector<bool> nearly_all_agree_;     // by camera
};

}  // namespace rigproof::ml
