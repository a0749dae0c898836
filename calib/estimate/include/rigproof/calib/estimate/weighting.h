// What residuals are evaluated for.
#pragma once

namespace rigproof::ml {

/// How a block of residuals counts in the normal equations.
enum class Weighting {
  kRobust,  ///< by the loss: steps of the solver
  kSlope,   ///< by the loss's expected slope: one step from afar; odometry, of which few stops have none to spare, by
            ///< the loss
  kInformation,  ///< by the information that the loss keeps: covariance
  kUnit,         ///< fully, whatever the residual: the bound at the truth
};

}  // namespace rigproof::ml
