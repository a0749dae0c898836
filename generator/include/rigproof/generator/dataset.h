// Data sets of several worlds: one configuration, one run for each world.
#pragma once

#include <vector>

#include "rigproof/generator/config.h"

namespace rigproof {

/// The runs that a configuration makes: itself, or one for each of its `scenes`, named NAME/SCENE, with seeds that
/// count up so that no two worlds draw the same numbers. Throws Error that names every scene that does not exist.
std::vector<GenerateConfig> runs_of(const GenerateConfig& config);

}  // namespace rigproof
