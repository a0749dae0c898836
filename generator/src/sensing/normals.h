// Standard normal numbers for whole images: white, correlated like a matching window, and smooth.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rigproof/core/random.h"

namespace rigproof {

/// Quantile of the standard normal distribution at the middles of 2^bits equal probabilities, increasing.
std::vector<float> normal_quantiles(int bits);

/// The table of 2^kNormalBits quantiles that depth noise and device maps are drawn from: cut off at 3.7 sigma, and
/// small enough to stay in the cache. Made at the first call.
inline constexpr int kNormalBits = 12;
const std::vector<float>& normal_table();

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

/// A smooth random surface: cubic B-splines over a lattice of standard normal numbers, `cell_px` apart, scaled so that
/// every pixel by itself is standard normal.
class SmoothField {
 public:
  SmoothField(int width, int height, double cell_px, RandomStream random);
  /// Writes the `width` values of a row.
  void row(int y, float* out) const;

 private:
  // For each pixel along an axis.
  struct Taps {
    std::vector<std::size_t> first;            ///< of four neighbours on the lattice; never falls
    std::array<std::vector<float>, 4> weight;  ///< squares add up to 1
  };
  static Taps taps_of(int size, double cell_px);

  std::size_t columns_ = 0;
  std::vector<float> lattice_;
  Taps across_, down_;
};

}  // namespace rigproof
