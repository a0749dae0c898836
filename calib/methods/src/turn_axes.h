// Where up is in a camera, from the turns of a drive: their common axis, with the odometry's sense.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "rigproof/calib/vision/relative_pose.h"
#include "rigproof/calib/vision/straight_drive.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"

namespace rigproof::rivals {

/// What one turn tells of a camera's vertical.
struct TurnAxis {
  Eigen::Vector3d up;   ///< unit vector in the camera's frame
  double weight = 0.0;  ///< square of the angle
};

/// Absent where the step turns too little, or the images show another angle than the odometry.
std::optional<TurnAxis> turn_axis(const Step& step, const RelativePose& pose);

/// Why turns cannot tell where up is; absent if they can in one camera at least. Opens no image.
std::optional<Finding> why_no_vertical(const Observations& observations, const Recording& recording);

}  // namespace rigproof::rivals
