#include <algorithm>

#include "page_parts.h"
#include "rigproof/calib/vision/ground_plane.h"
#include "rigproof/calib/vision/image_io.h"

namespace rigproof::page_detail {
namespace {

constexpr int kColumns = 64, kPointsPerCell = 12;

// Of a depth image or a cloud; none where it cannot be read or has another size than its camera.
std::optional<DepthPoints> read_points(const Recording& recording, const CameraFrame& files, const RigCamera& camera,
                                       int most) {
  if (files.depth_file.empty()) {
    auto cloud = read_point_cloud(recording.folder / files.cloud_file);
    auto* points = std::get_if<std::vector<Eigen::Vector3f>>(&cloud);
    if (points == nullptr) return std::nullopt;
    return points_from_cloud(std::move(*points), *camera.depth, most);
  }
  const auto image = read_depth_image(recording.folder / files.depth_file);
  const auto* depth = std::get_if<Image16>(&image);
  const Camera& optics = camera.depth_optics();
  if (depth == nullptr || depth->width != optics.width_px || depth->height != optics.height_px) return std::nullopt;
  return sampled_depth(*depth, camera, most);
}

const CameraFrame* files_of(const Recording& recording, const PlaneObservation& plane) {
  if (static_cast<std::size_t>(plane.camera) >= recording.frames.size()) return nullptr;
  const auto& frames = recording.frames[static_cast<std::size_t>(plane.camera)];
  const auto found = std::find_if(frames.begin(), frames.end(), [&](const CameraFrame& frame) {
    return (frame.depth_file.empty() ? frame.cloud_file : frame.depth_file) == plane.file;
  });
  return found == frames.end() || plane.file.empty() ? nullptr : &*found;
}

const PlaneObservation* ground_of(const Observations& observations, const Frame& frame) {
  for (const PlaneObservation& plane : observations.ground_planes)
    if (plane.camera == frame.camera && plane.stop == frame.stop) return &plane;
  return nullptr;
}

}  // namespace

std::string ground_json(const InspectInput& input, const Frame& frame) {
  const PlaneObservation* plane = ground_of(input.observations, frame);
  const CameraFrame* files = plane != nullptr ? files_of(*input.input.recording, *plane) : nullptr;
  const RigCamera& camera = input.observations.cameras[static_cast<std::size_t>(frame.camera)];
  if (files == nullptr || !camera.depth) return "null";
  const int rows = std::max(1, kColumns * camera.camera.height_px / camera.camera.width_px);
  const auto points = read_points(*input.input.recording, *files, camera, kColumns * rows * kPointsPerCell);
  if (!points) return "null";
  const std::vector<bool> on_plane = lie_on_plane(*points, camera.depth->noise, *plane);
  std::vector<int> balance(static_cast<std::size_t>(kColumns * rows), 0);
  std::string cells(balance.size(), '.');
  for (std::size_t i = 0; i < on_plane.size(); ++i) {
    Eigen::Vector2d pixel;
    if (!camera.camera.project(points->points[i].cast<double>(), &pixel) || !camera.camera.contains(pixel)) continue;
    const int column = static_cast<int>((pixel.x() + 0.5) * kColumns / camera.camera.width_px);
    const int row = static_cast<int>((pixel.y() + 0.5) * rows / camera.camera.height_px);
    const auto cell = static_cast<std::size_t>(std::min(row, rows - 1) * kColumns + std::min(column, kColumns - 1));
    balance[cell] += on_plane[i] ? 1 : -1;
    cells[cell] = balance[cell] > 0 ? 'g' : 'o';
  }
  return "[" + std::to_string(kColumns) + ",\"" + cells + "\"]";
}

}  // namespace rigproof::page_detail
