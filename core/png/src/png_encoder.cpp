// PNG, second edition (W3C 2003): signature, IHDR, one IDAT with a zlib stream of filtered rows, IEND.
#include "rigproof/png/png_encoder.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "rigproof/core/error.h"
#include "row_filters.h"
#include "run_deflate.h"

namespace rigproof {
namespace {

using png_detail::filter_paeth_row;
using png_detail::kFilterPaeth;

constexpr std::uint8_t kSignature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
// Deflate with a window of 32 kB, "fastest".
constexpr std::uint8_t kZlibHeader[2] = {0x78, 0x01};
constexpr std::uint8_t kColorTypeGrey = 0, kColorTypeRgb = 2;
// Filtered bytes are handed to deflate in pieces that stay in the second-level cache.
constexpr std::size_t kPieceBytes = 512U << 10U;

void put_u32(std::uint32_t value, std::uint8_t* out) {
  for (int i = 0; i < 4; ++i) out[i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
}

}  // namespace

struct PngEncoder::Impl {
  RunDeflate runs;
  std::vector<std::uint8_t> piece, png;
  std::array<std::vector<std::uint8_t>, 2> scratch;
  std::size_t used = 0;  ///< bytes of `png` that are written

  void reserve(std::size_t more) {
    if (png.size() < used + more) png.resize(std::max(used + more, 2 * png.size()));
  }

  void append(const void* bytes, std::size_t count) {
    reserve(count);
    std::memcpy(png.data() + used, bytes, count);
    used += count;
  }

  void append_u32(std::uint32_t value) {
    std::uint8_t bytes[4];
    put_u32(value, bytes);
    append(bytes, 4);
  }

  std::size_t begin_chunk(const char* type) {
    const std::size_t start = used;
    append_u32(0);
    append(type, 4);
    return start;
  }

  // The length goes to the chunk's head; the checksum covers type and data.
  void end_chunk(std::size_t start) {
    const std::size_t length = used - start - 8;
    if (length > 0x7FFFFFFFU) throw Error("image too large for one PNG chunk");
    put_u32(static_cast<std::uint32_t>(length), png.data() + start);
    append_u32(libdeflate_crc32(0, png.data() + start + 4, length + 4));
  }

  void append_header(int width, int height, std::uint8_t bit_depth, std::uint8_t color_type) {
    append(kSignature, sizeof kSignature);
    const std::size_t chunk = begin_chunk("IHDR");
    append_u32(static_cast<std::uint32_t>(width));
    append_u32(static_cast<std::uint32_t>(height));
    const std::uint8_t rest[5] = {bit_depth, color_type, 0, 0, 0};
    append(rest, sizeof rest);
    end_chunk(chunk);
  }

  void deflate_piece(std::size_t bytes, bool last) {
    reserve(RunDeflate::bound(bytes));
    used = static_cast<std::size_t>(runs.append(piece.data(), bytes, last, png.data() + used) - png.data());
  }

  // row_of(y, scratch) gives the bytes of row y as PNG wants them, in the image itself or in the scratch memory; the
  // row before it stays valid.
  template <typename RowOf>
  void append_pixels(int height, std::size_t row_bytes, int pixel_bytes, const RowOf& row_of) {
    const std::size_t chunk = begin_chunk("IDAT");
    for (std::vector<std::uint8_t>& row : scratch) row.assign(row_bytes, 0);
    const std::uint8_t* above = scratch[1].data();
    const std::size_t line = row_bytes + 1;
    const int rows_a_piece = std::max(1, static_cast<int>(kPieceBytes / line));
    piece.resize(static_cast<std::size_t>(rows_a_piece) * line);
    append(kZlibHeader, sizeof kZlibHeader);
    runs.begin(pixel_bytes);
    std::uint32_t adler = 1;
    for (int y0 = 0; y0 < height; y0 += rows_a_piece) {
      const int rows = std::min(rows_a_piece, height - y0);
      for (int y = y0; y < y0 + rows; ++y) {
        std::uint8_t* out = piece.data() + static_cast<std::size_t>(y - y0) * line;
        const std::uint8_t* row = row_of(y, scratch[static_cast<std::size_t>(y % 2)].data());
        out[0] = kFilterPaeth;  // one for all rows: on rendered and on noisy images nothing is gained by choosing
        filter_paeth_row(row, above, row_bytes, static_cast<std::size_t>(pixel_bytes), out + 1);
        above = row;
      }
      const std::size_t bytes = static_cast<std::size_t>(rows) * line;
      deflate_piece(bytes, y0 + rows == height);
      adler = libdeflate_adler32(adler, piece.data(), bytes);
    }
    append_u32(adler);
    end_chunk(chunk);
  }

  template <typename RowOf>
  std::string_view encode(int width, int height, std::uint8_t bit_depth, std::uint8_t color_type, int pixel_bytes,
                          const RowOf& row_of) {
    if (width <= 0 || height <= 0) throw Error("an empty image cannot be encoded as PNG");
    used = 0;
    append_header(width, height, bit_depth, color_type);
    append_pixels(height, static_cast<std::size_t>(width) * static_cast<std::size_t>(pixel_bytes), pixel_bytes, row_of);
    end_chunk(begin_chunk("IEND"));
    return {reinterpret_cast<const char*>(png.data()), used};
  }
};

PngEncoder::PngEncoder() : impl_(std::make_unique<Impl>()) {}
PngEncoder::~PngEncoder() = default;

std::string_view PngEncoder::encode(const Image8& image) {
  if (image.channels != 1 && image.channels != 3) {
    throw Error("an 8-bit image with " + std::to_string(image.channels) + " channels cannot be encoded: 1 or 3");
  }
  return impl_->encode(image.width, image.height, 8, image.channels == 3 ? kColorTypeRgb : kColorTypeGrey,
                       image.channels, [&](int y, std::uint8_t*) { return image.row(y); });
}

std::string_view PngEncoder::encode(const Image16& image) {
  if (image.channels != 1) throw Error("a 16-bit image must have one channel to be encoded");
  const std::size_t count = image.row_length();
  return impl_->encode(image.width, image.height, 16, kColorTypeGrey, 2, [&](int y, std::uint8_t* out) {
    const std::uint16_t* pixels = image.row(y);
    for (std::size_t i = 0; i < count; ++i) {  // most significant byte first
      out[2 * i] = static_cast<std::uint8_t>(pixels[i] >> 8U);
      out[2 * i + 1] = static_cast<std::uint8_t>(pixels[i]);
    }
    return static_cast<const std::uint8_t*>(out);
  });
}

}  // namespace rigproof
