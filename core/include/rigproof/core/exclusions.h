// Frames that calibration leaves out.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/observations.h"

namespace rigproof {

/// Those that concern only depth, or only the others.
std::vector<Exclusion> of_depth(const std::vector<Exclusion>& all, bool depth);
/// Those of one camera.
std::vector<Exclusion> exclusions_of(const std::vector<Exclusion>& all, int camera);

/// What findings were made for, the most frequent first, each with its `count`; figures that differ are left out.
std::vector<Finding> counted(const std::vector<Finding>& findings);

/// The finding with why no image of the camera shows the board: how many there are, what they were left out for, and
/// what to do (`remedy`: clock or aim).
Finding with_lack_of_views(Finding finding, const std::vector<Exclusion>& all, int camera);
/// The same with why the camera has no depth: an example of what most was left out for, if any was.
Finding with_lack_of_depth(Finding finding, const std::vector<Exclusion>& all, int camera);

}  // namespace rigproof
