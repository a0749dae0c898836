// The texts of the MEMROC authors' layout; load_memroc_layout() reads the same values back.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/rig.h"

namespace rigproof {

/// CalibrationInfo.yaml: `number_of_rows` are the inner corners along the board's x axis, `size` in metres.
std::string memroc_calibration_info(const Rig& rig);
/// intrinsic_pars_file.yaml. Throws Error for a lens that it cannot say (fisheye).
std::string memroc_intrinsics(const Camera& camera);
/// pose/0000.csv: T_world_robot, four rows of four numbers with commas.
std::string memroc_pose(const Rigid3& T_world_robot);
/// clouds/0000.txt: x y z, a point a line, metres in the colour camera's frame.
std::string memroc_cloud(const std::vector<Eigen::Vector3f>& points);
/// Folder of a camera: camera1, camera2, ...
std::string memroc_camera_folder(std::size_t camera);
/// "0012": the name of frame 12 without extension.
std::string memroc_frame_name(std::size_t frame);

}  // namespace rigproof
