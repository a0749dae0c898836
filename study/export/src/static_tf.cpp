// Command lines of tf2_ros, which together are a shell script.
#include "comments.h"
#include "numbers.h"
#include "rigproof/core/text.h"
#include "static_tf_arguments.h"

namespace rigproof {
namespace exporting {

std::vector<std::pair<std::string, std::string>> static_tf_arguments(const TreeTransform& transform) {
  const Eigen::Vector3d& t = transform.T_parent_child.translation;
  const Eigen::Quaterniond& q = transform.T_parent_child.rotation;
  return {{"--x", decimal_text(t.x())},  {"--y", decimal_text(t.y())},     {"--z", decimal_text(t.z())},
          {"--qx", decimal_text(q.x())}, {"--qy", decimal_text(q.y())},    {"--qz", decimal_text(q.z())},
          {"--qw", decimal_text(q.w())}, {"--frame-id", transform.parent}, {"--child-frame-id", transform.child}};
}

}  // namespace exporting

namespace {

std::string command_line(const TreeTransform& transform) {
  std::string line = "ros2 run tf2_ros static_transform_publisher";
  for (const auto& [name, value] : exporting::static_tf_arguments(transform))
    line += " " + name + " " + shell_word(value);
  return line;
}

// One command stays in the foreground; several run beside each other.
ExportOutput write(const ExportJob& job) {
  const std::vector<TreeTransform> transforms = tree_transforms(job);
  std::string text = "#!/bin/sh\n" + exporting::hash_comment(exporting::tree_head_lines(job));
  for (const TreeTransform& transform : transforms)
    text += command_line(transform) + (transforms.size() > 1 ? " &\n" : "\n");
  if (transforms.size() > 1) text += "wait\n";
  return {{{"", text}}, {}};
}

}  // namespace

ExportFormat static_tf_export() {
  ExportFormat format;
  format.name = "static-tf";
  format.what = "command lines of tf2_ros static_transform_publisher, as a shell script";
  format.write = write;
  return format;
}

}  // namespace rigproof
