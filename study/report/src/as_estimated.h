// What a result's poses go with.
#pragma once

#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof::inspect_detail {

/// The observations with the lenses and the squares' side that the result estimated in place of the stated ones.
Observations as_estimated(Observations observations, const Result& result);

}  // namespace rigproof::inspect_detail
