// Generating and observing at once: pictures go from the renderer through the sensor to the detector in memory.
#pragma once

#include <functional>
#include <string>

#include "rigproof/core/observations.h"
#include "rigproof/generator/generate.h"

namespace rigproof {

struct ObservedRun {
  GenerateReport report;
  Observations observations;
};

/// The observations of a run, to the byte those that observe() makes of its files. Of the run its truth, run.yaml with
/// the hashes of all pictures, and observations.json are left. Resumes frame by frame. Throws Error: with
/// ExitCode::kTryAgain where it was interrupted, and where the folder holds the pictures of a run.
ObservedRun generate_observed(const Scenario& scenario, const GenerateOptions& options);

}  // namespace rigproof
