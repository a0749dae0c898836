#include "ros_cloud.h"

#include <algorithm>
#include <cstring>

#include "rigproof/bags/messages.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

constexpr std::uint8_t kFloat32 = 7, kFloat64 = 8;

std::uint32_t bytes_of(std::uint8_t datatype) { return datatype == kFloat64 ? 8 : 4; }

const RosPointCloud::Field& coordinate(const RosPointCloud& cloud, const char* name) {
  const auto found = std::find_if(cloud.fields.begin(), cloud.fields.end(),
                                  [name](const RosPointCloud::Field& field) { return field.name == name; });
  if (found == cloud.fields.end() || (found->datatype != kFloat32 && found->datatype != kFloat64))
    throw Error(std::string("a cloud without a field ") + name + " of floating-point numbers");
  if (std::uint64_t{found->offset} + bytes_of(found->datatype) > cloud.point_step)
    throw Error(std::string("a cloud whose field ") + name + " reaches beyond its points");
  return *found;
}

template <typename Number, typename Word>
double number_at(const char* bytes, bool big_endian) {
  Word word = 0;
  std::memcpy(&word, bytes, sizeof word);
  if (big_endian)
    word = sizeof word == 8 ? static_cast<Word>(__builtin_bswap64(word))
                            : static_cast<Word>(__builtin_bswap32(static_cast<std::uint32_t>(word)));
  Number value = 0;
  std::memcpy(&value, &word, sizeof value);
  return static_cast<double>(value);
}

}  // namespace

std::vector<std::array<float, 3>> points_of_message(std::string_view message, const Rigid3& T_camera_cloud) {
  const RosPointCloud cloud = read_point_cloud_message(message);
  const std::array<RosPointCloud::Field, 3> axes = {coordinate(cloud, "x"), coordinate(cloud, "y"),
                                                    coordinate(cloud, "z")};
  const std::uint64_t row = std::uint64_t{cloud.width} * cloud.point_step;
  if (row == 0 || cloud.row_step < row || cloud.data.size() < std::uint64_t{cloud.row_step} * cloud.height)
    throw Error("a cloud of " + std::to_string(cloud.width) + "x" + std::to_string(cloud.height) + " points of " +
                std::to_string(cloud.point_step) + " bytes in " + std::to_string(cloud.data.size()) + " bytes");
  std::vector<std::array<float, 3>> points;
  for (std::uint32_t y = 0; y < cloud.height; ++y)
    for (std::uint32_t x = 0; x < cloud.width; ++x) {
      const char* const bytes = cloud.data.data() + std::size_t{y} * cloud.row_step + std::size_t{x} * cloud.point_step;
      Eigen::Vector3d point;
      for (std::size_t i = 0; i < 3; ++i)
        point[static_cast<Eigen::Index>(i)] =
            axes[i].datatype == kFloat64 ? number_at<double, std::uint64_t>(bytes + axes[i].offset, cloud.is_bigendian)
                                         : number_at<float, std::uint32_t>(bytes + axes[i].offset, cloud.is_bigendian);
      if (!point.allFinite()) continue;
      const Eigen::Vector3f seen = (T_camera_cloud * point).cast<float>();
      points.push_back({seen.x(), seen.y(), seen.z()});
    }
  if (points.empty()) throw Error("a cloud without a finite point");
  return points;
}

}  // namespace rigproof
