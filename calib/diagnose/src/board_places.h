// Places that are stated of boards against the first one.
#pragma once

#include "examination.h"
#include "rigproof/calib/estimate/odometry_choice.h"
#include "rigproof/core/result.h"

namespace rigproof::ml {

/// Where all else is in order, solves again with the stated places as priors. Without those that the drive contradicts,
/// which are named: a wrong place must not bend what is right without it. Where it is open which odometry model holds,
/// a place must fit both.
void use_stated_places(Preparation* prepared, OdometryChoice* choice, Examination* found);

/// Where the boards stand, with how well that is known; none where their poses are not determined.
std::vector<EstimatedBoard> standing_boards(const Preparation& prepared, const Fit& fit,
                                            const GlobalCovariance& globals);

}  // namespace rigproof::ml
