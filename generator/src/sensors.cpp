#include "rigproof/generator/sensors.h"

#include <cmath>

#include "rigproof/core/error.h"
#include "sensing/depth_noise.h"
#include "sensing/depth_scene.h"
#include "sensing/image_chain.h"
#include "sensing/normals.h"

namespace rigproof {

struct Sensor::Prepared {
  std::optional<LevelNoise> level_noise;
  std::optional<ImageChain> chain;
  std::optional<SmoothField> bias;
  ImageF depth;  ///< scratch
};

double DepthSensing::recorded_sigma_m(double z_m) const {
  const double uniform = 1.0 / std::sqrt(12.0);  // standard deviation of rounding to steps of 1
  const double law_m = noise ? stream.noise.sigma_m(z_m) : 0.0;
  const bool stereo = stream.noise.law == DepthNoise::Law::kStereo;
  const double step_m = stereo ? z_m * z_m / focal_baseline_px_m * disparity_step_px : 0.0;
  return std::sqrt(law_m * law_m + std::pow(uniform * step_m, 2) + std::pow(uniform * stream.unit_m, 2));
}

DepthSensing depth_sensing_of(const SensorPreset& preset) {
  if (!preset.depth) throw Error("sensor " + preset.name + " has no depth");
  DepthSensing depth;
  depth.stream = *preset.depth;
  depth.focal_px = preset.camera.fx_px;
  if (preset.stereo) depth.focal_baseline_px_m = preset.stereo->focal_px * preset.stereo->baseline_m;
  depth.disparity_step_px = preset.simulation.depth.disparity_step_px;
  return depth;
}

bool ImageSensing::is_noise_alone() const {
  return noise && dark_offset_electrons <= 0.0 && pixel_gain <= 0.0 && corner_light >= 1.0 && exposure == 1.0 &&
         exposure_jitter <= 0.0 && defocus_sigma_px <= 0.0;
}

namespace {

double bias_over_noise(const DepthSensing& depth) {
  const DepthNoise& noise = depth.stream.noise;
  const bool stereo = noise.law == DepthNoise::Law::kStereo;
  const double sigma = stereo ? depth.focal_baseline_px_m * noise.inverse_depth_sigma_per_m : noise.sigma_m(1.0);
  return depth.bias / sigma;
}

}  // namespace

std::map<std::string, double> SensorModel::labels() const {
  std::map<std::string, double> labels;
  const auto add = [&labels](const char* name, double value, bool present) {
    if (present) labels[name] = value;
  };
  if (image) {
    add("image_noise", 1.0, image->noise);
    add("full_well_electrons", image->full_well_electrons, image->noise);
    add("read_noise_electrons", image->read_noise_electrons, image->noise);
    add("image_gamma", image->gamma, image->noise);
    add("pixel_offset_electrons", image->dark_offset_electrons, image->dark_offset_electrons > 0.0);
    add("pixel_gain_percent", 100.0 * image->pixel_gain, image->pixel_gain > 0.0);
    add("corner_light_percent", 100.0 * image->corner_light, image->corner_light < 1.0);
    add("exposure", image->exposure, image->exposure != 1.0);
    add("exposure_jitter_percent", 100.0 * image->exposure_jitter, image->exposure_jitter > 0.0);
    add("defocus_sigma_px", image->defocus_sigma_px, image->defocus_sigma_px > 0.0);
  }
  if (!depth) return labels;
  const bool stereo = depth->stream.noise.law == DepthNoise::Law::kStereo;
  add("depth_noise", 1.0, depth->noise);
  add("disparity_step_px", depth->disparity_step_px, stereo && depth->disparity_step_px > 0.0);
  add(stereo ? "depth_bias_sigma_px" : "depth_bias_sigma_m", depth->bias, depth->bias > 0.0);
  // At 1 m; in stereo it is the same everywhere.
  add("depth_bias_over_noise", bias_over_noise(*depth), depth->bias > 0.0);
  add("occlusion", 1.0, !depth->imagers_x_m.empty());
  add("edge_jitter_px", depth->edge_jitter_px, depth->edge_step_per_m > 0.0);
  add("flying_share", depth->flying_share, depth->edge_step_per_m > 0.0);
  add("min_contrast_levels", depth->min_contrast_levels, depth->min_contrast_levels > 0.0);
  add("depth_patchy_share", depth->patchy_share, depth->noise && depth->patchy_share > 0.0);
  add("depth_ripple_share", depth->ripple_share, depth->noise && depth->ripple_share > 0.0);
  add("depth_valid_share", depth->valid_share, depth->valid_share < 1.0);
  add("depth_shift_x_px", depth->shift_x_px, depth->shift_x_px != 0);
  add("depth_shift_y_px", depth->shift_y_px, depth->shift_y_px != 0);
  return labels;
}

Sensor::Sensor(const SensorModel& model, int width, int height, const FrameSeed& device)
    : model_(model), prepared_(std::make_unique<Prepared>()) {
  const FrameSeed fixed{device.seed, -1, device.camera};
  if (model_.image && model_.image->is_noise_alone()) prepared_->level_noise.emplace(*model_.image);
  if (model_.image && !prepared_->level_noise) prepared_->chain.emplace(*model_.image, width, height, fixed);
  if (!model_.depth) return;
  normal_table();
  const auto& own = model_.depth->stream.own_camera;
  if (model_.depth->bias > 0.0)
    prepared_->bias.emplace(own ? own->camera.width_px : width, own ? own->camera.height_px : height,
                            model_.depth->bias_cell_px, fixed.stream("depth bias"));
}

Sensor::~Sensor() = default;
Sensor::Sensor(Sensor&&) noexcept = default;

void Sensor::sense_color(const FrameSeed& frame, Image8* image) const {
  if (prepared_->level_noise) prepared_->level_noise->apply(frame.stream("image noise"), image);
  if (prepared_->chain) prepared_->chain->apply(frame, image);
}

void Sensor::sense_depth(const ImageF& depth_m, const Image8& clean_color, double unit_m, const FrameSeed& frame,
                         Image16* counts) const {
  if (counts->width != depth_m.width || counts->height != depth_m.height)
    *counts = Image16(depth_m.width, depth_m.height);
  if (!model_.depth) return round_depth(depth_m, unit_m, model_.depth_scale, counts);
  const DepthSensing& model = *model_.depth;
  const bool edges = model.edge_step_per_m > 0.0, texture = model.min_contrast_levels > 0.0;
  const bool shifted = model.shift_x_px != 0 || model.shift_y_px != 0;
  const ImageF* seen = &depth_m;
  if (edges || texture || shifted || !model.imagers_x_m.empty()) {
    ImageF& work = prepared_->depth;
    work = depth_m;
    seen = &work;
    if (edges) blur_edges(depth_m, model, frame.stream("depth edges"), &work);
    for (const double offset_m : model.imagers_x_m) remove_hidden(depth_m, model.focal_px, offset_m, &work);
    if (texture) remove_textureless(clean_color, model, &work);
    if (shifted) shift_image(model.shift_x_px, model.shift_y_px, &work);
  }
  DepthNoiseField noise(model, depth_m.width, depth_m.height, frame);
  write_depth_counts(*seen, model, model_.depth_scale, prepared_->bias ? &*prepared_->bias : nullptr, &noise, counts);
  if (model.valid_share < 1.0) remove_share(model.valid_share, model.patch_px, frame.stream("depth daylight"), counts);
}

}  // namespace rigproof
