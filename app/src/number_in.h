// Checks of numbers on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "rigproof/core/text.h"
#include "rigproof/core/yaml.h"

namespace rigproof {

/// low to high, both allowed. CLI11's own check lets nan pass and writes large limits with 300 digits.
inline CLI::Validator number_in(double low, double high) {
  const std::string range = range_text({low, high});
  const auto problem = [low, high, range](const std::string& text) {
    const auto number = parse_number(text);
    return number && *number >= low && *number <= high ? std::string() : for_message(text) + ": allowed is " + range;
  };
  return {problem, "in " + range, "number_in"};
}

}  // namespace rigproof
