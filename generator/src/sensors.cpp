#include "rigproof/generator/sensors.h"

#include <cmath>

#include "rigproof/core/error.h"
#include "sensing/depth_noise.h"
#include "sensing/image_chain.h"

namespace rigproof {

struct Sensor::Prepared {
  std::optional<LevelNoise> level_noise;
  std::optional<ImageChain> chain;
  ImageF depth;  ///< scratch
};

double DepthSensing::recorded_sigma_m(double z_m) const {
  const double uniform = 1.0 / std::sqrt(12.0);  // standard deviation of rounding to steps of 1
  const double law_m = noise ? stream.noise.sigma_m(z_m) : 0.0;
  const double step_m = is_stereo() ? z_m * z_m / focal_baseline_px_m * disparity_step_px : 0.0;
  return std::sqrt(law_m * law_m + std::pow(uniform * step_m, 2) + std::pow(uniform * stream.unit_m, 2));
}

DepthSensing depth_sensing_of(const SensorDevice& device) {
  const SensorPreset& preset = device.preset;
  if (!preset.depth) throw Error("sensor " + preset.name + " has no depth");
  DepthSensing depth;
  depth.stream = *preset.depth;
  depth.focal_px = preset.camera.fx_px;
  if (preset.stereo) depth.focal_baseline_px_m = preset.stereo->focal_px * preset.stereo->baseline_m;
  depth.disparity_step_px = device.depth.disparity_step_px;
  return depth;
}

void add_effects(const EffectList<ImageEffect>& effects, DeviceDraws* draws, ImageSensing* image) {
  image->effects = effects.resolved(draws);
}

void add_effects(const EffectList<DepthEffect>& effects, bool outdoors, DeviceDraws* draws, DepthSensing* depth) {
  depth->effects = effects.resolved(DepthDevice{*depth, outdoors}, draws);
  depth->effects.sort([](const DepthEffect& a, const DepthEffect& b) { return a.place() < b.place(); });
}

Labels SensorModel::labels() const {
  Labels labels;
  if (image) image->effects.label(&labels);
  if (depth) depth->effects.label(&labels);
  if (image && image->noise) {
    labels["image_noise"] = 1.0;
    labels["full_well_electrons"] = image->full_well_electrons;
    labels["read_noise_electrons"] = image->read_noise_electrons;
    labels["image_gamma"] = image->gamma;
  }
  if (depth && depth->noise) labels["depth_noise"] = 1.0;
  if (depth && depth->is_stereo() && depth->disparity_step_px > 0.0)
    labels["disparity_step_px"] = depth->disparity_step_px;
  return labels;
}

Sensor::Sensor(const SensorModel& model, int width, int height, const FrameSeed& device)
    : model_(model), prepared_(std::make_unique<Prepared>()) {
  const FrameSeed fixed{device.seed, -1, device.camera};
  if (model_.image && model_.image->is_noise_alone()) prepared_->level_noise.emplace(*model_.image);
  if (model_.image && !prepared_->level_noise) {
    model_.image->effects.prepare(width, height, fixed);
    prepared_->chain.emplace(*model_.image);
  }
  if (!model_.depth) return;
  const auto& own = model_.depth->stream.own_camera;
  model_.depth->effects.prepare(own ? own->camera.width_px : width, own ? own->camera.height_px : height, fixed);
}

Sensor::~Sensor() = default;
Sensor::Sensor(Sensor&&) noexcept = default;

void Sensor::sense_color(const FrameSeed& frame, Image8* image) const {
  if (prepared_->level_noise) prepared_->level_noise->apply(frame.stream("image noise"), image);
  if (prepared_->chain) prepared_->chain->apply(*model_.image, frame, image);
}

const ImageF& Sensor::seen_depth(const ImageF& depth_m, const Image8& clean_color, const FrameSeed& frame) const {
  const ImageF* seen = &depth_m;
  for (const auto& effect : model_.depth->effects) {
    if (!effect->changes_scene()) continue;
    if (seen == &depth_m) prepared_->depth = depth_m;
    seen = &prepared_->depth;
    effect->change_scene({depth_m, clean_color, frame}, &prepared_->depth);
  }
  return *seen;
}

void Sensor::sense_depth(const ImageF& depth_m, const Image8& clean_color, double unit_m, const FrameSeed& frame,
                         Image16* counts) const {
  if (counts->width != depth_m.width || counts->height != depth_m.height)
    *counts = Image16(depth_m.width, depth_m.height);
  if (!model_.depth) return round_depth(depth_m, unit_m, model_.depth_scale, counts);
  measure_depth(seen_depth(depth_m, clean_color, frame), *model_.depth, model_.depth_scale, frame, counts);
  for (const auto& effect : model_.depth->effects) effect->change_counts(frame, counts);
}

}  // namespace rigproof
