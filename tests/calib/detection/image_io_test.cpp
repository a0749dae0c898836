#include "rigproof/calib/vision/image_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "rigproof/core/random.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Smooth with some noise, so that an encoder that chooses filters uses several.
cv::Mat picture(int type, int width = 97, int height = 53) {
  cv::Mat mat(height, width, type);
  RandomStream random(1, "picture");
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width * mat.channels(); ++x) {
      const std::uint32_t value = static_cast<std::uint32_t>(3 * x + 2 * y) + random.below(5);
      if (mat.depth() == CV_16U)
        mat.ptr<std::uint16_t>(y)[x] = static_cast<std::uint16_t>(value * 37U);
      else
        mat.ptr<std::uint8_t>(y)[x] = static_cast<std::uint8_t>(value);
    }
  }
  return mat;
}

Bytes encoded(const std::string& extension, const cv::Mat& mat, const std::vector<int>& parameters = {}) {
  Bytes bytes;
  cv::imencode(extension, mat, bytes, parameters);
  return bytes;
}

template <typename Value>
std::string reason_of(const std::variant<Value, Unreadable>& read) {
  if (const auto* failure = std::get_if<Unreadable>(&read)) return failure->reason;
  return "read";
}

int largest_difference(const Image8& image, const cv::Mat& expected) {
  if (image.width != expected.cols || image.height != expected.rows) return 256;
  int largest = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      largest = std::max(largest, std::abs(image.at(x, y) - expected.at<std::uint8_t>(y, x)));
  return largest;
}

TEST(ReadGreyImage, AgreesWithOpenCv) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4}) {
    for (const int strategy : {cv::IMWRITE_PNG_STRATEGY_DEFAULT, cv::IMWRITE_PNG_STRATEGY_FILTERED}) {
      const cv::Mat mat = picture(type);
      const Bytes bytes = encoded(".png", mat, {cv::IMWRITE_PNG_COMPRESSION, 6, cv::IMWRITE_PNG_STRATEGY, strategy});
      const auto read = decode_grey_image(bytes);
      ASSERT_EQ(reason_of(read), "read");
      cv::Mat grey = mat;
      if (mat.channels() == 3) cv::cvtColor(mat, grey, cv::COLOR_BGR2GRAY);
      if (mat.channels() == 4) cv::cvtColor(mat, grey, cv::COLOR_BGRA2GRAY);
      EXPECT_LE(largest_difference(std::get<Image8>(read), grey), 1) << type;  // rounding of the weights
    }
  }
}

TEST(ReadGreyImage, ReadsJpegAndUnusualPngs) {
  const cv::Mat grey = picture(CV_8UC1);
  EXPECT_LE(largest_difference(std::get<Image8>(decode_grey_image(encoded(".jpg", grey))),
                               cv::imdecode(encoded(".jpg", grey), cv::IMREAD_GRAYSCALE)),
            0);
  const auto sixteen = decode_grey_image(encoded(".png", picture(CV_16UC1)));
  ASSERT_EQ(reason_of(sixteen), "read");
  EXPECT_EQ(std::get<Image8>(sixteen).width, 97);
  cv::Mat black_and_white = picture(CV_8UC1) > 100;
  const auto bilevel = decode_grey_image(encoded(".png", black_and_white, {cv::IMWRITE_PNG_BILEVEL, 1}));
  EXPECT_EQ(largest_difference(std::get<Image8>(bilevel), black_and_white), 0);
}

TEST(ReadDepthImage, KeepsEveryBit) {
  const cv::Mat depth = picture(CV_16UC1);
  const auto read = decode_depth_image(encoded(".png", depth));
  ASSERT_EQ(reason_of(read), "read");
  const Image16& image = std::get<Image16>(read);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) ASSERT_EQ(image.at(x, y), depth.at<std::uint16_t>(y, x));
  EXPECT_EQ(reason_of(decode_depth_image(encoded(".png", picture(CV_8UC1)))), "not a 16-bit grey PNG");
  EXPECT_EQ(reason_of(decode_depth_image(encoded(".jpg", picture(CV_8UC1)))), "not a PNG image");
}

TEST(ReadGreyImage, SaysWhatIsWrong) {
  const TempFolder folder;
  EXPECT_EQ(reason_of(read_grey_image(folder.path() / "none.png")), "file is missing");
  EXPECT_EQ(reason_of(read_grey_image(folder.path())), "not a regular file");
  EXPECT_EQ(reason_of(decode_grey_image(Bytes{'h', 'e', 'l', 'l', 'o'})), "not a PNG or JPEG image");
  Bytes png = encoded(".png", picture(CV_8UC3));
  EXPECT_EQ(reason_of(decode_grey_image(Bytes(png.begin(), png.end() - 200))), "truncated PNG");
  png[png.size() / 2] ^= 0x40U;
  EXPECT_EQ(reason_of(decode_grey_image(png)), "damaged PNG (checksum)");
  const Bytes jpeg = encoded(".jpg", picture(CV_8UC3));
  EXPECT_EQ(reason_of(decode_grey_image(Bytes(jpeg.begin(), jpeg.end() - 300))), "truncated JPEG");
}

// CRC-32 of a chunk, bit by bit (ISO/IEC 15948, annex D).
std::uint32_t crc_of(const std::uint8_t* data, std::size_t size) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (std::size_t i = 0; i < size; ++i) {
    crc ^= data[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

TEST(ReadGreyImage, RefusesHugeHeadersBeforeAllocating) {
  Bytes png = encoded(".png", picture(CV_8UC1));
  const auto promise = [&png](std::uint32_t width, std::uint32_t height) {
    for (std::size_t i = 0; i < 4; ++i) {
      png[16 + i] = static_cast<std::uint8_t>(width >> (24U - 8U * i));
      png[20 + i] = static_cast<std::uint8_t>(height >> (24U - 8U * i));
    }
    const std::uint32_t crc = crc_of(png.data() + 12, 17);
    for (std::size_t i = 0; i < 4; ++i) png[29 + i] = static_cast<std::uint8_t>(crc >> (24U - 8U * i));
  };
  promise(100000, 100000);
  EXPECT_EQ(reason_of(decode_grey_image(png)), "image of 100000x100000 is larger than 16384x16384");
  promise(16000, 16000);  // within the limit, but a few kilobytes cannot hold it
  EXPECT_EQ(reason_of(decode_grey_image(png)), "damaged PNG (fewer pixels than its header says)");
}

TEST(ReadImages, NoByteOfDamageThrows) {
  RandomStream random(2, "damage");
  for (const Bytes& good : {encoded(".png", picture(CV_8UC3, 23, 11)), encoded(".png", picture(CV_16UC1, 23, 11)),
                            encoded(".jpg", picture(CV_8UC3, 23, 11))}) {
    for (std::size_t size = 0; size < good.size(); ++size) {
      const Bytes cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_NO_THROW(decode_grey_image(cut));
      EXPECT_NO_THROW(decode_depth_image(cut));
      EXPECT_NO_THROW(decode_point_cloud(cut));
    }
    for (int trial = 0; trial < 500; ++trial) {
      Bytes damaged = good;
      for (int k = 0; k < 3; ++k)
        damaged[random.below(static_cast<std::uint32_t>(good.size()))] = static_cast<std::uint8_t>(random.below(256));
      EXPECT_NO_THROW(decode_grey_image(damaged));
      EXPECT_NO_THROW(decode_depth_image(damaged));
    }
  }
}

Bytes bytes_of(const std::string& text) { return Bytes(text.begin(), text.end()); }

void append(const void* data, std::size_t size, Bytes* bytes) {
  const auto* p = static_cast<const std::uint8_t*>(data);
  bytes->insert(bytes->end(), p, p + size);
}

std::string pcd_header(const std::string& data, int points) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\n"
         "COUNT 1 1 1 1\nWIDTH " +
         std::to_string(points) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) + "\nDATA " +
         data + "\n";
}

TEST(ReadPointCloud, ReadsText) {
  const auto read = decode_point_cloud(bytes_of("1 2 3\n# comment\n\n-0.5, 1e-1; 2.25 77 88\nnan nan nan\n"));
  ASSERT_EQ(reason_of(read), "read");
  EXPECT_THAT(std::get<std::vector<Eigen::Vector3f>>(read),
              testing::ElementsAre(Eigen::Vector3f(1.0F, 2.0F, 3.0F), Eigen::Vector3f(-0.5F, 0.1F, 2.25F)));
  EXPECT_EQ(reason_of(decode_point_cloud(bytes_of("1 2 3\n1 2\n"))), "line 2: must begin with three numbers");
  EXPECT_EQ(reason_of(decode_point_cloud(bytes_of("\n"))), "cloud without a point");
}

TEST(ReadPointCloud, ReadsEveryKindOfPcd) {
  const std::vector<Eigen::Vector3f> expected = {{1.0F, 2.0F, 3.0F}, {-4.0F, 5.5F, 6.0F}};
  const auto ascii = decode_point_cloud(bytes_of(pcd_header("ascii", 2) + "1 2 3 255\n-4 5.5 6 0\n"));
  ASSERT_EQ(reason_of(ascii), "read");
  EXPECT_EQ(std::get<std::vector<Eigen::Vector3f>>(ascii), expected);
  Bytes binary = bytes_of(pcd_header("binary", 2));
  const std::uint32_t color = 0;
  for (const Eigen::Vector3f& p : expected) {
    append(p.data(), 12, &binary);
    append(&color, 4, &binary);
  }
  EXPECT_EQ(std::get<std::vector<Eigen::Vector3f>>(decode_point_cloud(binary)), expected);
  binary.pop_back();
  EXPECT_EQ(reason_of(decode_point_cloud(binary)), "truncated cloud");
  // All x, all y, all z, all colours, in one LZF literal run.
  Bytes planes;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (const Eigen::Vector3f& p : expected) append(&p[axis], 4, &planes);
  for (int i = 0; i < 8; ++i) planes.push_back(0);
  Bytes compressed = bytes_of(pcd_header("binary_compressed", 2));
  // 24 literals, a literal zero, and a reference one byte back that repeats it seven times (length 7 = 5 + 2).
  Bytes lzf = {23};
  lzf.insert(lzf.end(), planes.begin(), planes.begin() + 24);
  for (const int byte : {0, 0, 5 << 5, 0}) lzf.push_back(static_cast<std::uint8_t>(byte));
  const std::array<std::uint32_t, 2> sizes = {static_cast<std::uint32_t>(lzf.size()),
                                              static_cast<std::uint32_t>(planes.size())};
  append(sizes.data(), 8, &compressed);
  compressed.insert(compressed.end(), lzf.begin(), lzf.end());
  const auto read = decode_point_cloud(compressed);
  ASSERT_EQ(reason_of(read), "read");
  EXPECT_EQ(std::get<std::vector<Eigen::Vector3f>>(read), expected);
  compressed.resize(compressed.size() - 2);
  EXPECT_EQ(reason_of(decode_point_cloud(compressed)), "truncated cloud");
  EXPECT_EQ(reason_of(decode_point_cloud(bytes_of("VERSION 0.7\nFIELDS a b\n"))), "damaged PCD (header)");
}

}  // namespace
}  // namespace rigproof
