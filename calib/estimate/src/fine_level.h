// How large the fine field of a lens is, from what is left of the corners.
#pragma once

#include <vector>

#include "fine_field.h"
#include "image_rows.h"

namespace rigproof::ml {

/// A view of the camera as it is left when all else is estimated.
struct LeftOver {
  const ViewRows* rows;
  Eigen::VectorXd residual;  ///< whitened by what is stated
  Eigen::VectorXd weights;   ///< of each row: weights that fall with the residual would make the field look smaller
};

struct FineLevel {
  double sigma_px;      ///< root mean square at the nodes
  double shown_px;      ///< the same by what corners are displaced: nearly the field's, whether the grid fits it or not
  double noise;         ///< variance of the corners beside it, as a multiple of what is stated
  double log_evidence;  ///< of the grid against no field: likelihood of what is left, averaged over the size's prior
};
/// By restricted likelihood: poses of the views and what polynomials follow are projected out. Where the images tell
/// little the size is near what the prior says.
/// @param prior_px median of its prior, at the nodes; the prior's tails are wide
FineLevel fine_level(const std::vector<LeftOver>& views, const FineField& fine, const LensField& smooth,
                     double prior_px);

}  // namespace rigproof::ml
