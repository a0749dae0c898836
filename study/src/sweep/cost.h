// About how long the parts of a sweep take on one core. Measured where the estimates are checked: docs/sweeps.md.
#pragma once

#include <cstddef>
#include <string>

#include "rigproof/study/sweep_config.h"

namespace rigproof {

/// Of an image of the run, the mean of its cameras.
double megapixels_of(const GenerateConfig& config);
/// Images of stops (stops times cameras) that a task's methods are given.
double views_of(const SweepTask& task);

/// One answer, from so many views; what is searched once in the images is not in it.
double seconds_of_answer(const std::string& method, bool outside, double views);
/// Putting the observations of a task together from findings, and its process.
double seconds_of_observations(double views);
/// Finding board and planes in one image of so many megapixels; matching it with the next one.
double seconds_of_search(double megapixels);
double seconds_of_matching(double megapixels);

}  // namespace rigproof
