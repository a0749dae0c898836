#include "exposures.h"

#include <algorithm>
#include <cmath>

#include "rigproof/generator/sensor_device.h"

namespace rigproof {
namespace {

// Between two pictures of an exposure nothing moves by more than this, where the configuration allows as many.
constexpr double kStep_px = 0.5;
// Rays on which the motion in the image is measured, and times between which it is taken for straight.
constexpr int kColumns = 8, kRows = 6, kTimes = 4;

CameraShutter shutter_of(const GenerateConfig& config, const RigCamera& camera, std::int32_t index) {
  const SensorDevice device = load_sensor_device(camera.sensor);
  RandomStream random(static_cast<std::uint64_t>(config.seed), "shutter", -1, index);
  const double exposure_ms = config.render.exposure_ms.sample(random),
               readout_ms = config.render.readout_ms.sample(random);
  CameraShutter shutter;
  shutter.exposure_s = (exposure_ms > 0.0 ? exposure_ms : device.color.exposure_ms) / 1000.0;
  shutter.readout_s = (readout_ms > 0.0 ? readout_ms : device.color.readout_ms) / 1000.0;
  shutter.depth_readout_s = device.depth.readout_ms / 1000.0;
  shutter.gamma = device.color.gamma;
  if (!config.render.rolling_shutter) shutter.readout_s = shutter.depth_readout_s = 0.0;
  return shutter;
}

double blur_s(const Scenario& scenario, const CameraShutter& shutter) {
  return scenario.config.render.motion_blur ? shutter.exposure_s : 0.0;
}

// Points that the camera sees, in the scene's frame. The sky turns with the camera as the far plane does.
std::vector<Eigen::Vector3d> seen_points(const World& world, const Camera& camera, const Rigid3& T_scene_camera) {
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Eigen::Vector2d pixel(camera.width_px * (column + 0.5) / kColumns - 0.5,
                                  camera.height_px * (row + 0.5) / kRows - 0.5);
      Eigen::Vector3d ray;
      if (!camera.unproject(pixel, &ray)) continue;
      const Eigen::Vector3d direction = T_scene_camera.rotation * ray.normalized();
      const double far = world.description().scene.far_m;
      const double distance = std::min(far, world.cast_ray(T_scene_camera.translation, direction));
      points.emplace_back(T_scene_camera.translation + distance * direction);
    }
  }
  return points;
}

// Longest way of a point through the image while the robot goes through these poses [px].
double motion_px(const Camera& camera, const std::vector<Rigid3>& T_camera_scene,
                 const std::vector<Eigen::Vector3d>& points) {
  double longest = 0.0;
  for (const Eigen::Vector3d& point : points) {
    double way = 0.0;
    Eigen::Vector2d before = Eigen::Vector2d::Zero(), now = before;
    bool was_seen = false;
    for (const Rigid3& T : T_camera_scene) {
      const bool is_seen = camera.project(T * point, &now);
      if (is_seen && was_seen) way += (now - before).norm();
      before = now;
      was_seen = is_seen;
    }
    longest = std::max(longest, way);
  }
  return longest;
}

double motion_px(const Scenario& scenario, const FrameJob& job, const Camera& camera, const Rigid3& T_robot_camera,
                 double duration_s) {
  if (!(duration_s > 0.0)) return 0.0;
  const double middle_s = scenario.truth_of(job).stamp_s;
  std::vector<Rigid3> T_camera_scene;
  for (int i = 0; i <= kTimes; ++i) {
    const double stamp_s = middle_s + duration_s * (static_cast<double>(i) / kTimes - 0.5);
    T_camera_scene.push_back((scenario.trajectory.at(stamp_s) * T_robot_camera).inverse());
  }
  const Rigid3 T_scene_camera = scenario.trajectory.at(middle_s) * T_robot_camera;
  return motion_px(camera, T_camera_scene, seen_points(*scenario.world, camera, T_scene_camera));
}

int parts_of(double motion, std::int64_t most) {
  return static_cast<int>(std::clamp(std::ceil(motion / kStep_px), 1.0, static_cast<double>(most)));
}

Exposure exposure_of(const Scenario& scenario, const FrameJob& job, int parts, double exposure_s, double readout_s) {
  Exposure exposure;
  exposure.exposure_s = exposure_s;
  exposure.readout_s = readout_s;
  const double middle_s = scenario.truth_of(job).stamp_s;
  if (parts > 1)
    exposure.T_world_robot = scenario.trajectory.during(middle_s, exposure_s + readout_s, parts);
  else if (scenario.truth.cameras[job.camera].stops.empty())
    exposure.T_world_robot = {scenario.T_scene_robot[job.stop]};
  else
    exposure.T_world_robot = {scenario.trajectory.at(middle_s)};
  return exposure;
}

}  // namespace

std::vector<CameraShutter> resolve_shutters(const GenerateConfig& config, const Rig& rig) {
  std::vector<CameraShutter> shutters;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i)
    shutters.push_back(shutter_of(config, rig.cameras[i], static_cast<std::int32_t>(i)));
  return shutters;
}

void plan_exposures(Scenario* scenario) {
  const GenerateConfig& config = scenario->config;
  if (!config.moves_while_exposing()) return;
  const std::vector<RigCamera>& cameras = scenario->rig.rig.cameras;
  std::vector<double> step_px(cameras.size(), 0.0);
  std::vector<int> parts(cameras.size(), 1);
  for (FrameJob& job : scenario->frames) {
    const CameraShutter& shutter = scenario->shutters[job.camera];
    const Rigid3& T_robot_camera = scenario->rig.T_robot_camera[job.camera];
    const RigCamera& camera = cameras[job.camera];
    const double way =
        motion_px(*scenario, job, camera.camera, T_robot_camera, blur_s(*scenario, shutter) + shutter.readout_s);
    job.color_parts = parts_of(way, config.render.max_parts);
    step_px[job.camera] = std::max(step_px[job.camera], way / job.color_parts);
    parts[job.camera] = std::max(parts[job.camera], job.color_parts);
    if (!camera.depth) continue;
    const auto& own = camera.depth->own_camera;
    const double depth_way =
        motion_px(*scenario, job, own ? own->camera : camera.camera,
                  own ? T_robot_camera * own->T_color_depth : T_robot_camera, shutter.depth_readout_s);
    job.depth_parts = parts_of(depth_way, config.render.max_parts);
  }
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const CameraShutter& shutter = scenario->shutters[i];
    std::map<std::string, double>& labels = scenario->truth.cameras[i].sensing;
    if (config.render.motion_blur) labels["motion_blur_ms"] = 1000.0 * shutter.exposure_s;
    if (shutter.readout_s > 0.0) labels["readout_ms"] = 1000.0 * shutter.readout_s;
    if (cameras[i].depth && shutter.depth_readout_s > 0.0)
      labels["depth_readout_ms"] = 1000.0 * shutter.depth_readout_s;
    if (parts[i] == 1) continue;
    labels["exposure_parts"] = parts[i];
    labels["exposure_step_px"] = step_px[i];
  }
}

std::size_t pictures_of(const Scenario& scenario, const FrameJob& job) {
  const auto color = static_cast<std::size_t>(job.color_parts), depth = static_cast<std::size_t>(job.depth_parts);
  const std::optional<DepthStream>& stream = scenario.rig.rig.cameras[job.camera].depth;
  if (!stream) return color;
  return color + depth == 2 && !stream->own_camera ? 1 : color + depth;
}

Exposure color_exposure(const Scenario& scenario, const FrameJob& job) {
  const CameraShutter& shutter = scenario.shutters[job.camera];
  Exposure exposure = exposure_of(scenario, job, job.color_parts, blur_s(scenario, shutter), shutter.readout_s);
  exposure.gamma = shutter.gamma;
  return exposure;
}

Exposure depth_exposure(const Scenario& scenario, const FrameJob& job) {
  return exposure_of(scenario, job, job.depth_parts, 0.0, scenario.shutters[job.camera].depth_readout_s);
}

}  // namespace rigproof
