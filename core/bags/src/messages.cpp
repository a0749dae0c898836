#include "rigproof/bags/messages.h"

#include <fastcdr/exceptions/Exception.h>

#include <cmath>

#include "cdr_reader.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr std::int64_t kNsPerS = 1000000000;

// Fast CDR's own exceptions become Errors.
template <typename Read>
auto reading(std::string_view message, const Read& read) {
  CdrReader cdr(message);
  try {
    return read(cdr);
  } catch (const eprosima::fastcdr::exception::Exception&) {
    throw Error("ends early");
  }
}

RosHeader header_of(CdrReader& cdr) {
  RosHeader header;
  const std::int64_t seconds = cdr.number<std::int32_t>();
  header.stamp_ns = seconds * kNsPerS + cdr.number<std::uint32_t>();
  header.frame_id = cdr.text();
  return header;
}

// One that is none is the sender's mistake, not damage: the rest of the message is good.
Rigid3 pose_of(CdrReader& cdr, std::string* no_pose) {
  const std::array<double, 3> t = cdr.array<3>();
  const std::array<double, 4> q = cdr.array<4>();
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  const Eigen::Vector3d translation(t[0], t[1], t[2]);
  if (translation.allFinite() && std::abs(rotation.norm() - 1.0) <= 0.01) return {rotation, translation};
  *no_pose = "a pose with the translation (" + short_text(t[0], 4) + ", " + short_text(t[1], 4) + ", " +
             short_text(t[2], 4) + ") and a quaternion of norm " + short_text(rotation.norm(), 4) +
             "; finite numbers and norm 1 are needed";
  return {};
}

}  // namespace

RosHeader read_header(std::string_view message) {
  return reading(message, [](CdrReader& cdr) { return header_of(cdr); });
}

RosImage read_image(std::string_view message) {
  return reading(message, [](CdrReader& cdr) {
    RosImage image;
    image.header = header_of(cdr);
    image.height = cdr.number<std::uint32_t>();
    image.width = cdr.number<std::uint32_t>();
    image.encoding = cdr.text();
    image.is_bigendian = cdr.number<std::uint8_t>() != 0;
    image.step = cdr.number<std::uint32_t>();
    image.data = cdr.bytes();
    return image;
  });
}

RosCompressedImage read_compressed_image(std::string_view message) {
  return reading(message, [](CdrReader& cdr) {
    RosCompressedImage image;
    image.header = header_of(cdr);
    image.format = cdr.text();
    image.data = cdr.bytes();
    return image;
  });
}

RosCameraInfo read_camera_info_message(std::string_view message) {
  return reading(message, [](CdrReader& cdr) {
    RosCameraInfo info;
    info.header = header_of(cdr);
    info.height = cdr.number<std::uint32_t>();
    info.width = cdr.number<std::uint32_t>();
    info.distortion_model = cdr.text();
    info.d = cdr.numbers();
    info.k = cdr.array<9>();
    info.r = cdr.array<9>();
    info.p = cdr.array<12>();
    info.binning_x = cdr.number<std::uint32_t>();
    info.binning_y = cdr.number<std::uint32_t>();
    for (std::uint32_t* value : {&info.roi.x_offset, &info.roi.y_offset, &info.roi.height, &info.roi.width})
      *value = cdr.number<std::uint32_t>();
    return info;
  });
}

RosOdometry read_odometry_message(std::string_view message) {
  return reading(message, [](CdrReader& cdr) {
    RosOdometry odometry;
    odometry.header = header_of(cdr);
    odometry.child_frame_id = cdr.text();
    odometry.T_odom_child = pose_of(cdr, &odometry.no_pose);
    cdr.array<36>();  // covariance
    const std::array<double, 3> linear = cdr.array<3>(), angular = cdr.array<3>();
    odometry.velocity = {linear[0], linear[1], linear[2]};
    odometry.angular_velocity = {angular[0], angular[1], angular[2]};
    return odometry;
  });
}

std::vector<RosTransform> read_tf_message(std::string_view message) {
  return reading(message, [](CdrReader& cdr) {
    constexpr std::size_t kLeast = 72;  // header, name and seven numbers
    std::vector<RosTransform> transforms(cdr.length(kLeast));
    for (RosTransform& transform : transforms) {
      transform.header = header_of(cdr);
      transform.child_frame_id = cdr.text();
      transform.T_parent_child = pose_of(cdr, &transform.no_pose);
    }
    return transforms;
  });
}

RosPointCloud read_point_cloud_message(std::string_view message) {
  return reading(message, [](CdrReader& cdr) {
    RosPointCloud cloud;
    cloud.header = header_of(cdr);
    cloud.height = cdr.number<std::uint32_t>();
    cloud.width = cdr.number<std::uint32_t>();
    constexpr std::size_t kLeast = 14;  // length of a name, and three numbers
    cloud.fields.resize(cdr.length(kLeast));
    for (RosPointCloud::Field& field : cloud.fields) {
      field.name = cdr.text();
      field.offset = cdr.number<std::uint32_t>();
      field.datatype = cdr.number<std::uint8_t>();
      field.count = cdr.number<std::uint32_t>();
    }
    cloud.is_bigendian = cdr.number<std::uint8_t>() != 0;
    cloud.point_step = cdr.number<std::uint32_t>();
    cloud.row_step = cdr.number<std::uint32_t>();
    cloud.data = cdr.bytes();
    return cloud;
  });
}

}  // namespace rigproof
