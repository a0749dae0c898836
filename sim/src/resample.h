// From what GL rendered to what the sensor sees: point-spread function, area reduction, lens resampling.
// Integer or strictly ordered float arithmetic only: the same bytes on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "rigproof/core/image.h"

namespace rigproof {

/// Gives an image another size, in the memory that it has.
template <typename T>
void resize(int width, int height, int channels, Image<T>* image) {
  image->width = width;
  image->height = height;
  image->channels = channels;
  image->pixels.resize(static_cast<std::size_t>(height) * image->row_length());
}

/// RGBA pixels as GL hands them over, rows addressed from the top (GL's first row is the bottom one).
struct RgbaView {
  const std::uint8_t* top = nullptr;
  std::ptrdiff_t stride = 0;  ///< bytes from a row to the one below, may be negative
  int width = 0;
  int height = 0;

  const std::uint8_t* row(int y) const { return top + y * stride; }
};

/// A rectangle of pixels, x0 <= x < x0 + width.
struct PixelRect {
  int x0 = 0, y0 = 0, width = 0, height = 0;

  bool empty() const { return width <= 0 || height <= 0; }
};

/// Blurs with a Gaussian of sigma_px and drops alpha; edges are replicated. sigma_px = 0 copies.
class PointSpread {
 public:
  explicit PointSpread(double sigma_px);
  /// Pixels around a pixel that it takes light from.
  int reach_px() const { return static_cast<int>(taps_.size()) - 1; }
  /// `rgb` is resized.
  void apply(const RgbaView& source, Image8* rgb);

 private:
  std::vector<std::uint16_t> taps_;  // centre first; the whole kernel sums to 256
  std::vector<std::uint8_t> line_;
};

/// Blurs an image drawn `factor` times as fine with the PSF and averages factor x factor pixels, in one pass.
class AreaReduction {
 public:
  /// @param sigma_px of the point-spread function in pixels of the reduced image.
  /// @param factor even.
  AreaReduction(double sigma_px, int factor);
  /// Pixels of the reduced image that the fine one must reach beyond the reduced rectangle, on every side.
  int margin_px() const { return margin_px_; }
  /// Fills `destination` of `rgb` from a source of (width + 2 margin) * factor by (height + 2 margin) * factor pixels.
  void apply(const RgbaView& source, const PixelRect& destination, Image8* rgb);

 private:
  int factor_;
  std::vector<float> pair_weights_;  // of the two middle samples first, then outwards
  int margin_px_ = 0;
  std::vector<float> line_;
};

/// Samples a row of `count` pixels at (xs, ys) of the source, bilinearly to 1/256 px, into RGBA. Positions outside of
/// the source, and those that are not numbers, give black.
void sample_row(const RgbaView& source, const float* xs, const float* ys, int count, std::uint8_t* rgba);

}  // namespace rigproof
