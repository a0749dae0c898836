#include <algorithm>
#include <cmath>

#include "inspect_pictures.h"
#include "inspect_rig.h"
#include "rigproof/core/conventions.h"
#include "rigproof/study/workflow/workflow.h"
#include "rigproof/validate/body_angles.h"

namespace rigproof::inspect_detail {
namespace {

const Result* result_to_draw(const InspectInput& input) {
  const auto has_pose = [&](const Result& result) {
    return std::any_of(input.observations.cameras.begin(), input.observations.cameras.end(),
                       [&](const RigCamera& camera) { return pose_of_camera(result, camera.name) != nullptr; });
  };
  const std::optional<std::size_t> usual = find_result(input.results, "");
  if (usual && has_pose(input.results[*usual])) return &input.results[*usual];
  const auto first = std::find_if(input.results.begin(), input.results.end(), has_pose);
  return first == input.results.end() ? nullptr : &*first;
}

// How far the error moves a point of the camera's frustum.
double shift_by_error(const MountedCamera& camera, double length_m) {
  if (!camera.T_true || !camera.T_estimate) return 0.0;
  const Vector6d error = transform_error(*camera.T_estimate, *camera.T_true);
  return std::max(error.head<3>().norm(), length_m * error.tail<3>().norm());
}

// By an error, or two sigma of a place.
double largest_shift(const MountedRig& rig, double length_m) {
  double largest = 0.0;
  for (const MountedCamera& camera : rig.cameras) {
    largest = std::max(largest, shift_by_error(camera, length_m));
    if (camera.covariance)
      largest = std::max(largest, 2.0 * std::sqrt(std::max(0.0, camera.covariance->diagonal().head<3>().maxCoeff())));
  }
  return largest;
}

double visible_shift(double length_m) { return 0.27 * length_m; }

std::string in_degrees(double angle_rad) { return number(std::round(std::abs(rad_to_deg(angle_rad)))) + " deg "; }

}  // namespace

MountedRig mounted_rig(const InspectInput& input) {
  const Result* result = result_to_draw(input);
  MountedRig rig;
  if (result != nullptr) rig.method = result->method;
  for (std::size_t i = 0; i < input.observations.cameras.size(); ++i) {
    const std::string& name = input.observations.cameras[i].name;
    MountedCamera& camera = rig.cameras.emplace_back();
    camera.index = i;
    if (input.truth)
      if (const auto at = index_in_truth(*input.truth, name)) camera.T_true = input.truth->cameras[*at].T_robot_camera;
    const EstimatedTransform* estimate = result != nullptr ? pose_of_camera(*result, name) : nullptr;
    if (estimate == nullptr) continue;
    camera.T_estimate = estimate->T_parent_child;
    camera.covariance = estimate->covariance;
  }
  return rig;
}

double frustum_length(const MountedRig& rig) {
  Eigen::AlignedBox3d places;
  for (const MountedCamera& camera : rig.cameras)
    if (camera.is_known()) places.extend(camera.best().translation);
  return places.isEmpty() ? 0.3 : std::max(0.3, 0.15 * places.diagonal().norm());
}

double exaggeration(const MountedRig& rig) {
  constexpr double kMost = 1000.0;
  const double length_m = frustum_length(rig), largest = largest_shift(rig, length_m);
  if (!(largest > 0.0)) return 1.0;
  return round_step(std::clamp(visible_shift(length_m) / largest, 1.0, kMost));
}

bool is_striking(const MountedCamera& camera, double length_m) {
  return shift_by_error(camera, length_m) >= visible_shift(length_m);
}

Rigid3 exaggerated(const MountedCamera& camera, double factor) {
  if (!camera.T_true || !camera.T_estimate) return camera.best();
  return apply_transform_error(*camera.T_true, factor * transform_error(*camera.T_estimate, *camera.T_true));
}

std::string looks(const Rigid3& T_robot_camera) {
  const Eigen::Vector3d angles = camera_roll_pitch_yaw(T_robot_camera.rotation);
  const double down = angles.y(), yaw = angles.z();
  const std::string tilt = std::abs(rad_to_deg(down)) < 0.5 ? "level" : in_degrees(down) + (down > 0.0 ? "down" : "up");
  if (std::abs(rad_to_deg(down)) > 89.5) return "looks straight " + std::string(down > 0.0 ? "down" : "up");
  if (std::abs(rad_to_deg(yaw)) < 0.5) return "looks ahead, " + tilt;
  if (std::abs(rad_to_deg(yaw)) > 179.5) return "looks back, " + tilt;
  return "looks " + in_degrees(yaw) + (yaw > 0.0 ? "left, " : "right, ") + tilt;
}

std::string unusual_roll(const Rigid3& T_robot_camera) {
  constexpr double kSteepest_deg = 75.0;  // then a small turn of the camera changes its roll a lot
  const Eigen::Vector3d angles = camera_roll_pitch_yaw(T_robot_camera.rotation);
  if (std::abs(rad_to_deg(angles.y())) > kSteepest_deg) return "";
  const double roll_deg = std::abs(rad_to_deg(angles.x()));
  return roll_deg > 135.0 ? "upside down" : roll_deg > 45.0 ? "on its side" : "";
}

}  // namespace rigproof::inspect_detail
