// Which generator makes data.
#pragma once

#include <string>

namespace rigproof {

/// "0.2.0+1f6aa0b92c3d": the version and a hash of the sources of core, sim and generator. Other sources may make other
/// bytes of the same configuration, so it is a part of what every cache and every run folder goes by.
const std::string& generator_version();

}  // namespace rigproof
