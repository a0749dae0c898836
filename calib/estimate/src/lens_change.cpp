#include "rigproof/calib/estimate/lens_change.h"

#include <filesystem>

namespace rigproof::ml {

bool is_registered(const PlaneObservation& plane, const RigCamera& camera) {
  if (!camera.depth || camera.depth->own_camera || plane.file.empty()) return false;
  const std::string extension = std::filesystem::path(plane.file).extension().string();
  return extension != ".pcd" && extension != ".ply";
}

Camera changed_lens(Camera lens, const Eigen::Vector3d& change) {
  lens.fx_px *= 1.0 + change[0];
  lens.fy_px *= 1.0 + change[0];
  lens.cx_px += change[1];
  lens.cy_px += change[2];
  return lens;
}

Eigen::Matrix3d plane_by_lens(const Eigen::Vector3d& plane_per_m, const Camera& lens) {
  Eigen::Matrix3d by_lens = Eigen::Matrix3d::Zero();
  by_lens.col(0).head<2>() = plane_per_m.head<2>();
  by_lens(2, 1) = plane_per_m.x() / lens.fx_px;
  by_lens(2, 2) = plane_per_m.y() / lens.fy_px;
  return by_lens;
}

void change_lens(int camera, const Eigen::Vector3d& change, Observations* observations) {
  RigCamera& rig_camera = observations->cameras[static_cast<std::size_t>(camera)];
  Camera& lens = rig_camera.camera;
  Eigen::Matrix3d to;  // of planes
  for (int i = 0; i < 3; ++i)
    to.col(i) = Eigen::Vector3d::Unit(i) + plane_by_lens(Eigen::Vector3d::Unit(i), lens) * change;
  for (auto* planes : {&observations->ground_planes, &observations->board_planes})
    for (PlaneObservation& plane : *planes) {
      if (plane.camera != camera || !is_registered(plane, rig_camera)) continue;
      plane.inverse_depth_plane = (to * plane.inverse_depth_plane).eval();
      plane.covariance_per_m2 = (to * plane.covariance_per_m2 * to.transpose()).eval();
    }
  lens = changed_lens(lens, change);
}

}  // namespace rigproof::ml
