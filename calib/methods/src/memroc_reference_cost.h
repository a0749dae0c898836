// The cost of the authors' program of MEMROC, and its minimum from a given start.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/core/rigid3.h"

namespace rigproof::rivals {

/// One block: two consecutive stops of one camera, and the height at the second one if its plane counted.
struct ReferenceMotion {
  std::size_t camera = 0;
  Rigid3 A;  ///< T_Ri_Ri+1
  Rigid3 B;  ///< T_Ci_Ci+1
  std::optional<double> height_m;
};

/// Two cameras over the same two stops.
struct ReferencePair {
  std::size_t camera_j = 0, camera_k = 0;
  Rigid3 B_j, B_k;
};

/// A height by itself, which the program does not have: it stands in the block of a motion.
struct ReferenceHeight {
  std::size_t camera = 0;
  double height_m = 0.0;
};

struct ReferenceProblem {
  std::vector<Rigid3> X;  ///< T_robot_camera: in the start, out the minimum
  std::vector<ReferenceMotion> motions;
  std::vector<ReferencePair> pairs;
  std::vector<ReferenceHeight> heights;
  bool geodesic = false;  ///< rotations are compared by the angle between them
};

/// Minimises in place: t(AX) - t(XB), log(R_A R_X) - log(R_X R_B) as a difference of rotation vectors (or
/// log((R_A R_X)^-1 R_X R_B)), X_z - height; Cauchy's loss of scale 1 on each block. A camera in no block stays where
/// it starts.
void minimise_reference(ReferenceProblem* problem);

}  // namespace rigproof::rivals
