// The methods of a sweep: which they are, and what an answer of each depends on.
#pragma once

#include <string>
#include <vector>

#include "rigproof/study/sweep/config.h"

namespace rigproof {

/// A method as a sweep knows it.
struct SweepMethod {
  std::string spec;  ///< "ml", "external:/path/theirs.yaml"
  std::string name;
  SweepVision vision;
  std::string hash;    ///< of the program, or of the description of one from outside; of the vision and its networks
  std::string stored;  ///< under which the cache knows its answers
  bool outside = false;
  bool reads_images = false;
  bool matches_features = false;
  double seconds_a_view = 0.0;  ///< to solve; of one from outside nobody knows
};

/// Those that stand there, then new ones, each once; a file is a method from outside, by its absolute path.
std::vector<std::string> with_added(std::vector<std::string> there, const std::vector<std::string>& more);

/// Those of the configuration, then the added ones. Throws Error with everything that is wrong with their names and
/// descriptions.
std::vector<SweepMethod> sweep_methods(const SweepConfig& config, const std::vector<std::string>& added);

/// Why a method cannot have its ground from where its vision wants it; absent if it can.
std::optional<Finding> why_no_ground(const SweepVision& vision, bool has_images);

}  // namespace rigproof
