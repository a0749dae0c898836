// Robots without pictures whose every error is drawn from what is assumed of it, and can be drawn again by itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rigproof/core/observations.h"
#include "rigproof/truth/truth.h"

namespace rigproof::bench {

/// Where errors come from, as the budget calls them.
inline constexpr std::array<const char*, 11> kSources = {"corners",
                                                         "ground depth",
                                                         "board depth",
                                                         "odometry",
                                                         "suspension",
                                                         "turning point",
                                                         "depth scale",
                                                         "depth error",
                                                         "lens",
                                                         "board",
                                                         "print and lens residual"};
using Seeds = std::array<std::uint64_t, kSources.size()>;

struct DrawnRobot {
  Observations observations;
  Truth truth;
};

/// The reference rig on a drive along its way, of whose odometry nothing is declared. Where it stops depends on `drive`
/// alone, and the errors of each source on that source's seed.
DrawnRobot draw_robot(std::uint64_t drive, const Seeds& seeds, int stops);

/// What is stated of lenses, boards, depth and the turning point, times this.
void widen_priors(double factor, Observations* observations);

}  // namespace rigproof::bench
