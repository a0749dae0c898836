// Arguments of benchmarks that generate a run: numbers, words, and lines of the run's configuration.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/generator/config.h"

namespace rigproof {

struct RunArguments {
  std::vector<int> numbers;  ///< positive
  std::vector<std::string> words;
  GenerateConfig config;
};

/// Throws Error for a word that is not known, a number that is none, and for a configuration that is refused.
inline RunArguments parse_run_arguments(int argc, char** argv, const std::vector<std::string>& known_words = {}) {
  RunArguments parsed;
  std::string text;
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  for (const std::string& argument : arguments) {
    if (argument.find(':') != std::string::npos) {
      text += argument + "\n";
    } else if (std::find(known_words.begin(), known_words.end(), argument) != known_words.end()) {
      parsed.words.push_back(argument);
    } else {
      const bool digits = argument.find_first_not_of("0123456789") == std::string::npos;
      if (!digits || argument.empty() || argument.size() > 6 || std::stoi(argument) == 0)
        throw Error("argument " + argument + ": allowed are numbers from 1 to 999999 and lines `key: value`");
      parsed.numbers.push_back(std::stoi(argument));
    }
  }
  parsed.config = parse_generate_config(text, "arguments");
  return parsed;
}

}  // namespace rigproof
