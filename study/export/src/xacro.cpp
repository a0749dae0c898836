// Properties with each pose, and a macro with each joint, to include in a robot's xacro.
#include "comments.h"
#include "numbers.h"
#include "rigproof/study/export/export.h"

namespace rigproof {
namespace {

std::string property(const std::string& name, const Eigen::Vector3d& values) {
  return "  <xacro:property name=\"" + name + "\" value=\"" + exporting::vector_text(values) + "\"/>\n";
}

// `${` would be taken for an expression; no frame that ROS accepts has it.
std::string as_default(const std::string& frame) { return exporting::xml_attribute(frame); }

std::string transform_text(const TreeTransform& transform) {
  const exporting::UrdfPose pose = exporting::urdf_pose(transform.T_parent_child);
  const std::string name = exporting::identifier(transform.child);
  return property(name + "_xyz", pose.xyz_m) + property(name + "_rpy", pose.rpy_rad) + "  <xacro:macro name=\"" + name +
         "_joint\" params=\"parent:=" + as_default(transform.parent) + " child:=" + as_default(transform.child) +
         "\">\n    <joint name=\"${child}_joint\" type=\"fixed\">\n      <parent link=\"${parent}\"/>\n      "
         "<child link=\"${child}\"/>\n      <origin xyz=\"${" +
         name + "_xyz}\" rpy=\"${" + name + "_rpy}\"/>\n    </joint>\n  </xacro:macro>\n";
}

ExportOutput write(const ExportJob& job) {
  const std::vector<TreeTransform> transforms = tree_transforms(job);
  const std::string example = exporting::identifier(transforms.front().child);
  std::vector<std::string> head = exporting::tree_head_lines(job);
  head.push_back("Include this file. In a joint of yours: <origin xyz=\"${" + example + "_xyz}\" rpy=\"${" + example +
                 "_rpy}\"/>; or the whole joint: <xacro:" + example + "_joint/> with links of yours.");
  std::string text = "<?xml version=\"1.0\"?>\n<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n" +
                     exporting::xml_comment(head, "  ");
  for (const TreeTransform& transform : transforms) text += transform_text(transform);
  return {{{"", text + "</robot>\n"}}, {}};
}

}  // namespace

ExportFormat xacro_export() {
  ExportFormat format;
  format.name = "xacro";
  format.what = "properties and macros to include; --into changes an existing file";
  format.write = write;
  return format;
}

}  // namespace rigproof
