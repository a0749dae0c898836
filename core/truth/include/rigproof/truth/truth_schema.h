// JSON Schema of truth/truth.yaml.
#pragma once

#include <string>

namespace rigproof {

std::string truth_schema();

}  // namespace rigproof
