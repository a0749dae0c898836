// observations.json as text, for who holds observations elsewhere than in a file.
#pragma once

#include <string>

#include "rigproof/core/observations.h"

namespace rigproof {

/// What observations.json has.
std::string observations_text(const Observations& observations);

/// The same back, with every check of load_observations(). Throws Error with every problem found; `name` stands for the
/// file in its messages.
Observations parse_observations(const std::string& text, const std::string& name);

}  // namespace rigproof
