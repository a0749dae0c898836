// ROS CameraInfo as a YAML file: what camera_calibration and `ros2 topic echo` write.
#pragma once

#include "rigproof/core/camera.h"
#include "rigproof/core/yaml.h"

namespace rigproof {

/// Reads size, matrix, distortion model and coefficients; other keys are left alone. Problems are reported.
Camera read_camera_info(const YamlTree& tree, Problems* problems);

}  // namespace rigproof
