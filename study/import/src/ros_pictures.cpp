#include "ros_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>
#include <vector>

#include "rigproof/bags/messages.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/png/png_reader.h"
#include "rvl.h"
#include "topic_names.h"

namespace rigproof {
namespace {

using Bytes = std::vector<std::uint8_t>;

// How an encoding of sensor_msgs/image_encodings.hpp becomes grey or RGB: channels, bytes of each, and OpenCV's code.
struct Layout {
  int channels = 1;
  int channel_bytes = 1;
  int to_rgb = -1;  // -1: it is grey or RGB already
};

const std::map<std::string, Layout>& layouts() {
  // OpenCV names Bayer patterns by the second row's second and third pixel.
  static const std::map<std::string, Layout> all = {
      {"rgb8", {3, 1, -1}},
      {"bgr8", {3, 1, cv::COLOR_BGR2RGB}},
      {"8UC3", {3, 1, cv::COLOR_BGR2RGB}},
      {"rgba8", {4, 1, cv::COLOR_RGBA2RGB}},
      {"bgra8", {4, 1, cv::COLOR_BGRA2RGB}},
      {"8UC4", {4, 1, cv::COLOR_BGRA2RGB}},
      {"mono8", {1, 1, -1}},
      {"8UC1", {1, 1, -1}},
      {"mono16", {1, 2, -1}},
      {"16UC1", {1, 2, -1}},
      {"32FC1", {1, 4, -1}},
      {"bayer_rggb8", {1, 1, cv::COLOR_BayerBG2RGB}},
      {"bayer_bggr8", {1, 1, cv::COLOR_BayerRG2RGB}},
      {"bayer_gbrg8", {1, 1, cv::COLOR_BayerGR2RGB}},
      {"bayer_grbg8", {1, 1, cv::COLOR_BayerGB2RGB}},
      {"yuv422", {2, 1, cv::COLOR_YUV2RGB_UYVY}},
      {"uyvy", {2, 1, cv::COLOR_YUV2RGB_UYVY}},
      {"yuv422_yuy2", {2, 1, cv::COLOR_YUV2RGB_YUY2}},
      {"yuyv", {2, 1, cv::COLOR_YUV2RGB_YUY2}},
  };
  return all;
}

Layout layout_of(const RosImage& image) {
  const auto found = layouts().find(image.encoding);
  if (found != layouts().end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [name, layout] : layouts()) known.push_back(name);
  throw Error("the encoding \"" + for_message(image.encoding) + "\" cannot be read; " +
              suggestion(image.encoding, known));
}

// Checks sizes before anything looks at pixels.
void check_size(const RosImage& image, const Layout& layout) {
  const auto row = std::uint64_t{image.width} * static_cast<std::uint64_t>(layout.channels * layout.channel_bytes);
  const auto most = static_cast<std::uint32_t>(kMaxImageSide);
  const std::string size = std::to_string(image.width) + "x" + std::to_string(image.height);
  if (image.width == 0 || image.height == 0 || image.width > most || image.height > most)
    throw Error("an image of " + size + "; 1x1 to " + std::to_string(most) + "x" + std::to_string(most) +
                " are allowed");
  if (image.step < row || image.data.size() < std::uint64_t{image.step} * (image.height - 1) + row)
    throw Error("an image of " + size + " " + for_message(image.encoding) + " with rows of " +
                std::to_string(image.step) + " bytes in " + std::to_string(image.data.size()) + " bytes");
}

const std::uint8_t* row_of(const RosImage& image, int y) {
  return reinterpret_cast<const std::uint8_t*>(image.data.data()) + static_cast<std::size_t>(y) * image.step;
}

// Words of 16 bits in this machine's order, which is little-endian.
Image16 words_of(const RosImage& image) {
  Image16 words(static_cast<int>(image.width), static_cast<int>(image.height));
  for (int y = 0; y < words.height; ++y) {
    std::memcpy(words.row(y), row_of(image, y), words.row_length() * sizeof(std::uint16_t));
    if (image.is_bigendian)
      std::transform(words.row(y), words.row(y) + words.width, words.row(y),
                     [](std::uint16_t word) { return static_cast<std::uint16_t>((word << 8U) | (word >> 8U)); });
  }
  return words;
}

// Cameras of 10 or 12 bits fill the low ones: shifted up, so that the bits that count are the high ones.
Image16 filled(Image16 image) {
  const std::uint16_t highest = *std::max_element(image.pixels.begin(), image.pixels.end());
  unsigned shift = 0;
  for (const unsigned bits : {8U, 10U, 12U, 14U})
    if (shift == 0 && highest < (1U << bits)) shift = 16U - bits;
  for (std::uint16_t& pixel : image.pixels) pixel = static_cast<std::uint16_t>(pixel << shift);
  return image;
}

Image8 pixels_of(const RosImage& image, const Layout& layout) {
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  if ((layout.channels == 2 && width % 2 != 0) || (image.encoding.rfind("bayer", 0) == 0 && (width < 4 || height < 4)))
    throw Error("an image of " + std::to_string(width) + "x" + std::to_string(height) + " " + image.encoding);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): a header over pixels that are only read
  auto* const data = const_cast<std::uint8_t*>(row_of(image, 0));
  const cv::Mat packed(height, width, CV_MAKETYPE(CV_8U, layout.channels), data, image.step);
  Image8 result(width, height, layout.to_rgb < 0 ? layout.channels : 3);
  cv::Mat target(height, width, CV_MAKETYPE(CV_8U, result.channels), result.pixels.data());
  if (layout.to_rgb < 0)
    packed.copyTo(target);
  else
    cv::cvtColor(packed, target, layout.to_rgb);
  return result;
}

Bytes bytes_of(std::string_view view) { return {view.begin(), view.end()}; }

// compressedDepth: a header of 12 bytes before the picture (compressed_depth_image_transport).
constexpr std::size_t kDepthHead = 12;

bool is_rvl(const std::string& format) { return format.find("rvl") != std::string::npos; }

bool is_compressed_depth(const std::string& topic, const std::string& format) {
  return format.find("compressedDepth") != std::string::npos || parts_of(topic).back() == "compressedDepth";
}

// Float depth is quantised in 1/z: z = a / (value - b).
struct DepthQuantisation {
  float a = 0.0F, b = 0.0F;
};
DepthQuantisation quantisation_of(std::string_view data) {
  DepthQuantisation q;
  std::memcpy(&q.a, data.data() + 4, sizeof q.a);
  std::memcpy(&q.b, data.data() + 8, sizeof q.b);
  return q;
}

std::uint16_t counts(double depth_m, double unit_m) {
  const double value = std::round(depth_m / unit_m);
  return value >= 1.0 && value <= 65535.0 ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
}

double metres_at(const RosImage& image, int x, int y) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, row_of(image, y) + 4 * static_cast<std::size_t>(x), sizeof bits);
  if (image.is_bigendian) bits = __builtin_bswap32(bits);
  float metres = 0.0F;
  std::memcpy(&metres, &bits, sizeof metres);
  return static_cast<double>(metres);
}

Image16 depth_of_floats(const RosImage& image, double unit_m) {
  Image16 depth(static_cast<int>(image.width), static_cast<int>(image.height));
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const double metres = metres_at(image, x, y);
      depth.at(x, y) = std::isfinite(metres) ? counts(metres, unit_m) : std::uint16_t{0};
    }
  }
  return depth;
}

std::set<double> distinct_metres(const RosImage& image) {
  std::set<double> all;
  for (int y = 0; y < static_cast<int>(image.height); ++y)
    for (int x = 0; x < static_cast<int>(image.width); ++x)
      if (const double metres = metres_at(image, x, y); std::isfinite(metres) && metres > 0.0) all.insert(metres);
  return all;
}

// But for the rounding of whoever multiplied counts by the unit in single precision.
bool is_multiple(double metres, double unit_m) {
  constexpr double kRounding = 1.0 / (1 << 22);
  return std::abs(metres - unit_m * std::round(metres / unit_m)) <= kRounding * metres;
}

Image16 decoded_depth(std::string_view png) {
  auto decoded = decode_depth_image(bytes_of(png));
  if (const auto* failure = std::get_if<Unreadable>(&decoded)) throw Error("depth: " + failure->reason);
  return std::get<Image16>(std::move(decoded));
}

PictureKind kind_of_compressed(const std::string& topic, std::string_view message) {
  const RosCompressedImage image = read_compressed_image(message);
  PictureKind kind;
  const bool depth = is_compressed_depth(topic, image.format);
  const std::string_view picture = depth ? image.data.substr(std::min(kDepthHead, image.data.size())) : image.data;
  const std::optional<PngHeader> png = read_png_header(bytes_of(picture.substr(0, 64)));
  if (depth && is_rvl(image.format)) {
    const RvlSize size = read_rvl_size(picture);
    const bool floats = image.format.rfind("32FC1", 0) == 0;
    return {floats ? "compressedDepth 32FC1" : "compressedDepth", true, size.width, size.height};
  }
  if (png) {
    kind.encoding = depth ? (image.format.rfind("32FC1", 0) == 0 ? "compressedDepth 32FC1" : "compressedDepth") : "png";
    kind.width = static_cast<int>(png->width);
    kind.height = static_cast<int>(png->height);
    kind.is_depth = depth || (png->bit_depth == 16 && is_side_product(topic));
  } else {
    kind.encoding = picture.substr(0, 3) == "\xFF\xD8\xFF" ? "jpeg" : for_message(image.format);
    kind.is_depth = depth;
  }
  return kind;
}

// As grey, or as RGB.
Image8 decoded_color(std::string_view data) {
  cv::Mat picture = cv::imdecode(bytes_of(data), cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION);
  if (picture.empty()) throw Error("a compressed image that cannot be decoded");
  if (picture.channels() == 3) cv::cvtColor(picture, picture, cv::COLOR_BGR2RGB);
  Image8 image(picture.cols, picture.rows, picture.channels());
  picture.copyTo(cv::Mat(picture.rows, picture.cols, picture.type(), image.pixels.data()));
  return image;
}

PictureFile checked_picture(std::string_view data) {
  const Bytes bytes = bytes_of(data);
  const auto grey = decode_grey_image(bytes);
  if (const auto* failure = std::get_if<Unreadable>(&grey)) throw Error("a compressed image: " + failure->reason);
  const auto& image = std::get<Image8>(grey);
  return {is_png(bytes) ? ".png" : ".jpg", data, image.width, image.height};
}

}  // namespace

double depth_unit_m(const std::string& encoding) { return encoding.find("32FC1") != std::string::npos ? 1e-4 : 1e-3; }

std::optional<double> unit_of_metres(std::string_view message) {
  constexpr std::size_t kFewest = 32;  // values that would be multiples of a tenth by chance once in 1e32 times
  constexpr std::array<double, 5> kUnits = {1e-3, 5e-4, 2.5e-4, 2e-4, 1.25e-4};
  std::set<double> metres;
  try {
    const RosImage image = read_image(message);
    check_size(image, layout_of(image));
    metres = distinct_metres(image);
  } catch (const Error&) {
    return std::nullopt;
  }
  if (metres.size() < kFewest) return std::nullopt;
  for (const double unit_m : kUnits)
    if (std::all_of(metres.begin(), metres.end(), [unit_m](double value) { return is_multiple(value, unit_m); }))
      return unit_m;
  return depth_unit_m("32FC1");
}

PictureKind kind_of_picture(const std::string& type, const std::string& topic, std::string_view message) {
  if (type == kCompressedImageType) return kind_of_compressed(topic, message);
  if (type == kPointCloudType) return {"points", true, 0, 0};
  const RosImage image = read_image(message);
  const bool counts16 = image.encoding == "16UC1" || image.encoding == "mono16";
  return {image.encoding,
          image.encoding == "32FC1" || image.encoding == "16UC1" || (counts16 && is_side_product(topic)),
          static_cast<int>(std::min<std::uint32_t>(image.width, 1U << 20U)),
          static_cast<int>(std::min<std::uint32_t>(image.height, 1U << 20U))};
}

PictureFile PictureMaker::encoded(const Image8& image) {
  return {".png", encoder_.encode(image), image.width, image.height};
}

PictureFile PictureMaker::encoded(const Image16& image) {
  return {".png", encoder_.encode(image), image.width, image.height};
}

PictureFile PictureMaker::color(const std::string& type, std::string_view message, const Rectifier* rectifier) {
  if (type == kCompressedImageType) {
    const std::string_view data = read_compressed_image(message).data;
    const PictureFile file = checked_picture(data);
    return rectifier == nullptr ? file : encoded(rectifier->color(decoded_color(data)));
  }
  const RosImage image = read_image(message);
  const Layout layout = layout_of(image);
  check_size(image, layout);
  if (layout.channel_bytes == 4) throw Error("the encoding 32FC1 is depth, no picture");
  if (layout.channel_bytes == 2) {
    const Image16 words = filled(words_of(image));
    return encoded(rectifier == nullptr ? words : rectifier->color(words));
  }
  const Image8 pixels = pixels_of(image, layout);
  return encoded(rectifier == nullptr ? pixels : rectifier->color(pixels));
}

PictureFile PictureMaker::rectified_depth(const PictureFile& file, const Rectifier& rectifier) {
  return encoded(rectifier.depth(decoded_depth(file.bytes)));
}

PictureFile PictureMaker::depth(const std::string& type, std::string_view message, double unit_m,
                                const Rectifier* rectifier) {
  if (rectifier != nullptr) return rectified_depth(depth(type, message, unit_m), *rectifier);
  if (type == kCompressedImageType) {
    const RosCompressedImage compressed = read_compressed_image(message);
    const bool plain_png = compressed.data.substr(0, 4) == "\x89PNG";
    if (!plain_png && compressed.data.size() < kDepthHead) throw Error("depth that ends early");
    const std::string_view coded = plain_png ? compressed.data : compressed.data.substr(kDepthHead);
    const bool rvl = !plain_png && is_rvl(compressed.format);
    Image16 image = rvl ? decode_rvl(coded) : decoded_depth(coded);
    if (compressed.format.rfind("32FC1", 0) != 0 || plain_png)
      return rvl ? encoded(image) : PictureFile{".png", coded, image.width, image.height};
    const DepthQuantisation q = quantisation_of(compressed.data);
    for (std::uint16_t& pixel : image.pixels)
      pixel = pixel == 0
                  ? std::uint16_t{0}
                  : counts(static_cast<double>(q.a) / (static_cast<double>(pixel) - static_cast<double>(q.b)), unit_m);
    return encoded(image);
  }
  const RosImage image = read_image(message);
  const Layout layout = layout_of(image);
  check_size(image, layout);
  if (layout.channel_bytes == 4) return encoded(depth_of_floats(image, unit_m));
  if (layout.channel_bytes != 2)
    throw Error("the encoding \"" + for_message(image.encoding) + "\" is no depth; 16UC1 and 32FC1 are");
  return encoded(words_of(image));
}

}  // namespace rigproof
