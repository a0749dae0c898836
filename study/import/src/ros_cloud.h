// Point clouds of ROS messages.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "rigproof/core/rigid3.h"

namespace rigproof {

/// x, y, z of a PointCloud2 message in the camera's frame [m]; points that are not finite are left out. Throws Error
/// without the topic's name.
std::vector<std::array<float, 3>> points_of_message(std::string_view message, const Rigid3& T_camera_cloud);

}  // namespace rigproof
