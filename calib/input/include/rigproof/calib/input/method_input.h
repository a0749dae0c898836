// Input of calibration, shared by the modules that read images and those that solve.
#pragma once

#include <cstddef>
#include <functional>

#include "rigproof/core/error.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"

namespace rigproof {

class FeatureSource;
class HorizonSource;
class PictureMemory;

/// Input of a method: the observations and, if there is one, the recording that they come from. A recording holds what
/// a robot could record, never the truth.
struct MethodInput {
  const Observations& observations;
  const Recording* recording = nullptr;     ///< none where the input was observations alone
  int threads = 0;                          ///< 0 = all cores; results do not depend on it
  const FeatureSource* features = nullptr;  ///< where methods that follow features get them; none: SIFT
  const HorizonSource* horizon = nullptr;   ///< a network that sees horizon and way ahead; none: geometry
  /// Called from one thread at a time with (images read, images in all) by what reads images; return false to
  /// interrupt, which throws Error with ExitCode::kTryAgain.
  std::function<bool(std::size_t, std::size_t)> progress = {};
  PictureMemory* memory = nullptr;  ///< what was found in the recording's images before; results do not depend on it
  /// Asked between pieces of work that take long, from one thread at a time; false interrupts as `progress` does.
  std::function<bool()> keep_going = {};
};

/// Throws Error with ExitCode::kTryAgain where the input's keep_going says no.
inline void throw_if_interrupted(const MethodInput& input) {
  if (input.keep_going && !input.keep_going()) throw Error("interrupted", ExitCode::kTryAgain);
}

}  // namespace rigproof
