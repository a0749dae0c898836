// New observations, linearised near the previous poses of the cameras.
#pragma once

#include <optional>

#include "comparison.h"
#include "rigproof/calib/estimate/information.h"
#include "rigproof/calib/estimate/repeating_errors.h"

namespace rigproof::moved {

/// Information of the observations about the cameras, linearised as near to the previous poses as the observations
/// allow.
///
/// Few stops determine some directions poorly: the place of the rig on the robot or, from one view, the place of a
/// camera on a circle about the board. Along these, the optimum lies decimetres from the truth, too far for a
/// linearisation there to hold at the truth. The previous result knows such directions hundreds of times better. While
/// the state is found it is therefore a prior, whose standard deviations are those of the previous result times thirty:
/// it decides only what the observations leave open. The estimate without the prior is one step from there.
///
/// `moved`: columns along which the cameras may have moved, about which the prior then says nothing.
///
/// `repeating`: what repeats in every image and was taken out of the observations; null where nothing was.
///
/// Absent where the equations cannot be solved.
std::optional<KnownPoses> held_knowledge(const KnownPoses& before, const Eigen::MatrixXd& moved,
                                         const Observations& used, const CalibrationState& optimum,
                                         const CalibrationNoise& noise, const ml::RemovedErrors* repeating);

}  // namespace rigproof::moved
