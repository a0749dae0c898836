// Messages of ROS 2 as plain CDR, on Fast CDR.
#include "fast_cdr.h"
#include "rigproof/bags/messages.h"

namespace rigproof {
namespace {

// In memory of zeros, since Fast CDR leaves gaps between numbers as they are: the same message, the same bytes.
class CdrWriter {
 public:
  /// @param text_bytes of all its texts and lists; numbers besides have room.
  explicit CdrWriter(std::size_t text_bytes) : bytes_(text_bytes + kNumbers, '\0') { cdr_.serialize_encapsulation(); }

  template <typename Value>
  CdrWriter& add(const Value& value) {
    cdr_ << value;
    return *this;
  }
  CdrWriter& header(const RosHeader& header) {
    constexpr std::int64_t kNsPerS = 1000000000;
    const std::int64_t whole = (header.stamp_ns - (header.stamp_ns < 0 ? kNsPerS - 1 : 0)) / kNsPerS;
    add(static_cast<std::int32_t>(whole)).add(static_cast<std::uint32_t>(header.stamp_ns - whole * kNsPerS));
    return add(header.frame_id);
  }
  CdrWriter& bytes(std::string_view value) {
    add(static_cast<std::uint32_t>(value.size()));
    fast_cdr::write_bytes(cdr_, reinterpret_cast<const std::uint8_t*>(value.data()), value.size());
    return *this;
  }
  /// Without a length.
  template <typename Numbers>
  CdrWriter& numbers(const Numbers& values) {
    for (const double value : values) add(value);
    return *this;
  }
  CdrWriter& zeros(std::size_t count) { return numbers(std::vector<double>(count, 0.0)); }
  CdrWriter& pose(const Rigid3& T) {
    return numbers(T.translation).numbers(T.rotation.coeffs());  // x y z w, as the message has it
  }
  std::string str() {
    bytes_.resize(fast_cdr::written_bytes(cdr_));
    return std::move(bytes_);
  }

 private:
  static constexpr std::size_t kNumbers = 2048;  // the most has Odometry, 97 of 8 bytes

  std::string bytes_;
  fast_cdr::FastBuffer buffer_{bytes_.data(), bytes_.size()};
  fast_cdr::Cdr cdr_{buffer_, fast_cdr::Cdr::LITTLE_ENDIANNESS, fast_cdr::kPlainCdr};
};

}  // namespace

std::string message_bytes(const RosImage& image) {
  CdrWriter cdr(image.header.frame_id.size() + image.encoding.size() + image.data.size());
  cdr.header(image.header).add(image.height).add(image.width).add(image.encoding);
  return cdr.add(static_cast<std::uint8_t>(image.is_bigendian)).add(image.step).bytes(image.data).str();
}

std::string message_bytes(const RosCompressedImage& image) {
  CdrWriter cdr(image.header.frame_id.size() + image.format.size() + image.data.size());
  return cdr.header(image.header).add(image.format).bytes(image.data).str();
}

std::string message_bytes(const RosCameraInfo& info) {
  CdrWriter cdr(info.header.frame_id.size() + info.distortion_model.size() + sizeof(double) * info.d.size());
  cdr.header(info.header).add(info.height).add(info.width).add(info.distortion_model);
  cdr.add(static_cast<std::uint32_t>(info.d.size())).numbers(info.d).numbers(info.k).numbers(info.r).numbers(info.p);
  cdr.add(info.binning_x).add(info.binning_y);
  for (const std::uint32_t value : {info.roi.x_offset, info.roi.y_offset, info.roi.height, info.roi.width})
    cdr.add(value);
  return cdr.add(false).str();  // do_rectify
}

std::string message_bytes(const RosOdometry& odometry) {
  CdrWriter cdr(odometry.header.frame_id.size() + odometry.child_frame_id.size());
  cdr.header(odometry.header).add(odometry.child_frame_id).pose(odometry.T_odom_child).zeros(36);
  return cdr.numbers(odometry.velocity).numbers(odometry.angular_velocity).zeros(36).str();
}

std::string message_bytes(const std::vector<RosTransform>& transforms) {
  constexpr std::size_t kEach = 96;  // seven numbers, a stamp, lengths of two texts, and gaps
  std::size_t size = 0;
  for (const RosTransform& transform : transforms)
    size += kEach + transform.header.frame_id.size() + transform.child_frame_id.size();
  CdrWriter cdr(size);
  cdr.add(static_cast<std::uint32_t>(transforms.size()));
  for (const RosTransform& transform : transforms)
    cdr.header(transform.header).add(transform.child_frame_id).pose(transform.T_parent_child);
  return cdr.str();
}

std::string message_bytes(const RosPointCloud& cloud) {
  constexpr std::size_t kEach = 32;  // numbers of a field, and gaps
  std::size_t size = cloud.header.frame_id.size() + cloud.data.size();
  for (const RosPointCloud::Field& field : cloud.fields) size += kEach + field.name.size();
  CdrWriter cdr(size);
  cdr.header(cloud.header).add(cloud.height).add(cloud.width).add(static_cast<std::uint32_t>(cloud.fields.size()));
  for (const RosPointCloud::Field& field : cloud.fields)
    cdr.add(field.name).add(field.offset).add(field.datatype).add(field.count);
  cdr.add(cloud.is_bigendian).add(cloud.point_step).add(cloud.row_step).bytes(cloud.data);
  return cdr.add(true).str();  // is_dense: every point is finite
}

}  // namespace rigproof
