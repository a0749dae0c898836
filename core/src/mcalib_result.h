// What MC-Calib answers: calibrated_cameras_data.yml.
#pragma once

#include "rigproof/core/result.h"
#include "rigproof/core/yaml.h"

namespace rigproof {

/// Whether a file is one of MC-Calib's lists of cameras.
bool is_mcalib_result(const YamlTree& tree);
/// Poses of its cameras in its first one (camera_pose_matrix, T_first_camera), of those in the first one's group; what
/// is not connected to it is a reason. The names of the cameras are those in the camera_params.yml beside the file,
/// which `bench export --to mcalib` writes; without it they are camera_0, camera_1, ..
Result read_mcalib_result(const YamlTree& tree, Problems* problems);

}  // namespace rigproof
