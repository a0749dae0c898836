// Observations as the lenses that were estimated would have given them.
#pragma once

#include <Eigen/Core>

#include "rigproof/calib/estimate/fit.h"

namespace rigproof::ml {

/// What was used of the observations, with the estimated lenses and how well these are known in place of the stated
/// ones; planes that follow a lens follow it. The same where lenses are believed.
/// @param globals covariance of the unknowns that all stops share
Observations with_estimated_lenses(const Preparation& prepared, const Fit& fit, const Eigen::MatrixXd& globals);

}  // namespace rigproof::ml
