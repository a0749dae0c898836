// A decoder for the PNGs that cameras' recorders write: not interlaced, 8 or 16 bit, no palette.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "rigproof/core/image.h"
#include "rigproof/core/unreadable.h"

namespace rigproof {

/// The header of a PNG (ISO/IEC 15948, 11.2.2).
struct PngHeader {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  int bit_depth = 0;
  int color_type = 0;  ///< 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGBA
  bool interlaced = false;

  int channels() const;
  std::size_t pixel_bytes() const { return static_cast<std::size_t>(channels() * bit_depth / 8); }
  /// True if decode_png_* below can read it.
  bool is_plain() const { return !interlaced && color_type != 3 && bit_depth >= 8; }
};

bool is_png(const std::vector<std::uint8_t>& bytes);
/// Absent if the header is broken.
std::optional<PngHeader> read_png_header(const std::vector<std::uint8_t>& bytes);

/// What is wrong with the chunks, if anything: the file ends early, or a checksum fails.
std::optional<Unreadable> find_png_damage(const std::vector<std::uint8_t>& bytes);

/// A plain 8-bit PNG as grey.
std::variant<Image8, Unreadable> decode_png_grey(const std::vector<std::uint8_t>& bytes, const PngHeader& header);
/// A plain 8-bit PNG of color_type 2, with three channels: red, green, blue.
std::variant<Image8, Unreadable> decode_png_rgb(const std::vector<std::uint8_t>& bytes, const PngHeader& header);
/// A plain 16-bit grey PNG.
std::variant<Image16, Unreadable> decode_png_16(const std::vector<std::uint8_t>& bytes, const PngHeader& header);

}  // namespace rigproof
