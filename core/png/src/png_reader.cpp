#include "rigproof/png/png_reader.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include "row_filters.h"

namespace rigproof {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};

std::uint32_t big_endian(const std::uint8_t* p) {
  return (std::uint32_t{p[0]} << 24U) | (std::uint32_t{p[1]} << 16U) | (std::uint32_t{p[2]} << 8U) | p[3];
}

struct Chunk {
  const std::uint8_t* type = nullptr;
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
  bool is(const char* name) const { return std::memcmp(type, name, 4) == 0; }
};

// The chunk at `at`; moves on behind it. Absent where the file ends within it.
std::optional<Chunk> next_chunk(const Bytes& bytes, std::size_t* at) {
  if (*at + 12 > bytes.size()) return std::nullopt;
  Chunk chunk{bytes.data() + *at + 4, bytes.data() + *at + 8, big_endian(bytes.data() + *at)};
  if (chunk.size > bytes.size() - *at - 12) return std::nullopt;
  *at += 12 + chunk.size;
  return chunk;
}

bool checksum_holds(const Chunk& chunk) {
  return libdeflate_crc32(0, chunk.type, chunk.size + 4) == big_endian(chunk.data + chunk.size);
}

/// The compressed pixels; a view where one chunk holds them all.
struct Compressed {
  Bytes joined;
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

std::variant<Compressed, Unreadable> gather_pixels(const Bytes& bytes) {
  Compressed result;
  std::size_t at = kSignature.size();
  while (const std::optional<Chunk> chunk = next_chunk(bytes, &at)) {
    if (!checksum_holds(*chunk)) return Unreadable{"damaged PNG (checksum)"};
    if (chunk->is("IEND")) {
      if (!result.joined.empty()) {
        result.data = result.joined.data();
        result.size = result.joined.size();
      }
      if (result.size == 0) return Unreadable{"damaged PNG (no pixels)"};
      return result;
    }
    if (!chunk->is("IDAT")) continue;
    if (result.data == nullptr) {
      result.data = chunk->data;
      result.size = chunk->size;
      continue;
    }
    if (result.joined.empty()) result.joined.assign(result.data, result.data + result.size);
    result.joined.insert(result.joined.end(), chunk->data, chunk->data + chunk->size);
  }
  return Unreadable{"truncated PNG"};
}

/// Rows with their filter bytes, as they come out of the compression.
struct Scanlines {
  std::unique_ptr<std::uint8_t[]> data;
  std::size_t row_bytes = 0;  ///< without the filter byte
  std::uint8_t* row(std::size_t y) { return data.get() + y * (row_bytes + 1); }
};

std::variant<Scanlines, Unreadable> inflate(const Bytes& bytes, const PngHeader& header) {
  std::variant<Compressed, Unreadable> gathered = gather_pixels(bytes);
  if (auto* failure = std::get_if<Unreadable>(&gathered)) return *failure;
  const Compressed& compressed = std::get<Compressed>(gathered);
  Scanlines lines;
  lines.row_bytes = header.width * header.pixel_bytes();
  const std::size_t size = (lines.row_bytes + 1) * header.height;
  // Deflate expands at most 1032 times; a header that promises more lies, and nothing is allocated for it.
  if (size / 1040 > compressed.size) return Unreadable{"damaged PNG (fewer pixels than its header says)"};
  lines.data.reset(new std::uint8_t[size + png_detail::kUnfilterPadding]);  // not set to zero first
  struct Free {
    void operator()(libdeflate_decompressor* d) const { libdeflate_free_decompressor(d); }
  };
  const std::unique_ptr<libdeflate_decompressor, Free> decompressor(libdeflate_alloc_decompressor());
  if (!decompressor) return Unreadable{"out of memory"};
  std::size_t written = 0;
  const libdeflate_result result = libdeflate_zlib_decompress(decompressor.get(), compressed.data, compressed.size,
                                                              lines.data.get(), size, &written);
  if (result != LIBDEFLATE_SUCCESS || written != size) return Unreadable{"damaged PNG (compressed pixels)"};
  return lines;
}

// Calls use(image, y, row) with each row's bytes in turn. The image is made when there is what fills it.
template <typename Image, typename Use>
std::variant<Image, Unreadable> image_of(const Bytes& bytes, const PngHeader& header, int channels, Use use) {
  std::variant<Scanlines, Unreadable> inflated = inflate(bytes, header);
  if (auto* failure = std::get_if<Unreadable>(&inflated)) return *failure;
  Scanlines& lines = std::get<Scanlines>(inflated);
  Image image(static_cast<int>(header.width), static_cast<int>(header.height), channels);
  const Bytes zeros(lines.row_bytes + png_detail::kUnfilterPadding, 0);
  for (std::size_t y = 0; y < header.height;) {
    const std::uint8_t* above = y == 0 ? zeros.data() : lines.row(y - 1) + 1;
    const std::size_t done =
        png_detail::unfilter_rows(above, lines.row(y), header.height - y, lines.row_bytes, header.pixel_bytes());
    if (done == 0) return Unreadable{"damaged PNG (unknown filter)"};
    for (const std::size_t end = y + done; y < end; ++y) use(&image, static_cast<int>(y), lines.row(y) + 1);
  }
  return image;
}

void to_grey(const std::uint8_t* row, std::size_t channels, std::uint8_t* grey, std::size_t width) {
  if (channels == 1) {
    std::copy_n(row, width, grey);
  } else if (channels == 2) {
    for (std::size_t x = 0; x < width; ++x) grey[x] = row[2 * x];
  } else {
    // Weights of ITU-R BT.601 in 1/16384.
    for (std::size_t x = 0; x < width; ++x, row += channels)
      grey[x] = static_cast<std::uint8_t>((4899 * row[0] + 9617 * row[1] + 1868 * row[2] + 8192) >> 14);
  }
}

}  // namespace

int PngHeader::channels() const { return color_type == 2 ? 3 : color_type == 4 ? 2 : color_type == 6 ? 4 : 1; }

bool is_png(const Bytes& bytes) {
  return bytes.size() >= kSignature.size() && std::equal(kSignature.begin(), kSignature.end(), bytes.begin());
}

std::optional<PngHeader> read_png_header(const Bytes& bytes) {
  std::size_t at = kSignature.size();
  const std::optional<Chunk> chunk = next_chunk(bytes, &at);
  if (!chunk || !chunk->is("IHDR") || chunk->size != 13 || !checksum_holds(*chunk)) return std::nullopt;
  const std::uint8_t* d = chunk->data;
  PngHeader header{big_endian(d), big_endian(d + 4), d[8], d[9], d[12] != 0};
  const bool known_type = d[9] == 0 || d[9] == 2 || d[9] == 3 || d[9] == 4 || d[9] == 6;
  const bool known_depth = d[8] == 1 || d[8] == 2 || d[8] == 4 || d[8] == 8 || d[8] == 16;
  if (!known_type || !known_depth || header.width == 0 || header.height == 0) return std::nullopt;
  return header;
}

std::optional<Unreadable> find_png_damage(const Bytes& bytes) {
  const std::variant<Compressed, Unreadable> gathered = gather_pixels(bytes);
  if (const auto* failure = std::get_if<Unreadable>(&gathered)) return *failure;
  return std::nullopt;
}

std::variant<Image8, Unreadable> decode_png_grey(const Bytes& bytes, const PngHeader& header) {
  const auto channels = static_cast<std::size_t>(header.channels());
  return image_of<Image8>(bytes, header, 1, [&](Image8* image, int y, const std::uint8_t* row) {
    to_grey(row, channels, image->row(y), header.width);
  });
}

std::variant<Image8, Unreadable> decode_png_rgb(const Bytes& bytes, const PngHeader& header) {
  return image_of<Image8>(bytes, header, 3, [](Image8* image, int y, const std::uint8_t* row) {
    std::copy_n(row, image->row_length(), image->row(y));
  });
}

std::variant<Image16, Unreadable> decode_png_16(const Bytes& bytes, const PngHeader& header) {
  return image_of<Image16>(bytes, header, 1, [&](Image16* image, int y, const std::uint8_t* row) {
    std::uint16_t* target = image->row(y);
    for (std::size_t x = 0; x < header.width; ++x)
      target[x] = static_cast<std::uint16_t>((row[2 * x] << 8) | row[2 * x + 1]);
  });
}

}  // namespace rigproof
