// Overrides of fields that the rest of the configuration leaves unused.
#pragma once

#include <string>
#include <vector>

#include "rigproof/generator/config.h"

namespace rigproof {

/// Throws Error with every override (FIELD=VALUE) of a field that `config`, which has them, does not look at: who sets
/// one expects something of it.
void refuse_unused(const std::vector<std::string>& overrides, const GenerateConfig& config);

}  // namespace rigproof
