// The vertical in a camera, from the turns of a drive: their common axis, with the sign from the odometry.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "rigproof/calib/vision/relative_pose.h"
#include "rigproof/calib/vision/straight_drive.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"

namespace rigproof::rivals {

/// The vertical in a camera, from one turn.
struct TurnAxis {
  Eigen::Vector3d up;   ///< unit vector in the camera's frame
  double weight = 0.0;  ///< square of the angle
};

/// Absent if the step turns too little, or if the images show another angle than the odometry.
std::optional<TurnAxis> turn_axis(const Step& step, const RelativePose& pose);

/// Why turns do not determine the vertical; absent if they do in at least one camera. Opens no image.
std::optional<Finding> why_no_vertical(const Observations& observations, const Recording& recording);

}  // namespace rigproof::rivals
