// The error that all ground planes of one camera have in common.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// Its covariance [1/m^2], one a camera, zero where there is none; empty if no camera has any.
///
/// Stated covariances hold for one plane. Depth is rounded to whole counts; without noise a level camera rounds the
/// same floor the same way from every stop, so that along some directions (height, mostly) its planes agree far better
/// than stated and no number of them is better than one. What they scatter less than stated there is then the same in
/// all of them.
std::vector<Eigen::Matrix3d> shared_ground_errors(const Observations& observations);

}  // namespace rigproof::ml
