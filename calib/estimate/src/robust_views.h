// Board poses of single views that a few wrong corners cannot bend.
#pragma once

#include <vector>

#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// Refines the poses of views whose corners fit worse than their covariances say, with a redescending loss at the
/// scale of the view's own median residual. Views without wrong corners stay as they are.
void refine_robustly(const Observations& observations, std::vector<ViewPose>* views);

}  // namespace rigproof::ml
