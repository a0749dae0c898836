// From light to levels: what lens, pixels and gamma make of a clean image.
#pragma once

#include <cstdint>
#include <vector>

#include "rigproof/core/image.h"
#include "rigproof/generator/sensors.h"

namespace rigproof {

/// Shot and read noise alone, by table: the clean level and ten random bits give the noisy level.
class LevelNoise {
 public:
  explicit LevelNoise(const ImageSensing& model);
  void apply(RandomStream random, Image8* image) const;

 private:
  std::vector<std::uint8_t> levels_;  ///< [level][10 random bits] -> level
};

/// The whole chain, in electrons.
class ImageChain {
 public:
  /// @param device draws the gains and offsets of the pixels
  ImageChain(const ImageSensing& model, int width, int height, const FrameSeed& device);
  void apply(const FrameSeed& frame, Image8* image) const;

 private:
  void make_pixel_tables(std::size_t samples, const FrameSeed& device);
  void make_coding_table();
  /// @param light scratch memory for a number a pixel
  void expose_row(int y, float exposure, float* light, float* electrons) const;
  /// @param roots scratch memory for `count` numbers
  void code_row(const float* electrons, const std::uint32_t* words, std::size_t count, std::int32_t* roots,
                std::uint8_t* out) const;

  ImageSensing model_;
  int width_ = 0, height_ = 0;
  float falloff_ = 0.0F;  ///< vignetting: light = 1 / (1 + falloff r^2)^2, r = 1 in the corner
  std::vector<float> electrons_of_level_;
  std::vector<std::uint8_t> gain_draws_,
      offset_draws_;  ///< a random byte for every sample, where there is such an error
  std::vector<float> gain_of_draw_, offset_of_draw_;
  float pedestal_ = 0.0F, steps_per_root_ = 0.0F;
  std::vector<std::uint8_t> coded_;  ///< [root of the electrons][10 random bits] -> level
};

/// Gaussian blur of interleaved channels; edges are replicated.
void blur_samples(double sigma_px, ImageF* image);

}  // namespace rigproof
