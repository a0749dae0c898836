// Covariance of the determined part of a camera's pose, if the motion does not determine all of it.
#pragma once

#include <vector>

#include "rigproof/calib/geometry/initial_guess.h"
#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Chart of transform_error(), zero for x and y. Height and tilt by the accepted ground planes (or tilt by the vertical
/// of the motion), yaw by how far the odometry's path scatters about the seen one
/// and by how well the views know the camera's heading.
Matrix6d partial_covariance(const Observations& observations, const std::vector<ViewPose>& views, int camera,
                            const Rigid3& T_robot_camera, const TrajectoryAlignment& alignment,
                            const std::vector<PlaneObservation>& ground, const InitialGuess& guess);

}  // namespace rigproof
