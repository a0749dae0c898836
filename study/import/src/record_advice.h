// What is missing of a drive so far, and where to turn for it.
#pragma once

#include <vector>

#include "rigproof/calib/vision/stops.h"
#include "rigproof/core/rig.h"
#include "rigproof/study/import/record_check.h"

namespace rigproof {

/// For each camera that has not seen the board the middle of the widest range of headings at which it has not looked
/// for it; for the camera whose image is covered least the part of it where the board is missing. No calibration is
/// needed: turns are read off the odometry and the lens.
std::vector<Advice> advice_for(const std::vector<RigCamera>& cameras, const std::vector<detection::PlannedStop>& stops,
                               const RecordCheck& check, const Board& board);

}  // namespace rigproof
