// MEMROC and Joint-MEMROC: the paper's hand-eye cost with a geodesic rotation residual, any mounting, any ground plane.
#pragma once

#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/result.h"

namespace rigproof {

struct MemrocOptions {
  bool joint = false;  ///< with a term for every pair of cameras that saw the board at the same two stops
};

/// Solves from board poses that are already known.
/// A X = X B over consecutive views of each camera, plus X_z against the height of every ground plane, equal weights.
/// Covariances of degrees that are not observable are zero.
Result solve_memroc(const Observations& observations, const ViewPoses& views, const MemrocOptions& options);

}  // namespace rigproof
