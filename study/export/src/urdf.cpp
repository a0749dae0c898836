// A URDF of the robot frame and the cameras alone, to paste from or to load as it is.
#include <set>

#include "comments.h"
#include "numbers.h"
#include "rigproof/study/export/export.h"
#include "tree_frames.h"

namespace rigproof {
namespace {

std::string link_element(const std::string& name) {
  return "  <link name=\"" + exporting::xml_attribute(name) + "\"/>\n";
}

std::string joint_element(const TreeTransform& transform) {
  const exporting::UrdfPose pose = exporting::urdf_pose(transform.T_parent_child);
  return "  <joint name=\"" + exporting::xml_attribute(transform.child) +
         "_joint\" type=\"fixed\">\n    <parent link=\"" + exporting::xml_attribute(transform.parent) +
         "\"/>\n    <child link=\"" + exporting::xml_attribute(transform.child) + "\"/>\n    <origin xyz=\"" +
         exporting::vector_text(pose.xyz_m) + "\" rpy=\"" + exporting::vector_text(pose.rpy_rad) + "\"/>\n  </joint>\n";
}

ExportOutput write(const ExportJob& job) {
  std::string text = "<?xml version=\"1.0\"?>\n<robot name=\"cameras\">\n" +
                     exporting::xml_comment(exporting::tree_head_lines(job), "  ");
  std::set<std::string> links;
  for (const TreeTransform& transform : tree_transforms(job)) {
    for (const std::string& link : {transform.parent, transform.child})
      if (links.insert(link).second) text += link_element(link);
    text += joint_element(transform);
  }
  return {{{"", text + "</robot>\n"}}, {}};
}

}  // namespace

ExportFormat urdf_export() {
  ExportFormat format;
  format.name = "urdf";
  format.what = "links and fixed joints; --into changes an existing file";
  format.write = write;
  return format;
}

}  // namespace rigproof
