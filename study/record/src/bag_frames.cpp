#include "bag_frames.h"

#include "rigproof/core/body_axes.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::string optical_frame_in_bag(const RigCamera& camera) {
  return optical_frame_name(camera.name, camera.link, camera.optical_frame);
}

std::string depth_frame_in_bag(const RigCamera& camera) {
  return camera.depth && camera.depth->own_camera ? camera.name + "_depth_optical_frame" : optical_frame_in_bag(camera);
}

FrameTree frames_of_bag(const Recording& recording) {
  std::error_code ignored;
  const fs::path file = recording.folder / kFrameTreeFile;
  FrameTree tree = fs::is_regular_file(file, ignored) ? load_frame_tree(file) : FrameTree();
  const Rigid3 T_body_optical(optical_from_body().conjugate(), Eigen::Vector3d::Zero());
  for (const RigCamera& camera : recording.rig.cameras) {
    const std::string optical = optical_frame_in_bag(camera);
    const std::string link = camera.link.empty() || camera.link == optical ? camera.name + "_link" : camera.link;
    if (!tree.has(optical)) tree.add(link, optical, camera.T_link_camera.value_or(T_body_optical));
    if (camera.depth && camera.depth->own_camera && !tree.has(depth_frame_in_bag(camera)))
      tree.add(optical, depth_frame_in_bag(camera), camera.depth->own_camera->T_color_depth);
  }
  return tree;
}

}  // namespace rigproof
