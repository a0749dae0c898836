#include "reference_planes.h"

#include <algorithm>

#include "rigproof/calib/vision/ground_plane.h"
#include "rigproof/calib/vision/image_findings.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/recall.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"

namespace rigproof::rivals {
namespace {

// Of a depth image: as `convert` gives it to the program.
constexpr int kCloudPoints = 12000;

std::vector<Eigen::Vector3f> read_cloud(const Recording& recording, const CameraFrame& frame, const RigCamera& camera) {
  if (!frame.cloud_file.empty()) {
    auto cloud = read_point_cloud(path_inside(recording.folder, frame.cloud_file));
    if (auto* points = std::get_if<std::vector<Eigen::Vector3f>>(&cloud)) return std::move(*points);
    return {};
  }
  if (frame.depth_file.empty() || !camera.depth) return {};
  const auto depth = read_depth_image(path_inside(recording.folder, frame.depth_file));
  const auto* image = std::get_if<Image16>(&depth);
  return image == nullptr ? std::vector<Eigen::Vector3f>() : sampled_depth(*image, camera, kCloudPoints).points;
}

std::vector<Eigen::Vector3f> cloud_of(const Recording& recording, const CameraFrame& frame, const RigCamera& camera) {
  try {
    return read_cloud(recording, frame, camera);
  } catch (const Error& failure) {
    if (failure.exit_code() == ExitCode::kTryAgain) throw;
    return {};
  }
}

}  // namespace

bool has_clouds(const Observations& observations, const Recording& recording) {
  for (std::size_t k = 0; k < std::min(observations.cameras.size(), recording.frames.size()); ++k)
    for (const CameraFrame& frame : recording.frames[k])
      if (!frame.cloud_file.empty() || (!frame.depth_file.empty() && observations.cameras[k].depth)) return true;
  return false;
}

std::optional<CloudPlane> CloudPlanes::at(int stop, int k) const {
  throw_if_interrupted(input_);
  const CameraFrame* frame = frame_of(frames_, stop, k);
  if (frame == nullptr) return std::nullopt;
  const RigCamera& camera = input_.observations.cameras[static_cast<std::size_t>(k)];
  const std::string content =
      detection::content_of(input_.memory, frame->cloud_file.empty() ? frame->depth_file : frame->cloud_file);
  const std::string key = content.empty() ? content : cloud_key(content, camera, kCloudPoints);
  std::optional<CloudPlane> plane;
  detection::recall_or(input_.memory, PictureMemory::Finding::kClouds, key, &plane, [&] {
    const std::vector<Eigen::Vector3f> cloud = cloud_of(*input_.recording, *frame, camera);
    plane = largest_plane(cloud);
    return !cloud.empty();
  });
  return plane;
}

std::optional<CloudPlane> ObservedPlanes::at(int stop, int camera) const {
  for (const PlaneObservation& plane : planes_) {
    if (plane.stop != stop || plane.camera != camera) continue;
    const double size = plane.inverse_depth_plane.norm();
    return CloudPlane{-plane.inverse_depth_plane / size, 1.0 / size};
  }
  return std::nullopt;
}

}  // namespace rigproof::rivals
