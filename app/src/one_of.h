// Checks of names on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "rigproof/core/text.h"

namespace rigproof {

/// One of these names. CLI11's own check lists them, and does not say which is near.
inline CLI::Validator one_of(const std::vector<std::string>& names) {
  const auto problem = [names](const std::string& text) {
    const bool is_known = std::find(names.begin(), names.end(), text) != names.end();
    return is_known ? std::string() : for_message(text) + ": " + suggestion(text, names);
  };
  return {problem, "{" + joined(names, ",") + "}", "one_of"};
}

}  // namespace rigproof
