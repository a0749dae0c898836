// New observations, linearised where the cameras stand as before.
#pragma once

#include <optional>

#include "comparison.h"
#include "rigproof/calib/estimate/information.h"

namespace rigproof::moved {

/// What observations tell of the cameras, linearised where they stand as before as far as the observations allow.
///
/// Few stops tell some directions poorly: where the rig sits on the robot, or, from one view, where a camera stands on
/// a circle about the board. There their optimum lies decimetres from the truth, and what is linear at the one is not
/// so at the other. The previous result knows such directions hundreds of times better. So it takes part while the
/// state is found, with thirty times its standard deviations: it decides where the observations leave things open and
/// nowhere else. What the observations want without it is one step from there.
///
/// Absent where the equations cannot be solved.
std::optional<Knowledge> held_knowledge(const Knowledge& before, const Observations& used,
                                        const CalibrationState& optimum, const CalibrationNoise& noise);

}  // namespace rigproof::moved
