// A run whose pictures are looked at while it is generated.
#pragma once

#include <exception>
#include <functional>

#include "cache.h"
#include "rigproof/core/observations.h"
#include "rigproof/generator/generate.h"

namespace rigproof {

struct LookedRun {
  GenerateReport report;
  Observations observations;
  std::exception_ptr failure;  ///< why there are no observations: a property of the data
};

/// Generates with `options`, has the cache keep what is found in each picture, and observes; frames whose findings the
/// cache has lost are made again. Throws what generating throws, and Error with ExitCode::kTryAgain if interrupted.
/// @param tell is given the findings that observing used
LookedRun look_while_generating(const std::function<GenerateReport(const GenerateOptions&)>& generate,
                                GenerateOptions options, const SweepCache& cache, const ObserveOptions& observing,
                                const std::function<void(CachedFindings&)>& tell);

}  // namespace rigproof
