// The parts of an import: names, frames, lenses, pictures, and which images are kept.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "bag_bytes.h"
#include "error_text.h"
#include "frame_choice.h"
#include "ground_track.h"
#include "rectifier.h"
#include "rigproof/bags/messages.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/core/camera_info.h"
#include "rigproof/core/conventions.h"
#include "rigproof/formats/frame_tree.h"
#include "ros_cloud.h"
#include "ros_pictures.h"
#include "topic_names.h"

namespace rigproof {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(TopicNames, CamerasAreCalledByWhatTellsThemApart) {
  EXPECT_THAT(camera_names({"/left/image_raw/compressed", "/right/image_raw/compressed"}),
              ElementsAre("left", "right"));
  EXPECT_THAT(camera_names({"/robot/front/color/image_raw", "/robot/rear/color/image_raw"}),
              ElementsAre("front", "rear"));
  EXPECT_THAT(camera_names({"/camera/camera/color/image_raw"}), ElementsAre("camera"));
  EXPECT_THAT(camera_names({"/camera_front/color/image_raw", "/a b/image"}), ElementsAre("camera_front", "a_b"));
  EXPECT_THAT(camera_names({"/image", "/camera/image"}), ElementsAre("camera", "camera_image"));
  EXPECT_EQ(namespace_of("/left/image_raw/compressed"), "/left");
  EXPECT_EQ(namespace_of("/image_raw"), "");
  EXPECT_EQ(place_in("/cams/left_image_rect/compressed"), "left");
  EXPECT_EQ(place_in("/cams/camera_info_rear_2"), "rear_2");
  EXPECT_EQ(place_in("/left/image_rect_color"), "");
  EXPECT_TRUE(is_rectified("/left/image_rect_color/compressed"));
  EXPECT_FALSE(is_rectified("/rect/image_raw"));
  EXPECT_TRUE(is_side_product("/camera/infra1/image_rect_raw"));
  EXPECT_FALSE(is_side_product("/camera/color/image_raw"));
}

FrameTree tree_of(const std::vector<TransformFields>& transforms) {
  FrameTree tree;
  for (const RosTransform& transform : read_tf_message(tf_message(0.0, transforms)))
    tree.add(transform.header.frame_id, transform.child_frame_id, transform.T_parent_child);
  return tree;
}

TEST(FrameTree, ComposesAndFindsTheMountLink) {
  const FrameTree tree = tree_of({{"base_footprint", "base_link", {0, 0, 0.1, 0, 0, 0, 1}},
                                  {"base_link", "left_link", {0.3, 0.2, 0.5, 0, 0, 0, 1}},
                                  {"left_link", "left_color_frame", {0, 0.015, 0, 0, 0, 0, 1}},
                                  {"left_color_frame", "left_optical", {0, 0, 0, -0.5, 0.5, -0.5, 0.5}},
                                  {"base_link", "mast", {}},
                                  {"mast", "eye_optical", {}}});
  const auto T = tree.between("base_footprint", "left_optical");
  ASSERT_TRUE(T);
  EXPECT_NEAR((T->translation - Eigen::Vector3d(0.3, 0.215, 0.6)).norm(), 0.0, 1e-12);
  EXPECT_FALSE(tree.between("base_link", "nowhere"));
  EXPECT_EQ(tree.mount_link("left_optical", {"base_link"}), "left_link");
  EXPECT_EQ(tree.mount_link("eye_optical", {"base_link"}), "mast");
}

TEST(FrameTree, LoopsAndSecondParentsAreNamed) {
  const FrameTree loop = tree_of({{"a", "b", {}}, {"b", "c", {}}, {"c", "a", {}}});
  EXPECT_THAT(error_text([&] { loop.between("a", "c"); }), HasSubstr("circle"));
  const FrameTree two = tree_of({{"a", "c", {}}, {"b", "c", {}}});
  EXPECT_THAT(error_text([&] { two.way_up("c"); }), HasSubstr("two parents, a and b"));
}

// ---------------------------------------------------------------------------------------------------------- lenses

InfoFields some_info() {
  InfoFields info;
  info.width = 1280;
  info.height = 720;
  info.k = {640, 0, 641, 0, 642, 359, 0, 0, 1};
  info.p = {600, 0, 630, 0, 0, 601, 350, 0, 0, 0, 1, 0};
  return info;
}

InfoReading read_info(const InfoFields& info, bool rectified = false) {
  return camera_of_info(read_camera_info_message(info_message(info)), rectified);
}

TEST(CameraOfInfo, PlainLensesAndRectifiedOnes) {
  InfoFields info = some_info();
  EXPECT_EQ(read_info(info).camera.lens, Lens::kPinhole);
  info.d = {0.1, -0.2, 0.001, 0.002};  // four of plumb_bob, as some drivers have it
  const Camera brown = read_info(info).camera;
  EXPECT_EQ(brown.lens, Lens::kBrownConrady);
  EXPECT_THAT(brown.distortion, ElementsAre(0.1, -0.2, 0.001, 0.002, 0.0));
  const InfoReading rectified = read_info(info, true);
  EXPECT_EQ(rectified.camera.lens, Lens::kPinhole);
  EXPECT_EQ(rectified.camera.fx_px, 600.0);
  EXPECT_EQ(rectified.camera.cy_px, 350.0);
  EXPECT_THAT(rectified.notes, ElementsAre(HasSubstr("matrix P")));
  info.model = "equidistant";
  EXPECT_EQ(read_info(info).camera.lens, Lens::kKannalaBrandt);
  info.model = "rational_polynomial";
  info.d = {0.1, -0.2, 0.001, 0.002, 0.3, 0, 0, 0};
  EXPECT_EQ(read_info(info).camera.lens, Lens::kBrownConrady);
}

// The definition of the message: super-pixels of binning_x by binning_y pixels, inside of a region of the full sensor.
TEST(CameraOfInfo, BinningAndRegion) {
  InfoFields info = some_info();
  info.x_offset = 100;
  info.y_offset = 60;
  info.roi_width = 800;
  info.roi_height = 600;
  info.binning_x = info.binning_y = 2;
  const Camera camera = read_info(info).camera;
  EXPECT_EQ(camera.width_px, 400);
  EXPECT_EQ(camera.height_px, 300);
  EXPECT_EQ(camera.fx_px, 320.0);
  // Full pixel 541 lies at (541 - 100 - 0.5) / 2 among super-pixels, of which number 0 has its centre at 0.5.
  EXPECT_EQ(camera.cx_px, (641.0 - 100.0 - 0.5) / 2.0);
  EXPECT_EQ(camera.cy_px, (359.0 - 60.0 - 0.5) / 2.0);
}

// Coefficients as an Azure Kinect's colour camera has them; what we write must meet OpenCV's own projection. Over all
// of its wide view no lens of ours does, and its images are to be rectified.
TEST(CameraOfInfo, RationalLensIsMetByOneOfOurs) {
  InfoFields info = some_info();
  info.model = "rational_polynomial";
  info.d = {0.5167, -2.6213, 0.00050, -0.00022, 1.5046, 0.3942, -2.4370, 1.4315};
  const InfoReading wide = read_info(info);
  EXPECT_THAT(wide.notes, ElementsAre(HasSubstr("images are rectified")));
  EXPECT_EQ(wide.to_undo, info.d);
  EXPECT_EQ(wide.camera.lens, Lens::kPinhole);
  info.k[0] = info.k[4] = 970;
  const InfoReading reading = read_info(info);
  EXPECT_THAT(reading.notes, ElementsAre(HasSubstr("rational_polynomial is written as")));
  std::vector<cv::Point3d> rays;
  for (double y = -0.34; y <= 0.34; y += 0.04)
    for (double x = -0.6; x <= 0.6; x += 0.04) rays.emplace_back(x, y, 1.0);
  std::vector<cv::Point2d> pixels;
  const cv::Matx33d K(970, 0, 641, 0, 970, 359, 0, 0, 1);
  cv::projectPoints(rays, cv::Vec3d(), cv::Vec3d(), K, info.d, pixels);
  double worst = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Eigen::Vector2d pixel;
    ASSERT_TRUE(reading.camera.project({rays[i].x, rays[i].y, 1.0}, &pixel));
    worst = std::max(worst, (pixel - Eigen::Vector2d(pixels[i].x, pixels[i].y)).norm());
  }
  EXPECT_LT(worst, 0.25);  // what the import promises
}

TEST(CameraOfInfo, WhatIsNoCalibrationIsRefused) {
  InfoFields zero = some_info();
  zero.k = std::vector<double>(9, 0.0);
  EXPECT_THAT(error_text([&] { read_info(zero); }), HasSubstr("not calibrated"));
  InfoFields unknown = some_info();
  unknown.model = "thin_prism_fisheye";
  unknown.d = {0.1, 0, 0, 0};
  EXPECT_THAT(error_text([&] { read_info(unknown); }), HasSubstr("not supported"));
  InfoFields prism = some_info();
  prism.model = "rational_polynomial";
  prism.d = std::vector<double>(12, 0.01);
  EXPECT_THAT(error_text([&] { read_info(prism); }), HasSubstr("coefficients"));
  InfoFields bent = some_info();
  bent.model = "rational_polynomial";
  bent.d = {-3.0, 0, 0, 0, 0, 0.5, 0, 0};
  EXPECT_THAT(error_text([&] { read_info(bent); }), HasSubstr("back into itself"));
}

// Spots where OpenCV projects them through a wide lens are, rectified, where a pinhole has them; depth stays what it
// is.
TEST(Rectifier, SpotsAreWhereAPinholeHasThem) {
  const std::vector<double> d = {0.5167, -2.6213, 0.00050, -0.00022, 1.5046, 0.3942, -2.4370, 1.4315};
  const Camera camera = Camera::symmetric(1280, 720, 610);
  const cv::Matx33d K(610, 0, camera.cx_px, 0, 610, camera.cy_px, 0, 0, 1);
  const Rectifier rectifier(camera, d);
  for (const cv::Point3d& ray : {cv::Point3d(0, 0, 1), cv::Point3d(0.6, 0.3, 1), cv::Point3d(-0.8, 0.45, 1)}) {
    std::vector<cv::Point2d> seen;
    cv::projectPoints(std::vector<cv::Point3d>{ray}, cv::Vec3d(), cv::Vec3d(), K, d, seen);
    Image8 image(1280, 720);
    Image16 depth(1280, 720);
    for (int y = 0; y < 720; ++y)
      for (int x = 0; x < 1280; ++x) {
        const double r2 = (x - seen[0].x) * (x - seen[0].x) + (y - seen[0].y) * (y - seen[0].y);
        image.at(x, y) = static_cast<std::uint8_t>(std::lround(200.0 * std::exp(-r2 / 18.0)));
        depth.at(x, y) = r2 < 100.0 ? 1234 : 0;
      }
    const Image8 flat = rectifier.color(image);
    double sum = 0, sum_x = 0, sum_y = 0;
    for (int y = 0; y < 720; ++y)
      for (int x = 0; x < 1280; ++x) {
        sum += flat.at(x, y);
        sum_x += flat.at(x, y) * x;
        sum_y += flat.at(x, y) * y;
      }
    const Eigen::Vector2d expected(610 * ray.x + camera.cx_px, 610 * ray.y + camera.cy_px);
    // The spot is three pixels wide (one sigma), over which the lens bends by less than a twentieth of one.
    EXPECT_LT((Eigen::Vector2d(sum_x / sum, sum_y / sum) - expected).norm(), 0.05) << ray;
    const Image16 near = rectifier.depth(depth);
    EXPECT_EQ(near.at(static_cast<int>(std::lround(expected.x())), static_cast<int>(std::lround(expected.y()))), 1234);
    for (const std::uint16_t pixel : near.pixels) ASSERT_TRUE(pixel == 0 || pixel == 1234);
  }
  EXPECT_THAT(error_text([&] { rectifier.color(Image8(64, 48)); }), HasSubstr("64x48"));
}

// -------------------------------------------------------------------------------------------------------- pictures

// An image whose pixels all have the same bytes, with padded rows.
std::string plain_image(const std::string& encoding, const std::string& pixel, int width, int height,
                        bool big_endian_pixels = false) {
  ImageFields image;
  image.encoding = encoding;
  image.width = static_cast<std::uint32_t>(width);
  image.height = static_cast<std::uint32_t>(height);
  image.big_endian_pixels = big_endian_pixels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.data += pixel;
    image.data += "pad";
  }
  image.step = static_cast<std::uint32_t>(image.data.size() / static_cast<std::size_t>(height));
  return image_message(image);
}

std::uint8_t grey_of(const std::string& message) {
  PictureMaker maker;
  const PictureFile file = maker.color(kImageType, message);
  const auto grey = decode_grey_image({file.bytes.begin(), file.bytes.end()});
  return std::get<Image8>(grey).at(3, 2);
}

TEST(RosPictures, EveryEncodingHasItsColours) {
  const int red = 76;  // of (255, 0, 0), by 0.299 R + 0.587 G + 0.114 B
  EXPECT_NEAR(grey_of(plain_image("rgb8", std::string("\xff\0\0", 3), 7, 5)), red, 1);
  EXPECT_NEAR(grey_of(plain_image("bgr8", std::string("\0\0\xff", 3), 7, 5)), red, 1);
  EXPECT_NEAR(grey_of(plain_image("rgba8", std::string("\xff\0\0\x07", 4), 7, 5)), red, 1);
  EXPECT_NEAR(grey_of(plain_image("bgra8", std::string("\0\0\xff\x07", 4), 7, 5)), red, 1);
  EXPECT_EQ(grey_of(plain_image("mono8", "\x42", 7, 5)), 0x42);
  // Twelve bits in sixteen: 0x0800 of 0x0FFF is the middle.
  EXPECT_EQ(grey_of(plain_image("mono16", std::string("\x00\x08", 2), 7, 5)), 0x80);
  EXPECT_EQ(grey_of(plain_image("mono16", std::string("\x08\x00", 2), 7, 5, true)), 0x80);
  // UYVY and YUYV of the luma 150 without colour: (150 - 16) * 1.164.
  EXPECT_NEAR(grey_of(plain_image("yuv422", "\x80\x96", 8, 6)), 156, 1);
  EXPECT_NEAR(grey_of(plain_image("yuyv", "\x96\x80", 8, 6)), 156, 1);
}

// A mosaic of a red scene: only the red places are bright.
TEST(RosPictures, BayerPatternsHaveTheirRedWhereTheNameSays) {
  const std::map<std::string, std::pair<int, int>> red_at = {
      {"bayer_rggb8", {0, 0}}, {"bayer_grbg8", {1, 0}}, {"bayer_gbrg8", {0, 1}}, {"bayer_bggr8", {1, 1}}};
  for (const auto& [encoding, place] : red_at) {
    ImageFields image;
    image.encoding = encoding;
    image.width = image.step = 12;
    image.height = 10;
    for (int y = 0; y < 10; ++y)
      for (int x = 0; x < 12; ++x) image.data += x % 2 == place.first && y % 2 == place.second ? '\xff' : '\0';
    EXPECT_NEAR(grey_of(image_message(image)), 76, 1) << encoding;
  }
}

std::uint16_t depth_of(const std::string& type, const std::string& message, double unit_m) {
  PictureMaker maker;
  const PictureFile file = maker.depth(type, message, unit_m);
  const auto depth = decode_depth_image({file.bytes.begin(), file.bytes.end()});
  return std::get<Image16>(depth).at(1, 1);
}

std::string float_bytes(float value) { return {reinterpret_cast<const char*>(&value), sizeof value}; }

TEST(RosPictures, DepthInCountsAndMetres) {
  EXPECT_EQ(depth_of(kImageType, plain_image("16UC1", std::string("\xd0\x07", 2), 4, 3), 1e-3), 2000);
  const double unit_m = depth_unit_m("32FC1");
  EXPECT_EQ(depth_of(kImageType, plain_image("32FC1", float_bytes(2.5F), 4, 3), unit_m), 25000);
  EXPECT_EQ(depth_of(kImageType, plain_image("32FC1", float_bytes(NAN), 4, 3), unit_m), 0);
  EXPECT_EQ(depth_of(kImageType, plain_image("32FC1", float_bytes(70.0F), 4, 3), unit_m), 0);  // beyond what fits
  PngEncoder encoder;
  const std::string png(encoder.encode(Image16(4, 3, 1, 1234)));
  const std::string head(12, '\0');
  EXPECT_EQ(depth_of(kCompressedImageType, compressed_message(0, "f", "16UC1; compressedDepth png", head + png), 1e-3),
            1234);
  // 32FC1: z = a / (value - b) with a = 1000, b = 234.
  const std::string quantised = std::string(4, '\0') + float_bytes(1000.0F) + float_bytes(234.0F);
  EXPECT_EQ(
      depth_of(kCompressedImageType, compressed_message(0, "f", "32FC1; compressedDepth png", quantised + png), unit_m),
      10000);
}

// A row of 100 depths from half a metre on.
std::string metres_in_steps(float step_m, const std::function<float(float)>& changed) {
  ImageFields image;
  image.width = 100;
  image.height = 1;
  image.encoding = "32FC1";
  image.step = 400;
  for (int i = 0; i < 100; ++i) image.data += float_bytes(changed(step_m * static_cast<float>(2000 + 7 * i)));
  return image_message(image);
}

TEST(RosPictures, MetresOfADeviceThatCountsKeepItsUnit) {
  const auto same = [](float metres) { return metres; };
  EXPECT_EQ(unit_of_metres(metres_in_steps(2.5e-4F, same)), 2.5e-4);
  EXPECT_EQ(unit_of_metres(metres_in_steps(1e-3F, same)), 1e-3);
  EXPECT_EQ(unit_of_metres(metres_in_steps(1e-4F, same)), 1e-4);
  EXPECT_EQ(unit_of_metres(metres_in_steps(2.5e-4F, [](float metres) { return metres > 0.6F ? metres : NAN; })),
            2.5e-4);
  EXPECT_EQ(unit_of_metres(metres_in_steps(2.5e-4F, [](float metres) { return metres * 1.0001F; })), 1e-4)
      << "of no unit";
  EXPECT_EQ(unit_of_metres(metres_in_steps(2.5e-4F, [](float) { return 1.5F; })), std::nullopt) << "a single value";
  EXPECT_EQ(unit_of_metres(metres_in_steps(2.5e-4F, same).substr(0, 200)), std::nullopt) << "cut off";
}

// The coder of the paper: runs of zeros and of others, differences in zigzag, three bits a nibble.
class RvlCoder {
 public:
  std::string code(const Image16& image) {
    auto pixel = image.pixels.begin();
    int previous = 0;
    while (pixel != image.pixels.end()) {
      const auto shown = std::find_if(pixel, image.pixels.end(), [](std::uint16_t value) { return value != 0; });
      const auto end = std::find(shown, image.pixels.end(), std::uint16_t{0});
      number(static_cast<std::uint32_t>(shown - pixel));
      number(static_cast<std::uint32_t>(end - shown));
      for (pixel = shown; pixel != end; ++pixel) {
        const int delta = *pixel - previous;
        previous = *pixel;
        number(static_cast<std::uint32_t>(delta < 0 ? -2 * delta - 1 : 2 * delta));
      }
    }
    while (nibbles_ % 8 != 0) nibble(0);
    std::string bytes(reinterpret_cast<const char*>(&image.width), 4);
    bytes.append(reinterpret_cast<const char*>(&image.height), 4);
    return bytes.append(reinterpret_cast<const char*>(words_.data()), 4 * words_.size());
  }

 private:
  void number(std::uint32_t value) {
    for (; value > 7; value >>= 3U) nibble((value & 7U) | 8U);
    nibble(value);
  }
  void nibble(std::uint32_t value) {
    if (nibbles_++ % 8 == 0) words_.push_back(0);
    words_.back() = (words_.back() << 4U) | value;
  }
  std::vector<std::uint32_t> words_;
  std::size_t nibbles_ = 0;
};

TEST(RosPictures, DepthInRvl) {
  Image16 image(64, 48);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<std::uint16_t>(i % 7 < 2 ? 0 : (i * 37) % 65536);
  const std::string coded = RvlCoder().code(image), head(12, '\0');
  PictureMaker maker;
  const auto message = [&](const std::string& data) {
    return compressed_message(0, "f", "16UC1; compressedDepth rvl", head + data);
  };
  const PictureFile file = maker.depth(kCompressedImageType, message(coded), 1e-3);
  const auto decoded = decode_depth_image({file.bytes.begin(), file.bytes.end()});
  ASSERT_TRUE(std::holds_alternative<Image16>(decoded));
  EXPECT_EQ(std::get<Image16>(decoded).pixels, image.pixels);
  const PictureKind kind = kind_of_picture(kCompressedImageType, "/d/compressedDepth", message(coded));
  EXPECT_TRUE(kind.is_depth);
  EXPECT_EQ(kind.width, 64);
  const auto failure = [&](const std::string& data) {
    return error_text([&] { maker.depth(kCompressedImageType, message(data), 1e-3); });
  };
  EXPECT_THAT(failure(coded.substr(0, coded.size() / 2)), HasSubstr("ends early"));
  EXPECT_THAT(failure(coded.substr(0, 3)), HasSubstr("ends early"));
  EXPECT_THAT(failure(std::string(8, '\xff')), HasSubstr("are allowed"));
  EXPECT_THAT(failure(coded.substr(0, 8) + std::string(400, '\xff')), HasSubstr("30 bits"));
}

// Two points of doubles behind a colour, big-endian.
RosPointCloud some_cloud(std::string* data) {
  for (const double value : {1.0, 2.0, 3.0, -1.0, static_cast<double>(NAN), 0.0}) {
    if (data->size() % 28 == 0) *data += "rgb ";
    std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
    *data += std::string(raw.rbegin(), raw.rend());
  }
  RosPointCloud cloud;
  cloud.height = 2;
  cloud.width = 1;
  cloud.fields = {{"rgb", 0, 6, 1}, {"x", 4, 8, 1}, {"y", 12, 8, 1}, {"z", 20, 8, 1}};
  cloud.is_bigendian = true;
  cloud.point_step = cloud.row_step = 28;
  cloud.data = *data;
  return cloud;
}

TEST(RosClouds, PointsAreReadInEveryLayout) {
  std::string data;
  const RosPointCloud cloud = some_cloud(&data);
  const auto points = points_of_message(message_bytes(cloud), Rigid3(Eigen::Quaterniond(1, 0, 0, 0), {0, 0, 1}));
  ASSERT_EQ(points.size(), 1U);
  EXPECT_THAT(points[0], ElementsAre(1.0F, 2.0F, 4.0F));
}

TEST(RosClouds, HostileOnesAreErrors) {
  std::string data;
  const RosPointCloud good = some_cloud(&data);
  const auto failure = [&](const auto& change) {
    RosPointCloud cloud = good;
    change(cloud);
    return error_text([&] { points_of_message(message_bytes(cloud), Rigid3()); });
  };
  EXPECT_THAT(failure([](RosPointCloud& cloud) { cloud.fields.pop_back(); }), HasSubstr("without a field z"));
  EXPECT_THAT(failure([](RosPointCloud& cloud) { cloud.fields[1].offset = 0xFFFFFFFC; }),
              HasSubstr("beyond its points"));
  EXPECT_THAT(failure([](RosPointCloud& cloud) { cloud.width = 0xFFFFFFFF; }), HasSubstr("in 56 bytes"));
  EXPECT_THAT(failure([](RosPointCloud& cloud) {
                cloud.width = cloud.row_step = 0;
                cloud.height = 0xFFFFFFFF;
              }),
              HasSubstr("0x4294967295 points"));
  EXPECT_THAT(failure([](RosPointCloud& cloud) { cloud.height = 3; }), HasSubstr("in 56 bytes"));
  const std::string whole = message_bytes(good);
  for (std::size_t size = 0; size + 1 < whole.size(); ++size)
    EXPECT_NE(error_text([&] { points_of_message(std::string_view(whole).substr(0, size), Rigid3()); }), "") << size;
}

TEST(RosPictures, WhatIsNoPictureIsRefused) {
  PictureMaker maker;
  const auto failure = [&maker](const std::string& message) {
    return error_text([&] { maker.color(kImageType, message); });
  };
  EXPECT_THAT(failure(plain_image("rgb9", "abc", 4, 3)), HasSubstr("did you mean \"rgb8\""));
  ImageFields image;
  image.encoding = "mono8";
  image.width = image.height = image.step = 100;
  image.data = std::string(9999, 'x');
  EXPECT_THAT(failure(image_message(image)), HasSubstr("9999 bytes"));
  image.width = image.height = 0x7fffffff;
  EXPECT_THAT(failure(image_message(image)), HasSubstr("are allowed"));
  const std::string jpeg = "\xFF\xD8\xFF\xE0 and then nothing";
  EXPECT_THAT(error_text([&] { maker.color(kCompressedImageType, compressed_message(0, "f", "jpeg", jpeg)); }),
              HasSubstr("JPEG"));
  EXPECT_THAT(error_text([&] {
                maker.depth(kCompressedImageType, compressed_message(0, "f", "16UC1; compressedDepth", "x"), 1e-3);
              }),
              HasSubstr("ends early"));
}

// -------------------------------------------------------------------------------------------------- frames, ground

// Stands for two seconds, drives 40 cm in two, and so on; 50 Hz.
std::vector<OdometrySample> stop_and_go(int stops) {
  std::vector<OdometrySample> odometry;
  for (int i = 0; i <= 50 * 4 * stops; ++i) {
    const double t = 0.02 * i, cycle = std::floor(t / 4.0), within = t - 4.0 * cycle;
    odometry.push_back({1e9 + t, 0.4 * cycle + 0.2 * std::max(0.0, within - 2.0), 0.0, 0.1 * cycle});
  }
  return odometry;
}

std::vector<double> stream(double hertz, double seconds) {
  std::vector<double> stamps;
  for (int i = 0; i < static_cast<int>(hertz * seconds); ++i) stamps.push_back(1e9 + i / hertz);
  return stamps;
}

TEST(FrameChoice, AStreamBecomesAFewImagesOfEachStop) {
  const auto odometry = stop_and_go(6);
  const auto stamps = stream(30.0, 24.0);
  const FrameChoice choice = choose_frames({stamps, stream(15.0, 24.0)}, odometry, {});
  EXPECT_EQ(choice.stops, 6U);
  EXPECT_THAT(choice.stops_of_camera, ElementsAre(6U, 6U));
  ASSERT_EQ(choice.kept[0].size(), 18U);
  EXPECT_EQ(choice.kept[1].size(), 18U);
  for (const std::size_t index : choice.kept[0]) EXPECT_LT(std::fmod(stamps[index] - 1e9, 4.0), 2.0 + 1e-6);
  EXPECT_NEAR(static_cast<double>(choice.moving), 24.0 * 45.0 / 2.0, 80.0);
  const FrameChoice all = choose_frames({stamps}, odometry, {true, 3});
  EXPECT_EQ(all.kept[0].size(), stamps.size());
}

TEST(FrameChoice, OneRowOfOdometryForEachImageKeepsAll) {
  std::vector<OdometrySample> odometry;
  std::vector<double> stamps;
  for (int i = 0; i < 12; ++i) {
    odometry.push_back({100.0 + i, 0.3 * i, 0.0, 0.1 * i});
    stamps.push_back(100.0 + i);
  }
  EXPECT_EQ(choose_frames({stamps}, odometry, {}).kept[0].size(), 12U);
}

TEST(FrameChoice, WithoutStopsTheWayIsThinned) {
  std::vector<OdometrySample> odometry;
  for (int i = 0; i <= 500; ++i) odometry.push_back({1e9 + 0.02 * i, 0.004 * i, 0.0, 0.0});  // 20 cm/s for 10 s
  const FrameChoice choice = choose_frames({stream(30.0, 10.0)}, odometry, {});
  EXPECT_TRUE(choice.on_the_move);
  EXPECT_NEAR(static_cast<double>(choice.kept[0].size()), 2.0 / 0.053, 6.0);  // every 5 cm, at the next image
}

TEST(GroundTrack, TiltAndRiseAreMeasured) {
  std::vector<TimedPose> poses(3);
  poses[1] = {1.0, {rotation_z(0.5) * so3_exp({0.0, 0.1, 0.0}), {1.0, 2.0, 0.3}}};
  poses[2] = {2.0, {rotation_z(-0.5), {2.0, 2.0, -0.1}}};
  const GroundTrack track = ground_track(poses);
  ASSERT_EQ(track.odometry.size(), 3U);
  EXPECT_NEAR(track.odometry[1].yaw_rad, 0.5, 1e-12);
  EXPECT_EQ(track.odometry[1].y_m, 2.0);
  EXPECT_NEAR(track.tilt_deg, 0.1 * 180.0 / kPi, 1e-9);
  EXPECT_NEAR(track.rise_m, 0.4, 1e-12);
}

}  // namespace
}  // namespace rigproof
