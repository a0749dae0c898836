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

/// The whole chain, in electrons: effects that are prepared, then noise and coding.
class ImageChain {
 public:
  explicit ImageChain(const ImageSensing& model);
  /// @param model the one that the chain was made of
  void apply(const ImageSensing& model, const FrameSeed& frame, Image8* image) const;

 private:
  /// @param roots scratch memory for `count` numbers
  void code_row(const float* electrons, const std::uint32_t* words, std::size_t count, std::int32_t* roots,
                std::uint8_t* out) const;

  std::vector<float> electrons_of_level_;
  float pedestal_ = 0.0F, steps_per_root_ = 0.0F;
  std::vector<std::uint8_t> coded_;  ///< [root of the electrons][10 random bits] -> level
};

}  // namespace rigproof
