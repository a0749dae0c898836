#include "bag_pictures.h"

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "rigproof/calib/vision/image_io.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

cv::Mat read_picture(const fs::path& file) {
  const std::vector<std::uint8_t> bytes = read_binary_file(file);
  cv::Mat picture;
  try {
    picture = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    picture.release();
  }
  if (picture.empty()) throw Error(file.string() + ": cannot be read as an image");
  return picture;
}

std::string encoding_of(const cv::Mat& picture, const fs::path& file) {
  switch (picture.type()) {
    case CV_8UC1:
      return "mono8";
    case CV_8UC3:
      return "bgr8";
    case CV_8UC4:
      return "bgra8";
    case CV_16UC1:
      return "mono16";
    default:
      throw Error(file.string() +
                  ": has pixels that sensor_msgs/Image has no name for; 8 bits grey or colour, and 16 "
                  "bits grey, are known");
  }
}

std::string image_bytes(const cv::Mat& picture, const std::string& encoding, const RosHeader& header) {
  RosImage image;
  image.header = header;
  image.width = static_cast<std::uint32_t>(picture.cols);
  image.height = static_cast<std::uint32_t>(picture.rows);
  image.encoding = encoding;
  image.step = static_cast<std::uint32_t>(picture.cols * static_cast<int>(picture.elemSize()));
  image.data = {reinterpret_cast<const char*>(picture.data), picture.total() * picture.elemSize()};
  return message_bytes(image);
}

std::string compressed_bytes(const std::string& data, const std::string& format, const RosHeader& header) {
  return message_bytes(RosCompressedImage{header, format, data});
}

std::string text_of(const fs::path& file) { return read_text_file(file, 512U << 20U); }

}  // namespace

PictureMessage color_message_of(const fs::path& file, const RosHeader& header, bool compressed) {
  if (!compressed) {
    const cv::Mat picture = read_picture(file);
    return {kImageType, "", image_bytes(picture, encoding_of(picture, file), header)};
  }
  const char* format = file.extension() == ".png" ? "bgr8; png compressed bgr8" : "bgr8; jpeg compressed bgr8";
  return {kCompressedImageType, "/compressed", compressed_bytes(text_of(file), format, header)};
}

PictureMessage depth_message_of(const fs::path& file, const RosHeader& header, double unit_m, bool compressed) {
  constexpr double kMillimetre = 1e-3;
  const bool in_mm = std::abs(unit_m - kMillimetre) < 1e-12;
  constexpr std::size_t kDepthHead = 12;  // of compressed_depth_image_transport, zero for 16 bits
  if (compressed && in_mm)
    return {kCompressedImageType, "/compressedDepth",
            compressed_bytes(std::string(kDepthHead, '\0') + text_of(file), "16UC1; compressedDepth png", header)};
  cv::Mat depth = read_picture(file);
  if (depth.type() != CV_16UC1) throw Error(file.string() + ": depth must be a PNG of 16 bits grey");
  if (!in_mm) depth.convertTo(depth, CV_32FC1, unit_m);
  return {kImageType, "", image_bytes(depth, in_mm ? "16UC1" : "32FC1", header)};
}

PictureMessage cloud_message_of(const fs::path& file, const RosHeader& header) {
  const auto read = read_point_cloud(file);
  if (const auto* failure = std::get_if<Unreadable>(&read)) throw Error(file.string() + ": " + failure->reason);
  const auto& points = std::get<std::vector<Eigen::Vector3f>>(read);
  static_assert(sizeof points[0] == 3 * sizeof(float));
  constexpr std::uint8_t kFloat32 = 7;
  RosPointCloud cloud;
  cloud.header = header;
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(points.size());
  for (const char* axis : {"x", "y", "z"})
    cloud.fields.push_back({axis, static_cast<std::uint32_t>(sizeof(float) * cloud.fields.size()), kFloat32, 1});
  cloud.point_step = sizeof points[0];
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data = {reinterpret_cast<const char*>(points.data()), cloud.row_step};
  return {kPointCloudType, "", message_bytes(cloud)};
}

RosCameraInfo camera_info_of(const Camera& camera, const RosHeader& header) {
  RosCameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(camera.width_px);
  info.height = static_cast<std::uint32_t>(camera.height_px);
  info.distortion_model = camera.lens == Lens::kKannalaBrandt ? "equidistant" : "plumb_bob";
  const std::size_t count = camera.lens == Lens::kKannalaBrandt ? 4 : 5;
  info.d.assign(count, 0.0);
  if (camera.lens != Lens::kPinhole) std::copy_n(camera.distortion.begin(), count, info.d.begin());
  info.k = {camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {camera.fx_px, 0, camera.cx_px, 0, 0, camera.fy_px, camera.cy_px, 0, 0, 0, 1, 0};
  return info;
}

}  // namespace rigproof
