// The messages of ROS 2 that a calibration needs, as their definitions have them. Each read_ function takes the bytes
// of one message (plain CDR, in either byte order) and throws Error, without a topic's name, for what is no such
// message. message_bytes() is the way back, little-endian.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rigproof/core/camera_info.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

// Types as topics name them.
inline constexpr const char* kImageType = "sensor_msgs/msg/Image";
inline constexpr const char* kCompressedImageType = "sensor_msgs/msg/CompressedImage";
inline constexpr const char* kCameraInfoType = "sensor_msgs/msg/CameraInfo";
inline constexpr const char* kOdometryType = "nav_msgs/msg/Odometry";
inline constexpr const char* kTfType = "tf2_msgs/msg/TFMessage";
inline constexpr const char* kPointCloudType = "sensor_msgs/msg/PointCloud2";

/// std_msgs/Header.
struct RosHeader {
  std::int64_t stamp_ns = 0;
  std::string frame_id;
};
/// Of any message that begins with a header, without reading the rest.
RosHeader read_header(std::string_view message);

/// sensor_msgs/Image.
struct RosImage {
  RosHeader header;
  std::uint32_t height = 0, width = 0;
  std::string encoding;
  bool is_bigendian = false;
  std::uint32_t step = 0;  ///< bytes of a row
  std::string_view data;   ///< into the message
};
RosImage read_image(std::string_view message);
std::string message_bytes(const RosImage& image);

/// sensor_msgs/CompressedImage.
struct RosCompressedImage {
  RosHeader header;
  std::string format;
  std::string_view data;  ///< into the message
};
RosCompressedImage read_compressed_image(std::string_view message);
std::string message_bytes(const RosCompressedImage& image);

/// sensor_msgs/CameraInfo.
struct RosCameraInfo : CameraInfo {
  RosHeader header;
};
RosCameraInfo read_camera_info_message(std::string_view message);
std::string message_bytes(const RosCameraInfo& info);

/// What nav_msgs/Odometry says of a robot on the ground.
struct RosOdometry {
  RosHeader header;  ///< frame_id: the odometry frame
  std::string child_frame_id;
  Rigid3 T_odom_child;
  std::string no_pose;                                         ///< why its numbers are no pose; empty: they are one
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< along the child's axes [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< the same [rad/s]
};
/// A pose needs finite numbers and a quaternion whose norm is 1 within 1 %.
RosOdometry read_odometry_message(std::string_view message);
/// With covariances of zero: not stated.
std::string message_bytes(const RosOdometry& odometry);

/// geometry_msgs/TransformStamped.
struct RosTransform {
  RosHeader header;  ///< frame_id: the parent
  std::string child_frame_id;
  Rigid3 T_parent_child;
  std::string no_pose;  ///< as above
};
/// tf2_msgs/TFMessage.
std::vector<RosTransform> read_tf_message(std::string_view message);
std::string message_bytes(const std::vector<RosTransform>& transforms);

/// sensor_msgs/PointCloud2.
struct RosPointCloud {
  struct Field {
    std::string name;
    std::uint32_t offset = 0;   ///< in a point
    std::uint8_t datatype = 0;  ///< 7: float32, 8: float64
    std::uint32_t count = 0;
  };
  RosHeader header;
  std::uint32_t height = 0, width = 0;
  std::vector<Field> fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 0, row_step = 0;  ///< bytes
  std::string_view data;                       ///< into the message
};
RosPointCloud read_point_cloud_message(std::string_view message);
std::string message_bytes(const RosPointCloud& cloud);

/// What recorders keep beside a topic: its type's definition (ros2msg) with those of all types in it. Throws Error for
/// a type that is not among those above.
std::string message_definition(const std::string& type);

}  // namespace rigproof
