// What the sensors make of a clean picture: image noise in linear light, depth noise in disparity.
//
// Clean render -> Sensor -> what is recorded. Nothing here knows where the picture came from, so that one render can be
// sensed many times. Formulas: docs/generation.md.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "rigproof/core/image.h"
#include "rigproof/core/random.h"
#include "rigproof/core/rig.h"

namespace rigproof {

/// Shot and read noise (EMVA 1288) of a sensor whose 8-bit output is gamma coded.
/// Defaults: OmniVision OV9782, the colour sensor of a RealSense D455, whose product brief states a signal-to-noise
/// ratio of 38 dB at most (10^3.8 = 6300 electrons) and a dynamic range of 68 dB (6300 / 10^3.4 = 2.5 electrons).
struct ImageNoise {
  double full_well_electrons = 6300.0;
  double read_noise_electrons = 2.5;
  double gamma = 2.2;
};

/// How a depth sensor measures. The law and its sigma come from the rig's sensor preset.
struct DepthSensing {
  DepthStream stream;
  double disparity_sigma_px = 0.08;      ///< stereo: what the preset's inverse-depth sigma is in pixels of disparity
  double disparity_steps_per_px = 32.0;  ///< stereo: resolution of the disparity
};

/// What one camera's sensor does. Absent parts leave the picture clean.
struct SensorModel {
  std::optional<ImageNoise> image_noise;
  std::optional<DepthSensing> depth_noise;
  double depth_scale = 1.0;  ///< measured over true depth, an error of the device
};

/// Prepared tables of one model. Const after construction.
class Sensor {
 public:
  explicit Sensor(const SensorModel& model);

  /// Adds noise to a gamma-coded 8-bit image in place.
  void sense_color(RandomStream random, Image8* image) const;
  /// Depth image as the sensor writes it; 0 = no measurement. Without noise: the clean depth, rounded to the unit.
  /// @param depth_m clean z along the optical axis, 0 = nothing there
  void sense_depth(const ImageF& depth_m, double unit_m, RandomStream random, Image16* counts) const;

  const SensorModel& model() const { return model_; }

 private:
  SensorModel model_;
  std::vector<std::uint8_t> noisy_levels_;  ///< [level][10 random bits] -> level
};

/// Standard normal numbers whose correlation is that of a moving average over side x side pixels, so that side^2 pixels
/// hold one independent measurement. Given row by row, from the top.
class CorrelatedNormals {
 public:
  CorrelatedNormals(int width, int side, RandomStream random);
  /// The next row, `width` numbers; valid until the next call.
  const float* next_row();

 private:
  void add_sums();

  std::size_t width_, side_;
  RandomStream random_;
  std::vector<std::uint32_t> words_;
  std::vector<float> white_, out_;
  std::vector<float> ring_;  ///< the last `side` rows of moving sums along x
  std::size_t oldest_ = 0;   ///< row of the ring that comes next
};

/// Quantile of the standard normal distribution at the middles of 2^bits equal probabilities, increasing.
std::vector<float> normal_quantiles(int bits);

}  // namespace rigproof
