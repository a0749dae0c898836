// The definitions of the messages that are written (ROS 2: common_interfaces, rcl_interfaces, geometry2), fields alone.
#include <algorithm>
#include <vector>

#include "rigproof/bags/messages.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

struct Definition {
  const char* type;
  const char* fields;
  std::vector<const char*> uses;  ///< further types, those in them not counted
};

const std::vector<Definition>& definitions() {
  static const std::vector<Definition> kAll = {
      {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec", {}},
      {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id", {"builtin_interfaces/Time"}},
      {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z", {}},
      {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z", {}},
      {"geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1", {}},
      {"geometry_msgs/Pose",
       "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation",
       {"geometry_msgs/Point", "geometry_msgs/Quaternion"}},
      {"geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance", {"geometry_msgs/Pose"}},
      {"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular", {"geometry_msgs/Vector3"}},
      {"geometry_msgs/TwistWithCovariance",
       "geometry_msgs/Twist twist\nfloat64[36] covariance",
       {"geometry_msgs/Twist"}},
      {"geometry_msgs/Transform",
       "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation",
       {"geometry_msgs/Vector3", "geometry_msgs/Quaternion"}},
      {"geometry_msgs/TransformStamped",
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform",
       {"std_msgs/Header", "geometry_msgs/Transform"}},
      {"sensor_msgs/RegionOfInterest",
       "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify",
       {}},
      {kImageType,
       "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
       "uint8[] data",
       {"std_msgs/Header"}},
      {kCompressedImageType, "std_msgs/Header header\nstring format\nuint8[] data", {"std_msgs/Header"}},
      {kCameraInfoType,
       "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\n"
       "float64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi",
       {"std_msgs/Header", "sensor_msgs/RegionOfInterest"}},
      {kOdometryType,
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
       "geometry_msgs/TwistWithCovariance twist",
       {"std_msgs/Header", "geometry_msgs/PoseWithCovariance", "geometry_msgs/TwistWithCovariance"}},
      {"sensor_msgs/PointField", "string name\nuint32 offset\nuint8 datatype\nuint32 count", {}},
      {kPointCloudType,
       "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool is_bigendian\n"
       "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense",
       {"std_msgs/Header", "sensor_msgs/PointField"}},
      {kTfType, "geometry_msgs/TransformStamped[] transforms", {"geometry_msgs/TransformStamped"}}};
  return kAll;
}

const Definition& definition_of(const std::string& type) {
  const auto found = std::find_if(definitions().begin(), definitions().end(),
                                  [&type](const Definition& definition) { return definition.type == type; });
  if (found == definitions().end()) throw Error(for_message(type) + ": the definition of this message is not known");
  return *found;
}

void add_used(const Definition& definition, std::vector<std::string>* types) {
  for (const char* used : definition.uses) {
    if (std::find(types->begin(), types->end(), used) != types->end()) continue;
    types->emplace_back(used);
    add_used(definition_of(used), types);
  }
}

}  // namespace

std::string message_definition(const std::string& type) {
  std::vector<std::string> used;
  add_used(definition_of(type), &used);
  std::string text = definition_of(type).fields + std::string("\n");
  for (const std::string& name : used)
    text += std::string(80, '=') + "\nMSG: " + name + "\n" + definition_of(name).fields + "\n";
  return text;
}

}  // namespace rigproof
