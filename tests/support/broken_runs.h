// Recordings with one thing wrong each, and the words by which the estimator has to name it.
#pragma once

#include <string>
#include <vector>

#include "rigproof/geometric/geometric.h"

namespace rigproof {

/// Where the likely cause must be named.
enum class NamedIn {
  kReasons,  ///< first: the result is not to be used
  kNotes,    ///< what is wrong is left out, and the rest holds
};

struct Breakage {
  const char* name;
  int min_cameras = 1;
  bool board_depth = false;
  NamedIn named_in = NamedIn::kReasons;
  bool large = false;  ///< 100 stops of the reference rig instead
  /// Breaks the observations; returns the words that name the cause.
  std::string (*apply)(std::uint64_t seed, Observations* observations);
};

const std::vector<Breakage>& breakages();

/// A random rig, and a run of 12 to 30 stops with noise of 0 to 1 times the paper's; every other one declares it.
GeometricConfig broken_run_config(const Breakage& breakage, std::uint64_t seed);

}  // namespace rigproof
