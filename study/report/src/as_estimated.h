// What a result's poses go with.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof::inspect_detail {

/// The observations with the lenses and the squares' side that the result estimated in place of the stated ones.
Observations as_estimated(Observations observations, const Result& result);
/// Of each board what the result estimated besides: ratio of its sides and bow, as Nuisance::kBoardShape has them; the
/// size is 0, since it is in the observations.
std::vector<Eigen::Vector4d> board_shapes(const Observations& observations, const Result& result);

}  // namespace rigproof::inspect_detail
