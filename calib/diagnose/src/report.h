// From a solution to the result that users see: transforms with their uncertainty, refusals and the use of each camera.
#pragma once

#include "rigproof/calib/diagnose/ml.h"
#include "statement.h"

namespace rigproof::ml {

MlEstimate report(const Preparation& prepared, const OdometryChoice& choice, const Examination& found,
                  const Statement& stated);
/// Where no camera saw the board.
MlEstimate report_unsolvable(const Preparation& prepared);

}  // namespace rigproof::ml
