// The mean of pictures in linear light.
#pragma once

#include <cstdint>
#include <vector>

#include "rigproof/core/image.h"

namespace rigproof {

/// Adds rows of gamma-coded levels up by their light. A row whose pictures are all the same, with shares that sum to 1,
/// gets the same levels back. Ordered float arithmetic only: the same bytes on every machine.
class LightSum {
 public:
  /// @param gamma of the levels: light = level^gamma
  LightSum(int width, int height, int channels, double gamma);
  void add_row(int row, double share, const std::uint8_t* levels);
  /// The levels of the sum. `image` is resized.
  void write(Image8* image) const;

 private:
  int width_, height_, channels_;
  std::vector<float> light_of_level_, light_;
  std::vector<std::uint8_t> level_of_root_;  ///< by the root of the light, nearly linear in the level
};

}  // namespace rigproof
