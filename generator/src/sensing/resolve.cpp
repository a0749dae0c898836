#include "resolve.h"

namespace rigproof {
namespace {

ImageSensing resolve_image(const ImageSensingConfig& config, const ImageDevice& device, DeviceDraws* draws) {
  ImageSensing image;
  image.full_well_electrons = device.full_well_electrons;
  image.read_noise_electrons = device.read_noise_electrons;
  image.gamma = device.gamma;
  image.noise = config.noise;
  add_effects(device.effects, draws, &image);
  return image;
}

DepthSensing resolve_depth(const DepthSensingConfig& config, const SensorDevice& device, const RigCamera& camera,
                           bool outdoors, DeviceDraws* draws) {
  DepthSensing depth;
  if (device.preset.depth) depth = depth_sensing_of(device);
  depth.stream = *camera.depth;  // the rig may refine it
  depth.noise = config.noise;
  depth.focal_px = camera.depth_optics().fx_px;
  depth.patch_px = device.depth.patch_px;
  if (!config.disparity_steps) depth.disparity_step_px = 0.0;
  add_effects(device.depth.effects, outdoors, draws, &depth);
  return depth;
}

}  // namespace

void ImageSensingConfig::visit(FieldVisitor& visitor) {
  visitor.field("noise", noise, "shot and read noise, in linear light");
  effects.visit_switches(visitor);
  visitor.field("jpeg_quality", jpeg_quality, {0.0, 100.0},
                "images are stored as JPEG of this quality, 1 to 100; 0 = as PNG, without loss");
}

void DepthSensingConfig::visit(FieldVisitor& visitor) {
  visitor.field("noise", noise, "random noise by the sensor's law, correlated between neighbours");
  visitor.field("disparity_steps", disparity_steps, "stereo: disparity is rounded to the preset's steps");
  effects.visit_switches(visitor);
}

void SensingConfig::visit(FieldVisitor& visitor) {
  visitor.field("seed", seed, {-1.0, 9007199254740992.0},
                "of noise, devices and odometry; -1 = the run's seed, which also draws the world and the drive");
  visitor.field("told", told, TextChoices{{"drawn", "exact"}},
                "what the recording tells of lenses, the squares' side and depth scales: drawn, as calibrations and "
                "rulers leave it, around what is true; or exact, but for errors that other fields ask for");
  visitor.nested("image", image, "colour images");
  visitor.nested("depth", depth, "depth images");
  visitor.nested("lens", lens, "what the user is told of the lens against what is true");
  visitor.nested("time", time, "stamps");
}

std::uint64_t sensing_seed(const GenerateConfig& config) {
  return static_cast<std::uint64_t>(config.sensing.seed < 0 ? config.seed : config.sensing.seed);
}

std::vector<SensorModel> resolve_sensors(const GenerateConfig& config, const Rig& rig, bool outdoors) {
  std::vector<SensorModel> models(rig.cameras.size());
  for (std::size_t i = 0; i < models.size(); ++i) {
    const RigCamera& camera = rig.cameras[i];
    DeviceDraws draws({sensing_seed(config), -1, static_cast<std::int32_t>(i)});
    models[i].depth_scale = depth_scale_of(config, rig, static_cast<int>(i), &draws);
    if (config.sensor_noise == "none") continue;
    const SensorDevice device = load_sensor_device(camera.sensor, config.sensing);
    models[i].image = resolve_image(config.sensing.image, device.color, &draws);
    if (camera.depth) models[i].depth = resolve_depth(config.sensing.depth, device, camera, outdoors, &draws);
  }
  return models;
}

void tell_depth_bias(const SensorModel& model, RigCamera* camera) {
  if (!camera->depth) return;
  DepthNoise& told = camera->depth->noise;
  told.bias_inverse_depth_per_m = told.bias_m = 0.0;
  if (!model.depth) return;
  for (const auto& effect : model.depth->effects) effect->tell(&told);
}

}  // namespace rigproof
