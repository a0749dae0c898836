#include "depth_of_bag.h"

#include <algorithm>
#include <limits>

#include "rigproof/core/camera_info.h"
#include "rigproof/core/error.h"
#include "ros_pictures.h"
#include "topic_names.h"

namespace rigproof {
namespace {

constexpr double kNearest_s = 0.02;  // as far as frames of one stop may be apart

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

std::optional<Camera> camera_of_depth(const BagSurvey& survey, const ImageTopic& depth) {
  const InfoTopic* info = survey.find_info(namespace_of(depth.name) + "/camera_info");
  if (info == nullptr) return std::nullopt;
  try {
    const InfoReading reading = camera_of_info(info->info, is_rectified(depth.name));
    const Camera& camera = reading.camera;
    if (!reading.to_undo.empty()) return std::nullopt;
    return depth.width == 0 || (camera.width_px == depth.width && camera.height_px == depth.height)
               ? std::optional<Camera>(camera)
               : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::optional<DepthStream> stream_of_cloud(const BagSurvey& survey, const ImageTopic& cloud, const ImageTopic& images,
                                           std::vector<std::string>* notes) {
  if (survey.tf_static.between(images.frame_id(), cloud.frame_id())) {
    notes->push_back("the points of " + cloud.name + " are taken in place of depth images");
    return DepthStream();
  }
  notes->push_back(cloud.name + " is left out: /tf_static does not join its frame " + cloud.frame_id() + " with " +
                   images.frame_id() + " of the images");
  return std::nullopt;
}

}  // namespace

std::optional<DepthStream> depth_of_topic(const BagSurvey& survey, const ImageTopic& depth, const ImageTopic& images,
                                          const Camera& camera, std::vector<std::string>* notes) {
  DepthStream stream;
  if (depth.is_cloud()) return stream_of_cloud(survey, depth, images, notes);
  stream.unit_m = depth.unit_m.value_or(depth_unit_m(depth.encoding));
  const bool same_frame = depth.frame_id() == images.frame_id();
  const bool same_size = depth.width == camera.width_px && depth.height == camera.height_px;
  if (same_frame && same_size) return stream;
  const std::optional<Rigid3> T_color_depth = survey.tf_static.between(images.frame_id(), depth.frame_id());
  const std::optional<Camera> own = camera_of_depth(survey, depth);
  if (own && T_color_depth) {
    stream.own_camera = DepthStream::OwnCamera{*own, *T_color_depth};
    notes->push_back(depth.name + " is not registered to colour (" + size_text(depth.width, depth.height) + ", frame " +
                     depth.frame_id() + "): rig.yaml has the depth camera's intrinsics and its pose of /tf_static");
    return stream;
  }
  notes->push_back(depth.name + " is left out: " + size_text(depth.width, depth.height) + " in frame " +
                   depth.frame_id() + ", not registered to " + images.name + " (" +
                   size_text(camera.width_px, camera.height_px) + ", frame " + images.frame_id() + "), and " +
                   (own ? "/tf_static does not join the frames"
                        : "it has no CameraInfo of its size, or a lens that no model of ours follows") +
                   "; record the aligned topic (RealSense: align_depth.enable:=true)");
  return std::nullopt;
}

DepthPairs pair_depth(const std::vector<StampedPlace>& images, const std::vector<StampedPlace>& depth) {
  DepthPairs pairs;
  pairs.least_gap_s = std::numeric_limits<double>::infinity();
  std::size_t at = 0;
  const auto gap_s = [&](std::size_t image, std::size_t i) {
    return 1e-9 * static_cast<double>(std::abs(depth[i].stamp_ns - images[image].stamp_ns));
  };
  for (std::size_t image = 0; image < images.size(); ++image) {
    while (at + 1 < depth.size() && gap_s(image, at + 1) <= gap_s(image, at)) ++at;
    const double gap = gap_s(image, at);
    pairs.least_gap_s = std::min(pairs.least_gap_s, gap);
    pairs.nearest.push_back(gap <= kNearest_s ? std::optional<std::size_t>(at) : std::nullopt);
    if (gap <= kNearest_s) pairs.largest_gap_s = std::max(pairs.largest_gap_s, gap);
  }
  return pairs;
}

}  // namespace rigproof
