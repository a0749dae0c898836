// What is written is what standard readers read, and what is read is what was written, bit by bit.
#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/core/random.h"
#include "rigproof/png/png_encoder.h"
#include "rigproof/png/png_reader.h"
#include "row_filters.h"

namespace rigproof {
namespace {

using Bytes = std::vector<std::uint8_t>;

enum class Content { kFlat, kSmooth, kNoise, kPatches };

// Rows whose differences to the row above are runs of every length, with noise in between.
template <typename Pixel>
Image<Pixel> make_patches(int width, int height, int channels) {
  Image<Pixel> image(width, height, channels);
  RandomStream random(2, "patches");
  const std::size_t row = image.row_length();
  for (std::size_t i = 0; i < image.pixels.size();) {
    const std::size_t run = random.next_u32() % 600, noise = random.next_u32() % 20;
    const auto step = static_cast<Pixel>(random.next_u32() % 3);
    for (std::size_t k = 0; k < run + noise && i < image.pixels.size(); ++k, ++i) {
      const Pixel above = i < row ? Pixel{0} : image.pixels[i - row];
      image.pixels[i] = static_cast<Pixel>(above + (k < run ? step : random.next_u32()));
    }
  }
  return image;
}

template <typename Pixel>
Image<Pixel> make_image(int width, int height, int channels, Content content) {
  if (content == Content::kPatches) return make_patches<Pixel>(width, height, channels);
  Image<Pixel> image(width, height, channels);
  RandomStream random(1, "image");
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const std::uint32_t value = content == Content::kFlat     ? 77U
                                : content == Content::kSmooth ? static_cast<std::uint32_t>(i / 3)
                                                              : random.next_u32();
    image.pixels[i] = static_cast<Pixel>(value);
  }
  return image;
}

cv::Mat decode(std::string_view png) {
  const cv::Mat bytes(1, static_cast<int>(png.size()), CV_8U, const_cast<char*>(png.data()));
  return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
}

template <typename Pixel>
void expect_same(const Image<Pixel>& image, const cv::Mat& decoded) {
  ASSERT_EQ(decoded.cols, image.width);
  ASSERT_EQ(decoded.rows, image.height);
  ASSERT_EQ(decoded.channels(), image.channels);
  ASSERT_EQ(decoded.elemSize1(), sizeof(Pixel));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < image.channels; ++c) {
        const int opencv_channel = image.channels == 3 ? 2 - c : c;  // OpenCV stores BGR
        ASSERT_EQ(decoded.ptr<Pixel>(y)[x * image.channels + opencv_channel], image.at(x, y, c)) << x << ' ' << y;
      }
    }
  }
}

TEST(PngEncoder, StandardReaderGetsTheSamePixels) {
  PngEncoder encoder;  // one for all: what an image leaves behind must not reach the next
  for (const Content content : {Content::kNoise, Content::kFlat, Content::kSmooth, Content::kPatches}) {
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {641, 479}, {1280, 720}, {70000, 2}}) {
      SCOPED_TRACE(testing::Message() << width << "x" << height);
      expect_same(make_image<std::uint8_t>(width, height, 3, content),
                  decode(encoder.encode(make_image<std::uint8_t>(width, height, 3, content))));
      expect_same(make_image<std::uint8_t>(width, height, 1, content),
                  decode(encoder.encode(make_image<std::uint8_t>(width, height, 1, content))));
      expect_same(make_image<std::uint16_t>(width, height, 1, content),
                  decode(encoder.encode(make_image<std::uint16_t>(width, height, 1, content))));
    }
  }
}

TEST(PngEncoder, SameImageGivesSameBytesWhateverCameBefore) {
  PngEncoder fresh, used;
  const Image8 image = make_image<std::uint8_t>(320, 200, 3, Content::kSmooth);
  used.encode(make_image<std::uint8_t>(1280, 720, 3, Content::kNoise));
  used.encode(make_image<std::uint16_t>(64, 64, 1, Content::kNoise));
  EXPECT_EQ(std::string(fresh.encode(image)), std::string(used.encode(image)));
}

TEST(PngEncoder, RefusesWhatPngCannotHold) {
  PngEncoder encoder;
  EXPECT_THROW(encoder.encode(Image8()), Error);
  EXPECT_THROW(encoder.encode(Image8(4, 4, 2)), Error);
  EXPECT_THROW(encoder.encode(Image16(4, 4, 3)), Error);
}

TEST(PngReader, ReadsWhatTheEncoderWrites) {
  PngEncoder encoder;
  for (const Content content : {Content::kNoise, Content::kSmooth, Content::kPatches}) {
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {64, 7}, {641, 479}}) {
      SCOPED_TRACE(testing::Message() << width << "x" << height);
      const Image16 depth = make_image<std::uint16_t>(width, height, 1, content);
      const Image8 grey = make_image<std::uint8_t>(width, height, 1, content);
      const std::string_view png = encoder.encode(depth);
      const Bytes depth_file(png.begin(), png.end());
      EXPECT_EQ(std::get<Image16>(decode_png_16(depth_file, read_png_header(depth_file).value())).pixels, depth.pixels);
      const std::string_view grey_png = encoder.encode(grey);
      const Bytes grey_file(grey_png.begin(), grey_png.end());
      EXPECT_EQ(std::get<Image8>(decode_png_grey(grey_file, read_png_header(grey_file).value())).pixels, grey.pixels);
      const Image8 color = make_image<std::uint8_t>(width, height, 3, content);
      const std::string_view color_png = encoder.encode(color);
      const Bytes color_file(color_png.begin(), color_png.end());
      EXPECT_EQ(std::get<Image8>(decode_png_rgb(color_file, read_png_header(color_file).value())).pixels, color.pixels);
    }
  }
}

// The standard's own words (9.2), byte by byte.
void unfilter_plainly(std::uint8_t* row, const std::uint8_t* above, int filter, std::size_t bytes, std::size_t step) {
  for (std::size_t i = 0; i < bytes; ++i) {
    const int a = i < step ? 0 : row[i - step], b = above[i], c = i < step ? 0 : above[i - step], p = a + b - c;
    const int to_a = std::abs(p - a), to_b = std::abs(p - b), to_c = std::abs(p - c);
    const int nearest = to_a <= to_b && to_a <= to_c ? a : to_b <= to_c ? b : c;
    const int predictions[] = {0, a, b, (a + b) / 2, nearest};
    row[i] = static_cast<std::uint8_t>(row[i] + predictions[filter]);
  }
}

// Pixels of every size, and numbers of rows and columns around those that are done at once; Paeth alone and mixed.
TEST(RowFilters, AreTakenOffAsTheStandardSays) {
  RandomStream random(1, "rows");
  for (const bool mixed : {false, true})
    for (const std::size_t step : {1U, 2U, 3U, 4U, 6U, 8U})
      for (const std::size_t width : {1U, 2U, 3U, 7U, 8U, 9U, 40U})
        for (const std::size_t height : {1U, 2U, 3U, 4U, 7U, 8U, 9U, 17U}) {
          const std::size_t bytes = step * width, pitch = bytes + 1;
          Bytes lines(pitch * height + png_detail::kUnfilterPadding), zeros(bytes + png_detail::kUnfilterPadding, 0);
          for (std::uint8_t& byte : lines) byte = static_cast<std::uint8_t>(random.next_u32());
          for (std::size_t y = 0; y < height; ++y)
            lines[y * pitch] = static_cast<std::uint8_t>(mixed && random.below(3) == 0 ? random.below(5) : 4);
          Bytes expected = lines;
          for (std::size_t y = 0; y < height; ++y)
            unfilter_plainly(&expected[y * pitch + 1], y == 0 ? zeros.data() : &expected[(y - 1) * pitch + 1],
                             expected[y * pitch], bytes, step);
          for (std::size_t y = 0, done = 1; y < height && done > 0; y += done)
            done = png_detail::unfilter_rows(y == 0 ? zeros.data() : &lines[(y - 1) * pitch + 1], &lines[y * pitch],
                                             height - y, bytes, step);
          ASSERT_EQ(lines, expected) << step << " bytes, " << width << "x" << height << (mixed ? ", mixed" : "");
        }
  Bytes unknown(64, 9);
  EXPECT_EQ(png_detail::unfilter_rows(unknown.data(), unknown.data(), 1, 8, 1), 0U);
}

}  // namespace
}  // namespace rigproof
