// Noise, bias, rounding and range of a depth image, row by row.
#pragma once

#include <memory>
#include <vector>

#include "normals.h"
#include "rigproof/core/image.h"
#include "rigproof/generator/sensors.h"

namespace rigproof {

/// The random part of one frame: rows of standard normal numbers with the correlation that the model asks for. Their
/// variance is made of three parts that add up to 1: fine (a moving average), patches, and ripples.
class DepthNoiseField {
 public:
  DepthNoiseField(const DepthSensing& model, int width, int height, const FrameSeed& frame);
  /// The next row from the top; valid until the next call.
  const float* next_row();

 private:
  void add_coarse_parts();

  int row_ = 0;
  std::size_t width_;
  bool silent_;
  float fine_, patchy_, ripple_;  ///< amplitudes
  std::unique_ptr<CorrelatedNormals> normals_;
  std::unique_ptr<SmoothField> patches_;
  double ripple_phase_ = 0.0;
  std::vector<float> ripple_sine_, ripple_cosine_, scratch_, out_;
};

/// Writes the recorded counts of a whole image. `bias` (may be null) is the device's field, of unit variance.
void write_depth_counts(const ImageF& depth_m, const DepthSensing& model, double depth_scale, const SmoothField* bias,
                        DepthNoiseField* noise, Image16* counts);

/// The clean depth, scaled and rounded to the unit.
void round_depth(const ImageF& depth_m, double unit_m, double depth_scale, Image16* counts);

/// Takes measurements away, patch by patch, until about `valid_share` is left.
void remove_share(double valid_share, double patch_px, RandomStream random, Image16* counts);

}  // namespace rigproof
