// bench_png FOLDER [ROUNDS=5]: the images of a folder and what is below it, written and read by our own room and by
// what libraries have, in one run.
//
//   ours         one filter (Paeth), runs alone are searched, libdeflate inflates, rows of a wave are unfiltered
//   libdeflate   the same, but libdeflate compresses at level 1
//   libspng      libspng at level 1 with the same filter, and its own reader
//
// Times are of the processor, the least of the rounds, which alternate; sizes are of the compressed files.
#include <libdeflate.h>
#include <spng.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "clocks.h"
#include "rigproof/core/error.h"
#include "rigproof/core/image.h"
#include "rigproof/png/png_encoder.h"
#include "rigproof/png/png_reader.h"
#include "row_filters.h"

namespace {

using namespace rigproof;
using Bytes = std::vector<std::uint8_t>;

/// Either colour or depth.
struct Picture {
  Image8 color;
  Image16 depth;
  bool is_color() const { return !color.empty(); }
  int width() const { return is_color() ? color.width : depth.width; }
  int height() const { return is_color() ? color.height : depth.height; }
  std::size_t pixel_bytes() const { return is_color() ? static_cast<std::size_t>(color.channels) : 2; }
  std::size_t row_bytes() const { return pixel_bytes() * static_cast<std::size_t>(width()); }
};

Picture load(const std::filesystem::path& file) {
  const cv::Mat mat = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  Picture picture;
  if (mat.type() == CV_16UC1) {
    picture.depth = Image16(mat.cols, mat.rows);
    for (int y = 0; y < mat.rows; ++y) std::copy_n(mat.ptr<std::uint16_t>(y), mat.cols, picture.depth.row(y));
  } else if (mat.type() == CV_8UC3) {
    picture.color = Image8(mat.cols, mat.rows, 3);
    cv::Mat rgb(mat.rows, mat.cols, CV_8UC3, picture.color.pixels.data());
    cv::cvtColor(mat, rgb, cv::COLOR_BGR2RGB);
  }
  return picture;
}

void require(bool holds, const char* what) {
  if (!holds) throw Error(std::string(what) + " failed");
}

Bytes write_ours(const Picture& picture) {
  thread_local PngEncoder encoder;
  const std::string_view png = picture.is_color() ? encoder.encode(picture.color) : encoder.encode(picture.depth);
  return Bytes(png.begin(), png.end());
}

void read_ours(const Bytes& png, const Picture& picture) {
  const std::optional<PngHeader> header = read_png_header(png);
  require(header && (picture.is_color() ? decode_png_grey(png, *header).index() == 0
                                        : decode_png_16(png, *header).index() == 0),
          "reading");
}

// What the rows of a PNG are before they are filtered.
Bytes rows_of(const Picture& picture) {
  if (picture.is_color()) return picture.color.pixels;
  Bytes bytes;
  bytes.reserve(2 * picture.depth.pixels.size());
  for (const std::uint16_t value : picture.depth.pixels) {
    bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
    bytes.push_back(static_cast<std::uint8_t>(value));
  }
  return bytes;
}

// A zlib stream, without the chunks around it: a few bytes and a checksum more.
Bytes write_libdeflate(const Picture& picture) {
  const std::size_t bytes = picture.row_bytes();
  const Bytes rows = rows_of(picture), zeros(bytes, 0);
  Bytes lines((bytes + 1) * static_cast<std::size_t>(picture.height()));
  const std::uint8_t* above = zeros.data();
  for (std::size_t y = 0; y < static_cast<std::size_t>(picture.height()); ++y) {
    std::uint8_t* line = lines.data() + y * (bytes + 1);
    line[0] = png_detail::kFilterPaeth;
    png_detail::filter_paeth_row(rows.data() + y * bytes, above, bytes, picture.pixel_bytes(), line + 1);
    above = rows.data() + y * bytes;
  }
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(1);
  Bytes out(libdeflate_zlib_compress_bound(compressor, lines.size()));
  out.resize(libdeflate_zlib_compress(compressor, lines.data(), lines.size(), out.data(), out.size()));
  libdeflate_free_compressor(compressor);
  require(!out.empty(), "libdeflate");
  return out;
}

void read_libdeflate(const Bytes& stream, const Picture& picture) {
  const std::size_t bytes = picture.row_bytes(), height = static_cast<std::size_t>(picture.height());
  Bytes lines((bytes + 1) * height + png_detail::kUnfilterPadding), zeros(bytes + png_detail::kUnfilterPadding, 0);
  libdeflate_decompressor* decompressor = libdeflate_alloc_decompressor();
  require(libdeflate_zlib_decompress(decompressor, stream.data(), stream.size(), lines.data(), (bytes + 1) * height,
                                     nullptr) == LIBDEFLATE_SUCCESS,
          "inflating");
  libdeflate_free_decompressor(decompressor);
  const std::uint8_t* above = zeros.data();
  for (std::size_t y = 0; y < height;) {
    y += png_detail::unfilter_rows(above, lines.data() + y * (bytes + 1), height - y, bytes, picture.pixel_bytes());
    above = lines.data() + (y - 1) * (bytes + 1) + 1;
  }
}

Bytes write_libspng(const Picture& picture) {
  spng_ctx* context = spng_ctx_new(SPNG_CTX_ENCODER);
  spng_set_option(context, SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_option(context, SPNG_IMG_COMPRESSION_LEVEL, 1);
  spng_set_option(context, SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_PAETH);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(picture.width());
  header.height = static_cast<std::uint32_t>(picture.height());
  header.color_type = picture.is_color() ? SPNG_COLOR_TYPE_TRUECOLOR : SPNG_COLOR_TYPE_GRAYSCALE;
  header.bit_depth = picture.is_color() ? 8 : 16;
  spng_set_ihdr(context, &header);
  const void* pixels = picture.is_color() ? static_cast<const void*>(picture.color.pixels.data())
                                          : static_cast<const void*>(picture.depth.pixels.data());
  const std::size_t size = picture.row_bytes() * static_cast<std::size_t>(picture.height());
  require(spng_encode_image(context, pixels, size, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE) == 0, "libspng's writer");
  std::size_t written = 0;
  int error = 0;
  void* png = spng_get_png_buffer(context, &written, &error);
  Bytes bytes(static_cast<std::uint8_t*>(png), static_cast<std::uint8_t*>(png) + written);
  std::free(png);
  spng_ctx_free(context);
  return bytes;
}

void read_libspng(const Bytes& png, const Picture& picture) {
  spng_ctx* context = spng_ctx_new(0);
  spng_set_png_buffer(context, png.data(), png.size());
  Bytes pixels(picture.row_bytes() * static_cast<std::size_t>(picture.height()));
  require(spng_decode_image(context, pixels.data(), pixels.size(), SPNG_FMT_PNG, 0) == 0, "libspng's reader");
  spng_ctx_free(context);
}

struct Way {
  const char* name;
  std::function<Bytes(const Picture&)> write;
  std::function<void(const Bytes&, const Picture&)> read;
  double write_s = 1e9, read_s = 1e9;
  std::size_t size = 0;
};

double cpu_s_of(const std::function<void()>& work) {
  const double start = cpu_s();
  work();
  return cpu_s() - start;
}

void measure(const std::vector<Picture>& pictures, int rounds, const char* name) {
  if (pictures.empty()) return;
  std::vector<Way> ways = {{"ours", write_ours, read_ours},
                           {"libdeflate 1", write_libdeflate, read_libdeflate},
                           {"libspng 1", write_libspng, read_libspng}};
  for (int round = 0; round < rounds; ++round) {
    for (Way& way : ways) {
      std::vector<Bytes> files(pictures.size());
      way.write_s = std::min(way.write_s, cpu_s_of([&] {
                               for (std::size_t i = 0; i < files.size(); ++i) files[i] = way.write(pictures[i]);
                             }));
      way.read_s = std::min(way.read_s, cpu_s_of([&] {
                              for (std::size_t i = 0; i < files.size(); ++i) way.read(files[i], pictures[i]);
                            }));
      way.size = 0;
      for (const Bytes& file : files) way.size += file.size();
    }
  }
  const double count = static_cast<double>(pictures.size()), ours = ways[0].write_s + ways[0].read_s;
  std::printf("%s, %zu images of %dx%d\n", name, pictures.size(), pictures[0].width(), pictures[0].height());
  for (const Way& way : ways)
    std::printf("  %-13s write %6.2f ms   read %6.2f ms   both %6.2f ms (%.2f of ours)   %7.1f kB an image\n", way.name,
                1e3 * way.write_s / count, 1e3 * way.read_s / count, 1e3 * (way.write_s + way.read_s) / count,
                (way.write_s + way.read_s) / ours, 1e-3 * static_cast<double>(way.size) / count);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_png FOLDER [rounds]\n");
    return 2;
  }
  try {
    std::vector<Picture> color, depth;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[1])) {
      if (entry.path().extension() != ".png") continue;
      Picture picture = load(entry.path());
      if (picture.is_color())
        color.push_back(std::move(picture));
      else if (!picture.depth.empty())
        depth.push_back(std::move(picture));
    }
    const int rounds = argc > 2 ? std::atoi(argv[2]) : 5;
    measure(color, rounds, "colour");
    measure(depth, rounds, "depth");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
