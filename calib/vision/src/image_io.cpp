#include "rigproof/calib/vision/image_io.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/png/png_reader.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

// Largest image file read: 16k x 16k pixels of noise in 8-bit colour would be 805 MB, real images are far below.
constexpr std::uintmax_t kMaxImageFile = 512U << 20U;

std::variant<Bytes, Unreadable> read_bytes(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return Unreadable{"file is missing"};
  if (!fs::is_regular_file(file, error)) return Unreadable{"not a regular file"};
  try {
    Bytes bytes = read_binary_file(file, kMaxImageFile);
    if (bytes.empty()) return Unreadable{"file is empty"};
    return bytes;
  } catch (const Error& failure) {
    if (failure.exit_code() == ExitCode::kTryAgain) throw;  // of the machine and not of the image
    return Unreadable{failure.what()};
  }
}

template <typename Value, typename Decode>
std::variant<Value, Unreadable> read_and(const fs::path& file, Decode decode) {
  std::variant<Bytes, Unreadable> bytes = read_bytes(file);
  if (auto* failure = std::get_if<Unreadable>(&bytes)) return *failure;
  return decode(std::get<Bytes>(bytes));
}

std::string size_problem(std::uint32_t width, std::uint32_t height) {
  return "image of " + std::to_string(width) + "x" + std::to_string(height) + " is larger than " +
         std::to_string(kMaxImageSide) + "x" + std::to_string(kMaxImageSide);
}

bool too_large(std::uint32_t width, std::uint32_t height) {
  return width > static_cast<std::uint32_t>(kMaxImageSide) || height > static_cast<std::uint32_t>(kMaxImageSide);
}

struct Size {
  std::uint32_t width, height;
};

bool is_jpeg(const Bytes& bytes) {
  return bytes.size() > 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
}

// Size in the start-of-frame segment (ISO/IEC 10918-1, B.2.2).
std::optional<Size> jpeg_size(const Bytes& bytes) {
  const auto word = [&bytes](std::size_t i) { return (std::uint32_t{bytes[i]} << 8U) | bytes[i + 1]; };
  for (std::size_t at = 2; at + 9 < bytes.size();) {
    if (bytes[at] != 0xFF) return std::nullopt;
    const std::uint8_t marker = bytes[at + 1];
    if (marker == 0xFF) {
      ++at;
      continue;
    }
    const bool frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (frame) return Size{word(at + 7), word(at + 5)};
    if (marker == 0xD9 || marker == 0xDA) return std::nullopt;
    at += 2 + word(at + 2);
  }
  return std::nullopt;
}

// A block of 8x8 pixels takes at least one bit of a Huffman code; a header that promises more lies, and libjpeg would
// allocate for it and fill it with grey.
bool too_few_for(const Size& size, const Bytes& bytes) {
  return std::uint64_t{size.width} * size.height / (64 * 8) > bytes.size();
}

// libjpeg fills what a truncated file lacks with grey and only warns; the end marker tells.
bool jpeg_ends(const Bytes& bytes) {
  static constexpr std::uint8_t kEnd[] = {0xFF, 0xD9};
  const auto tail = bytes.end() - static_cast<std::ptrdiff_t>(std::min<std::size_t>(bytes.size(), 4096));
  return std::search(tail, bytes.end(), std::begin(kEnd), std::end(kEnd)) != bytes.end();
}

std::variant<Image8, Unreadable> decode_with_opencv(const Bytes& bytes) {
  cv::Mat decoded;
  try {
    decoded = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    return Unreadable{"damaged image"};
  }
  if (decoded.empty() || decoded.type() != CV_8UC1) return Unreadable{"damaged image"};
  Image8 image(decoded.cols, decoded.rows);
  for (int y = 0; y < decoded.rows; ++y) std::copy_n(decoded.ptr<std::uint8_t>(y), decoded.cols, image.row(y));
  return image;
}

std::variant<Image8, Unreadable> decode_png(const Bytes& bytes) {
  const std::optional<PngHeader> header = read_png_header(bytes);
  if (!header) return Unreadable{bytes.size() < 33 ? "truncated PNG" : "damaged PNG (header)"};
  if (too_large(header->width, header->height)) return Unreadable{size_problem(header->width, header->height)};
  if (header->is_plain() && header->bit_depth == 8) return decode_png_grey(bytes, *header);
  // OpenCV's decoder prints what it thinks of damaged files.
  if (const std::optional<Unreadable> damage = find_png_damage(bytes)) return *damage;
  return decode_with_opencv(bytes);
}

std::variant<Image8, Unreadable> decode_jpeg(const Bytes& bytes) {
  const std::optional<Size> size = jpeg_size(bytes);
  if (!size || size->width == 0 || size->height == 0) return Unreadable{"damaged JPEG (header)"};
  if (too_large(size->width, size->height)) return Unreadable{size_problem(size->width, size->height)};
  if (!jpeg_ends(bytes)) return Unreadable{"truncated JPEG"};
  if (too_few_for(*size, bytes)) return Unreadable{"damaged JPEG (fewer pixels than its header says)"};
  return decode_with_opencv(bytes);
}

}  // namespace

std::variant<Image8, Unreadable> decode_grey_image(const Bytes& bytes) {
  if (is_png(bytes)) return decode_png(bytes);
  if (is_jpeg(bytes)) return decode_jpeg(bytes);
  return Unreadable{"not a PNG or JPEG image"};
}

std::variant<Image16, Unreadable> decode_depth_image(const Bytes& bytes) {
  if (!is_png(bytes)) return Unreadable{"not a PNG image"};
  const std::optional<PngHeader> header = read_png_header(bytes);
  if (!header) return Unreadable{bytes.size() < 33 ? "truncated PNG" : "damaged PNG (header)"};
  if (too_large(header->width, header->height)) return Unreadable{size_problem(header->width, header->height)};
  if (header->bit_depth != 16 || header->color_type != 0 || header->interlaced)
    return Unreadable{"not a 16-bit grey PNG"};
  return decode_png_16(bytes, *header);
}

std::variant<Image8, Unreadable> read_grey_image(const fs::path& file) {
  return read_and<Image8>(file, decode_grey_image);
}

std::variant<Image16, Unreadable> read_depth_image(const fs::path& file) {
  return read_and<Image16>(file, decode_depth_image);
}

std::variant<std::vector<Eigen::Vector3f>, Unreadable> read_point_cloud(const fs::path& file) {
  return read_and<std::vector<Eigen::Vector3f>>(file, decode_point_cloud);
}

}  // namespace rigproof
