#include "depth_noise.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/vector_clones.h"

namespace rigproof {
namespace {

// Far beyond any stereo camera's, small enough to count its steps in an int.
constexpr float kMaxDisparityPx = 1e5F;
// "As fine as can be" such that the largest disparity still fits.
constexpr double kFinestStepPx = 1.0 / 16384.0;
// Ripples lean by this part of their length from row to row.
constexpr double kRippleLean = 0.02;

// Everything that the loops over pixels need, in single precision.
struct StereoConstants {
  float disparity_m;  ///< focal length times baseline: disparity [px] = disparity_m / z
  float sigma_px, bias_px;
  float steps, per_step;
  float scale_over_unit;
  float min_m, max_m;
};

struct FlightConstants {
  float constant_m, proportional;
  float bias_m;
  float scale_over_unit;
  float min_m, max_m;
};

// No branches in the functions below, so that the loop over pixels becomes vector code.
inline std::uint16_t rounded_count(float measured_m, std::int32_t valid, float scale_over_unit, float min_m,
                                   float max_m) {
  const float within = std::min(measured_m, 2.0F * max_m);
  const std::int32_t good =
      valid & static_cast<std::int32_t>(within >= min_m) & static_cast<std::int32_t>(within <= max_m);
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(within * scale_over_unit + 0.5F) * good);
}

inline std::uint16_t stereo_count(float z_m, float normal, float bias, const StereoConstants& c) {
  // A pixel without depth divides by one instead of zero, and is marked invalid.
  const float ideal = std::min(c.disparity_m / (z_m > 0.0F ? z_m : 1.0F), kMaxDisparityPx);
  const float disparity = ideal + (c.sigma_px * normal + c.bias_px * bias);
  // Disparities are positive where they matter, so that truncation after adding a half rounds.
  const float rounded = static_cast<float>(static_cast<std::int32_t>(disparity * c.steps + 0.5F)) * c.per_step;
  const std::int32_t valid = static_cast<std::int32_t>(z_m > 0.0F) & static_cast<std::int32_t>(rounded > 0.0F);
  const float measured_m = c.disparity_m / (rounded > 0.0F ? rounded : 1.0F);
  return rounded_count(measured_m, valid, c.scale_over_unit, c.min_m, c.max_m);
}

inline std::uint16_t flight_count(float z_m, float normal, float bias, const FlightConstants& c) {
  const float measured_m = z_m + ((c.constant_m + c.proportional * z_m) * normal + c.bias_m * bias);
  return rounded_count(measured_m, static_cast<std::int32_t>(z_m > 0.0F), c.scale_over_unit, c.min_m, c.max_m);
}

RIGPROOF_VECTOR_CLONES
void stereo_row(const float* depth, const float* normal, const float* bias, std::size_t width, const StereoConstants& c,
                std::uint16_t* out) {
  for (std::size_t x = 0; x < width; ++x) out[x] = stereo_count(depth[x], normal[x], bias[x], c);
}

RIGPROOF_VECTOR_CLONES
void flight_row(const float* depth, const float* normal, const float* bias, std::size_t width, const FlightConstants& c,
                std::uint16_t* out) {
  for (std::size_t x = 0; x < width; ++x) out[x] = flight_count(depth[x], normal[x], bias[x], c);
}

// The largest depth that the 16-bit image can hold bounds the range as well.
float farthest_m(const DepthSensing& model, double scale) {
  return static_cast<float>(std::min(model.stream.max_m, 65534.0 * model.stream.unit_m / scale));
}

StereoConstants stereo_constants(const DepthSensing& model, double scale, bool biased) {
  const double step = std::max(model.disparity_step_px, kFinestStepPx);
  const double sigma_px = model.focal_baseline_px_m * model.stream.noise.inverse_depth_sigma_per_m;
  return {static_cast<float>(model.focal_baseline_px_m),
          static_cast<float>(model.noise ? sigma_px : 0.0),
          static_cast<float>(biased ? model.bias : 0.0),
          static_cast<float>(1.0 / step),
          static_cast<float>(step),
          static_cast<float>(scale / model.stream.unit_m),
          static_cast<float>(model.stream.min_m),
          farthest_m(model, scale)};
}

FlightConstants flight_constants(const DepthSensing& model, double scale, bool biased) {
  const double on = model.noise ? 1.0 : 0.0;
  return {static_cast<float>(on * model.stream.noise.constant_m),
          static_cast<float>(on * model.stream.noise.proportional),
          static_cast<float>(biased ? model.bias : 0.0),
          static_cast<float>(scale / model.stream.unit_m),
          static_cast<float>(model.stream.min_m),
          farthest_m(model, scale)};
}

RIGPROOF_VECTOR_CLONES
void round_pixels(const float* depth_m, std::size_t count, float per_unit, std::uint16_t* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const float units = depth_m[i] * per_unit + 0.5F;
    out[i] = static_cast<std::uint16_t>(static_cast<std::int32_t>(units < 65536.0F ? units : 0.0F));
  }
}

}  // namespace

DepthNoiseField::DepthNoiseField(const DepthSensing& model, int width, int height, const FrameSeed& frame)
    : width_(static_cast<std::size_t>(width)),
      silent_(!model.noise),
      fine_(static_cast<float>(std::sqrt(std::max(0.0, 1.0 - model.patchy_share - model.ripple_share)))),
      patchy_(static_cast<float>(std::sqrt(model.patchy_share))),
      ripple_(static_cast<float>(std::sqrt(2.0 * model.ripple_share))),
      out_(width_, 0.0F) {
  if (silent_) return;
  const int side = std::max(1, static_cast<int>(std::lround(model.stream.noise.correlation_px)));
  normals_ = std::make_unique<CorrelatedNormals>(width, side, frame.stream("depth noise"));
  if (patchy_ > 0.0F)
    patches_ = std::make_unique<SmoothField>(width, height, model.patch_px, frame.stream("depth patches"));
  scratch_.resize(width_);
  if (ripple_ <= 0.0F) return;
  ripple_phase_ = 2.0 * kPi * frame.stream("depth ripples").uniform();
  for (std::size_t x = 0; x < width_; ++x) {
    const double angle = 2.0 * kPi * static_cast<double>(x) / model.ripple_px;
    ripple_sine_.push_back(static_cast<float>(std::sin(angle)));
    ripple_cosine_.push_back(static_cast<float>(std::cos(angle)));
  }
}

const float* DepthNoiseField::next_row() {
  if (silent_) return out_.data();
  const float* fine = normals_->next_row();
  if (patchy_ <= 0.0F && ripple_ <= 0.0F) return fine;
  for (std::size_t x = 0; x < width_; ++x) out_[x] = fine_ * fine[x];
  add_coarse_parts();
  ++row_;
  return out_.data();
}

void DepthNoiseField::add_coarse_parts() {
  if (patches_) {
    patches_->row(row_, scratch_.data());
    for (std::size_t x = 0; x < width_; ++x) out_[x] += patchy_ * scratch_[x];
  }
  if (ripple_ <= 0.0F) return;
  const double phase = ripple_phase_ + 2.0 * kPi * kRippleLean * row_;
  const float sine = ripple_ * static_cast<float>(std::sin(phase)),
              cosine = ripple_ * static_cast<float>(std::cos(phase));
  for (std::size_t x = 0; x < width_; ++x) out_[x] += cosine * ripple_sine_[x] + sine * ripple_cosine_[x];
}

void write_depth_counts(const ImageF& depth_m, const DepthSensing& model, double depth_scale, const SmoothField* bias,
                        DepthNoiseField* noise, Image16* counts) {
  const bool stereo = model.stream.noise.law == DepthNoise::Law::kStereo;
  const StereoConstants of_stereo = stereo_constants(model, depth_scale, bias != nullptr);
  const FlightConstants of_flight = flight_constants(model, depth_scale, bias != nullptr);
  std::vector<float> bias_row(depth_m.row_length(), 0.0F);
  for (int y = 0; y < depth_m.height; ++y) {
    const float* normal = noise->next_row();
    if (bias != nullptr) bias->row(y, bias_row.data());
    if (stereo)
      stereo_row(depth_m.row(y), normal, bias_row.data(), bias_row.size(), of_stereo, counts->row(y));
    else
      flight_row(depth_m.row(y), normal, bias_row.data(), bias_row.size(), of_flight, counts->row(y));
  }
}

void round_depth(const ImageF& depth_m, double unit_m, double depth_scale, Image16* counts) {
  round_pixels(depth_m.pixels.data(), depth_m.pixels.size(), static_cast<float>(depth_scale / unit_m),
               counts->pixels.data());
}

void remove_share(double valid_share, double patch_px, RandomStream random, Image16* counts) {
  // The quantile of the standard normal field below which a pixel is lost.
  const std::vector<float>& normals = normal_table();
  const double lost = std::clamp(1.0 - valid_share, 0.0, 1.0);
  const auto index = static_cast<std::size_t>(lost * static_cast<double>(normals.size() - 1));
  const float threshold = normals[index];
  const SmoothField patches(counts->width, counts->height, std::max(2.0, patch_px / 4.0), random);
  std::vector<float> field(counts->row_length());
  for (int y = 0; y < counts->height; ++y) {
    patches.row(y, field.data());
    std::uint16_t* out = counts->row(y);
    for (std::size_t x = 0; x < field.size(); ++x)
      if (field[x] < threshold) out[x] = 0;
  }
}

}  // namespace rigproof
