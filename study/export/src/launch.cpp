// A launch file of ROS 2 in Python: one static_transform_publisher for each transform.
#include "comments.h"
#include "static_tf_arguments.h"

namespace rigproof {
namespace {

std::string python_text(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return quoted + "'";
}

std::string node_text(const TreeTransform& transform) {
  std::string arguments;
  for (const auto& [name, value] : exporting::static_tf_arguments(transform))
    arguments += (arguments.empty() ? "" : ", ") + python_text(name) + ", " + python_text(value);
  return "        Node(package='tf2_ros', executable='static_transform_publisher',\n             name=" +
         python_text(exporting::identifier(transform.child) + "_tf") + ",\n             arguments=[" + arguments +
         "]),\n";
}

ExportOutput write(const ExportJob& job) {
  std::string text = exporting::hash_comment(exporting::tree_head_lines(job)) +
                     "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\n"
                     "def generate_launch_description():\n    return LaunchDescription([\n";
  for (const TreeTransform& transform : tree_transforms(job)) text += node_text(transform);
  return {{{"", text + "    ])\n"}}, {}};
}

}  // namespace

ExportFormat launch_export() {
  ExportFormat format;
  format.name = "launch";
  format.what = "a ROS 2 launch file in Python";
  format.write = write;
  return format;
}

}  // namespace rigproof
