// Errors that repeat in every image, estimated with all else.
#pragma once

#include "rigproof/calib/estimate/preparation.h"

namespace rigproof::ml {

/// Takes them out of the corners that are used: first as the images alone tell them, then as the whole problem does.
void settle_repeating(Preparation* prepared);

}  // namespace rigproof::ml
