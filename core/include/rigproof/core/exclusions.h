// Frames that calibration leaves out, in words.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/observations.h"

namespace rigproof {

/// True where only the depth of a frame was left out.
bool concerns_depth(const Exclusion& exclusion);

/// Frames that were left out for one reason.
struct ReasonGroup {
  std::string reason;
  std::vector<int> stops;
};

/// The most frequent reason first. What stands in brackets differs from frame to frame: only a reason that is the same
/// for all its frames keeps it.
std::vector<ReasonGroup> by_reason(const std::vector<Exclusion>& left_out);

/// Those that concern only depth, or only the others.
std::vector<Exclusion> of_depth(const std::vector<Exclusion>& all, bool depth);
/// Those of one camera.
std::vector<Exclusion> exclusions_of(const std::vector<Exclusion>& all, int camera);

/// Why no image of the camera shows the board: what they were left out for, how often, and what to do.
std::string why_no_view(const std::vector<Exclusion>& all, int camera);
/// ": depth of 20 images is left out, as of left/depth/000000.png: ..", or nothing where no depth was left out.
std::string why_no_depth(const std::vector<Exclusion>& all, int camera);

}  // namespace rigproof
