#include "horizon_directions.h"

#include <Eigen/Geometry>

#include "rigproof/calib/vision/image_files.h"
#include "rigproof/calib/vision/image_pairs.h"
#include "rigproof/calib/vision/straight_drive.h"

namespace rigproof::rivals {
namespace {

using Eigen::Vector3d;

/// An image to look at and what was seen there, in the camera's frame.
struct Look {
  int camera = 0;
  const CameraFrame* frame = nullptr;
  bool drives_ahead = false;
  double sense = 1.0;  ///< -1 where the robot drives backwards
  std::optional<Vector3d> ahead, up;
};

std::vector<Look> images_to_look_at(const MethodInput& input) {
  std::vector<Look> looks;
  const int stops = static_cast<int>(input.observations.stops.size());
  for (const auto& [key, frame] : frames_by_stop(input.observations, *input.recording)) {
    const auto& [stop, camera] = key;
    const Step step = stop + 1 < stops ? step_between(input.observations, stop, stop + 1) : Step();
    looks.push_back({camera, frame, step.straight(), step.forward_m < 0.0 ? -1.0 : 1.0, {}, {}});
  }
  for (const auto& [camera, frame] : straight_segment_images(*input.recording))
    looks.push_back({camera, frame, true, 1.0, {}, {}});
  return looks;
}

std::optional<Vector3d> ray_of(const Camera& camera, const Eigen::Vector2d& pixel) {
  Vector3d ray;
  if (!camera.unproject(pixel, &ray)) return std::nullopt;
  return ray.normalized();
}

// The plane of the horizon's rays is level; its normal points up, for the left place comes first.
std::optional<Vector3d> vertical_of(const Camera& camera, const HorizonSight& sight) {
  if (!sight.horizon_px) return std::nullopt;
  const auto left = ray_of(camera, (*sight.horizon_px)[0]), right = ray_of(camera, (*sight.horizon_px)[1]);
  if (!left || !right) return std::nullopt;
  const Vector3d normal = right->cross(*left);
  if (!(normal.norm() > 1e-6)) return std::nullopt;
  return normal.normalized();
}

void look_at(const MethodInput& input, const HorizonSource& source, Look* look) {
  const Camera& camera = input.observations.cameras[static_cast<std::size_t>(look->camera)].camera;
  const std::optional<Image8> image = readable_image(*input.recording, *look->frame, camera);
  if (!image) return;
  const HorizonSight sight = source.look(*image);
  look->up = vertical_of(camera, sight);
  const auto ray = sight.ahead_px && look->drives_ahead ? ray_of(camera, *sight.ahead_px) : std::nullopt;
  if (ray) look->ahead = look->sense * *ray;
}

}  // namespace

HorizonDirections directions_from_horizons(const MethodInput& input, const HorizonSource& source) {
  HorizonDirections result;
  result.ahead.resize(input.observations.cameras.size());
  result.up.resize(input.observations.cameras.size());
  if (input.recording == nullptr) return result;
  std::vector<Look> looks = images_to_look_at(input);
  for_each_image(input, looks.size(), [&](std::size_t i) { look_at(input, source, &looks[i]); });
  for (const Look& look : looks) {
    const auto camera = static_cast<std::size_t>(look.camera);
    if (look.ahead) result.ahead[camera].add(*look.ahead, 1.0);
    if (look.up) result.up[camera].add(*look.up, 1.0);
  }
  return result;
}

}  // namespace rigproof::rivals
