#include "rigproof/generator/generator_version.h"

#include "generator_sources.h"
#include "rigproof/core/version.h"

namespace rigproof {

const std::string& generator_version() {
  static const std::string text = std::string(version()) + "+" + RIGPROOF_GENERATOR_SOURCES;
  return text;
}

}  // namespace rigproof
