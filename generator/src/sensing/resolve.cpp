#include "resolve.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/rig_yaml.h"

namespace rigproof {
namespace {

// Stamps of one sensor stay at least this far apart.
constexpr double kLeastStepS = 1e-6;

SensorPreset preset_of(const RigCamera& camera) {
  return camera.sensor.empty() ? SensorPreset() : load_sensor_preset(camera.sensor);
}

ImageSensing resolve_image(const ImageSensingConfig& config, const ImageSimulation& device, RandomStream random) {
  ImageSensing image;
  image.full_well_electrons = device.full_well_electrons;
  image.read_noise_electrons = device.read_noise_electrons;
  image.gamma = device.gamma;
  image.noise = config.noise;
  image.exposure = config.exposure.sample(random);
  image.defocus_sigma_px = config.defocus_sigma_px.sample(random);
  image.exposure_jitter = config.exposure_jitter_percent / 100.0;
  if (config.vignetting) image.corner_light = device.corner_light_percent / 100.0;
  if (!config.pixel_pattern) return image;
  image.dark_offset_electrons = device.dark_offset_electrons;
  image.pixel_gain = device.pixel_gain_percent / 100.0;
  return image;
}

int drawn_pixels(const Distribution& distribution, RandomStream* random) {
  return static_cast<int>(std::lround(distribution.sample(*random)));
}

// What takes depth away or moves it.
void add_scene_effects(const DepthSensingConfig& config, const DepthSimulation& device, bool outdoors,
                       RandomStream random, DepthSensing* depth) {
  const bool stereo = depth->stream.noise.law == DepthNoise::Law::kStereo;
  depth->shift_x_px = drawn_pixels(config.misregistration_px, &random);
  depth->shift_y_px = drawn_pixels(config.misregistration_px, &random);
  if (config.occlusion) {
    depth->imagers_x_m = device.imagers_x_m;
    // They are told beside the colour camera, and wanted beside the depth image's own place.
    if (const auto& own = depth->stream.own_camera)
      for (double& x_m : depth->imagers_x_m) x_m -= own->T_color_depth.translation.x();
  }
  if (config.edges) {
    depth->edge_step_per_m = device.edge_step_per_m;
    depth->edge_jitter_px = device.edge_jitter_px;
    depth->flying_share = device.flying_share;
  }
  if (config.texture_holes && stereo) {
    depth->min_contrast_levels = device.min_contrast_levels;
    depth->projector_reach_m = outdoors ? device.projector_reach_outdoors_m : device.projector_reach_m;
  }
  depth->patch_px = device.patch_px;
  if (!config.daylight || !outdoors) return;
  depth->valid_share = device.outdoor_valid_share;
  depth->stream.max_m = std::min(depth->stream.max_m, std::max(device.outdoor_max_m, depth->stream.min_m));
}

DepthSensing resolve_depth(const DepthSensingConfig& config, const SensorPreset& preset, const RigCamera& camera,
                           bool outdoors, RandomStream random) {
  const DepthSimulation& device = preset.simulation.depth;
  DepthSensing depth;
  if (preset.depth) depth = depth_sensing_of(preset);
  depth.stream = *camera.depth;  // the rig may refine it
  depth.noise = config.noise;
  const Camera& optics = camera.depth->own_camera ? camera.depth->own_camera->camera : camera.camera;
  depth.focal_px = optics.fx_px;
  depth.bias_cell_px = std::max(8.0, optics.fx_px * std::tan(deg_to_rad(device.bias_cell_deg)));
  if (!config.disparity_steps) depth.disparity_step_px = 0.0;
  const bool stereo = depth.stream.noise.law == DepthNoise::Law::kStereo;
  if (config.bias_field) depth.bias = stereo ? device.bias_px : device.bias_m;
  if (config.coarse_noise) {
    depth.patchy_share = device.patchy_share;
    depth.ripple_share = device.ripple_share;
    depth.ripple_px = device.ripple_px;
  }
  add_scene_effects(config, device, outdoors, random, &depth);
  return depth;
}

// Moves stamps apart where a disturbance has put them out of order.
template <typename Items>
void keep_in_order(Items* items) {
  for (std::size_t i = 1; i < items->size(); ++i)
    (*items)[i].stamp_s = std::max((*items)[i].stamp_s, (*items)[i - 1].stamp_s + kLeastStepS);
}

void disturb_frames(const TimeSensingConfig& config, std::uint64_t seed, std::int32_t camera,
                    std::vector<CameraFrame>* frames, TrueCamera* truth) {
  RandomStream random(seed, "camera clock", -1, camera);
  const double offset_s = config.clock_offset_ms.sample(random) / 1000.0;
  const double delay_s = config.camera_delay_ms.sample(random) / 1000.0;
  std::vector<CameraFrame> kept;
  for (std::size_t i = 0; i < frames->size(); ++i) {
    CameraFrame frame = (*frames)[i];
    RandomStream draw(seed, "frame clock", static_cast<std::int64_t>(i), camera);
    const bool dropped = 100.0 * draw.uniform() < config.dropped_percent;
    frame.stamp_s += offset_s + delay_s + draw.normal() * config.stamp_jitter_ms / 1000.0;
    const bool last_hope = kept.empty() && i + 1 == frames->size();
    if (!dropped || last_hope) kept.push_back(frame);
  }
  keep_in_order(&kept);
  const auto add = [truth](const char* name, double value) {
    if (value != 0.0) truth->sensing[name] = value;
  };
  add("clock_offset_s", offset_s);
  add("camera_delay_s", delay_s);
  add("stamp_jitter_s", config.stamp_jitter_ms / 1000.0);
  add("dropped_frames", static_cast<double>(frames->size() - kept.size()));
  *frames = std::move(kept);
}

}  // namespace

std::uint64_t sensing_seed(const GenerateConfig& config) {
  return static_cast<std::uint64_t>(config.sensing.seed < 0 ? config.seed : config.sensing.seed);
}

std::vector<SensorModel> resolve_sensors(const GenerateConfig& config, const Rig& rig, bool outdoors) {
  const std::uint64_t seed = sensing_seed(config);
  std::vector<SensorModel> models(rig.cameras.size());
  for (std::size_t i = 0; i < models.size(); ++i) {
    const RigCamera& camera = rig.cameras[i];
    const auto stream = [&](const char* purpose) {
      return RandomStream(seed, purpose, -1, static_cast<std::int32_t>(i));
    };
    RandomStream scale = stream("depth scale");
    models[i].depth_scale = 1.0 + config.depth_scale_bias_percent.sample(scale) / 100.0;
    if (config.sensor_noise == "none") continue;
    const SensorPreset preset = preset_of(camera);
    models[i].image = resolve_image(config.sensing.image, preset.simulation.color, stream("exposure"));
    if (camera.depth)
      models[i].depth = resolve_depth(config.sensing.depth, preset, camera, outdoors, stream("depth device"));
  }
  return models;
}

Camera told_camera(const Camera& camera, const LensSensingConfig& config, std::uint64_t seed, std::int32_t index) {
  RandomStream random(seed, "lens", -1, index);
  Camera told = camera;
  const double focal = 1.0 + config.focal_error_percent.sample(random) / 100.0;
  told.fx_px *= focal;
  told.fy_px *= focal;
  told.cx_px += config.centre_error_px.sample(random);
  told.cy_px += config.centre_error_px.sample(random);
  for (double& coefficient : told.distortion)
    coefficient *= 1.0 + config.distortion_error_percent.sample(random) / 100.0;
  return told;
}

void tell_depth_bias(const SensorModel& model, RigCamera* camera) {
  if (!camera->depth) return;
  DepthNoise& told = camera->depth->noise;
  told.bias_inverse_depth_per_m = told.bias_m = 0.0;
  if (!model.depth || model.depth->bias <= 0.0) return;
  if (told.law == DepthNoise::Law::kStereo)
    told.bias_inverse_depth_per_m = model.depth->bias / model.depth->focal_baseline_px_m;
  else
    told.bias_m = model.depth->bias;
  told.bias_cell_deg = rad_to_deg(std::atan(model.depth->bias_cell_px / model.depth->focal_px));
}

std::vector<double> rendered_delays_s(const GenerateConfig& config, std::size_t cameras) {
  std::vector<double> delays_s(cameras, 0.0);
  if (!config.moves_while_exposing()) return delays_s;
  for (std::size_t i = 0; i < cameras; ++i) {
    RandomStream random(static_cast<std::uint64_t>(config.seed), "camera delay", -1, static_cast<std::int32_t>(i));
    delays_s[i] = config.sensing.time.camera_delay_ms.sample(random) / 1000.0;
  }
  return delays_s;
}

TimeSensingConfig sensed_time(const GenerateConfig& config) {
  TimeSensingConfig time = config.sensing.time;
  if (config.moves_while_exposing()) time.camera_delay_ms = 0.0;
  return time;
}

void disturb_time(const TimeSensingConfig& config, std::uint64_t seed, Recording* recording, Truth* truth) {
  for (std::size_t i = 0; i < recording->frames.size(); ++i)
    disturb_frames(config, seed, static_cast<std::int32_t>(i), &recording->frames[i], &truth->cameras[i]);
  disturb_odometry_time(config, seed, recording, truth);
}

void disturb_odometry_time(const TimeSensingConfig& config, std::uint64_t seed, Recording* recording, Truth* truth) {
  RandomStream random(seed, "odometry clock");
  const double delay_s = config.odometry_delay_ms.sample(random) / 1000.0;
  for (OdometrySample& sample : recording->odometry)
    sample.stamp_s += delay_s + random.normal() * config.odometry_jitter_ms / 1000.0;
  keep_in_order(&recording->odometry);
  if (delay_s != 0.0) truth->drawn["sensing.time.odometry_delay_ms"] = 1000.0 * delay_s;
}

}  // namespace rigproof
