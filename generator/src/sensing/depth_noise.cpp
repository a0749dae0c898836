#include "depth_noise.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "normals.h"
#include "rigproof/core/vector_clones.h"

namespace rigproof {
namespace {

// Far beyond any stereo camera's, small enough to count its steps in an int.
constexpr float kMaxDisparityPx = 1e5F;
// "As fine as can be" such that the largest disparity still fits.
constexpr double kFinestStepPx = 1.0 / 16384.0;

// Everything that the loops over pixels need, in single precision.
struct StereoConstants {
  float disparity_m;  ///< focal length times baseline: disparity [px] = disparity_m / z
  float sigma_px;
  float steps, per_step;
  float scale_over_unit;
  float min_m, max_m;
};

struct FlightConstants {
  float constant_m, proportional;
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

inline std::uint16_t stereo_count(float z_m, float normal, float error, const StereoConstants& c) {
  // A pixel without depth divides by one instead of zero, and is marked invalid.
  const float ideal = std::min(c.disparity_m / (z_m > 0.0F ? z_m : 1.0F), kMaxDisparityPx);
  const float disparity = ideal + (c.sigma_px * normal + error);
  // Disparities are positive where they matter, so that truncation after adding a half rounds.
  const float rounded = static_cast<float>(static_cast<std::int32_t>(disparity * c.steps + 0.5F)) * c.per_step;
  const std::int32_t valid = static_cast<std::int32_t>(z_m > 0.0F) & static_cast<std::int32_t>(rounded > 0.0F);
  const float measured_m = c.disparity_m / (rounded > 0.0F ? rounded : 1.0F);
  return rounded_count(measured_m, valid, c.scale_over_unit, c.min_m, c.max_m);
}

inline std::uint16_t flight_count(float z_m, float normal, float error, const FlightConstants& c) {
  const float measured_m = z_m + ((c.constant_m + c.proportional * z_m) * normal + error);
  return rounded_count(measured_m, static_cast<std::int32_t>(z_m > 0.0F), c.scale_over_unit, c.min_m, c.max_m);
}

RIGPROOF_VECTOR_CLONES
void stereo_row(const float* depth, const float* normal, const float* error, std::size_t width,
                const StereoConstants& c, std::uint16_t* out) {
  for (std::size_t x = 0; x < width; ++x) out[x] = stereo_count(depth[x], normal[x], error[x], c);
}

RIGPROOF_VECTOR_CLONES
void flight_row(const float* depth, const float* normal, const float* error, std::size_t width,
                const FlightConstants& c, std::uint16_t* out) {
  for (std::size_t x = 0; x < width; ++x) out[x] = flight_count(depth[x], normal[x], error[x], c);
}

// The largest depth that the 16-bit image can hold bounds the range as well.
float farthest_m(const DepthSensing& model, double scale) {
  return static_cast<float>(std::min(model.stream.max_m, 65534.0 * model.stream.unit_m / scale));
}

StereoConstants stereo_constants(const DepthSensing& model, double scale) {
  const double step = std::max(model.disparity_step_px, kFinestStepPx);
  const double sigma_px = model.focal_baseline_px_m * model.stream.noise.inverse_depth_sigma_per_m;
  return {static_cast<float>(model.focal_baseline_px_m),
          static_cast<float>(model.noise ? sigma_px : 0.0),
          static_cast<float>(1.0 / step),
          static_cast<float>(step),
          static_cast<float>(scale / model.stream.unit_m),
          static_cast<float>(model.stream.min_m),
          farthest_m(model, scale)};
}

FlightConstants flight_constants(const DepthSensing& model, double scale) {
  const double on = model.noise ? 1.0 : 0.0;
  return {static_cast<float>(on * model.stream.noise.constant_m),
          static_cast<float>(on * model.stream.noise.proportional), static_cast<float>(scale / model.stream.unit_m),
          static_cast<float>(model.stream.min_m), farthest_m(model, scale)};
}

RIGPROOF_VECTOR_CLONES
void round_pixels(const float* depth_m, std::size_t count, float per_unit, std::uint16_t* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const float units = depth_m[i] * per_unit + 0.5F;
    out[i] = static_cast<std::uint16_t>(static_cast<std::int32_t>(units < 65536.0F ? units : 0.0F));
  }
}

// Rows of standard normal numbers with the correlation that the model asks for, from the top.
class NoiseRows {
 public:
  NoiseRows(const DepthSensing& model, int width, const FrameSeed& frame) : row_(static_cast<std::size_t>(width)) {
    if (!model.noise) return;
    const int side = std::max(1, static_cast<int>(std::lround(model.stream.noise.correlation_px)));
    normals_.emplace(width, side, frame.stream("depth noise"));
    for (const auto& effect : model.effects)
      if (ChangeRow change = effect->noise_of(frame)) changes_.push_back(std::move(change));
  }
  /// Row y, which follows the one before; valid until the next call.
  const float* row(int y) {
    if (!normals_) return row_.data();
    const float* fine = normals_->next_row();
    if (changes_.empty()) return fine;
    std::copy_n(fine, row_.size(), row_.data());
    for (const ChangeRow& change : changes_) change(y, row_.data());
    return row_.data();
  }

 private:
  std::optional<CorrelatedNormals> normals_;  ///< absent: there is no noise
  std::vector<ChangeRow> changes_;
  std::vector<float> row_;
};

}  // namespace

void measure_depth(const ImageF& depth_m, const DepthSensing& model, double depth_scale, const FrameSeed& frame,
                   Image16* counts) {
  const StereoConstants of_stereo = stereo_constants(model, depth_scale);
  const FlightConstants of_flight = flight_constants(model, depth_scale);
  NoiseRows noise(model, depth_m.width, frame);
  std::vector<float> error(depth_m.row_length());
  for (int y = 0; y < depth_m.height; ++y) {
    const float* normal = noise.row(y);
    std::fill(error.begin(), error.end(), 0.0F);
    for (const auto& effect : model.effects) effect->add_error(y, error.data());
    if (model.is_stereo())
      stereo_row(depth_m.row(y), normal, error.data(), error.size(), of_stereo, counts->row(y));
    else
      flight_row(depth_m.row(y), normal, error.data(), error.size(), of_flight, counts->row(y));
  }
}

void round_depth(const ImageF& depth_m, double unit_m, double depth_scale, Image16* counts) {
  round_pixels(depth_m.pixels.data(), depth_m.pixels.size(), static_cast<float>(depth_scale / unit_m),
               counts->pixels.data());
}

}  // namespace rigproof
