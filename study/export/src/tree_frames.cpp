// Which transforms a tree of frames is given, and what users must know of them.
#include "tree_frames.h"

#include <cmath>
#include <map>

#include "numbers.h"
#include "parent_frame.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace exporting {

bool is_optical_link(const ExportCamera& camera) {
  return camera.link == camera.name || camera.link == camera.optical_frame || is_optical_name(camera.link);
}

std::string optical_frame_of(const ExportCamera& camera) {
  return optical_frame_name(camera.name, camera.link, camera.optical_frame);
}

}  // namespace exporting

namespace {

using exporting::body_from_optical;
using exporting::place_text;

std::string list_of_sigmas(const Matrix6d& covariance, Eigen::Index first, double scale) {
  std::vector<std::string> words;
  const char* const axes[] = {"x ", "y ", "z "};
  for (Eigen::Index i = 0; i < 3; ++i)
    words.push_back(axes[i] + short_text(scale * std::sqrt(std::max(0.0, covariance(first + i, first + i))), 2));
  return joined(words);
}

// Which intrinsics a pose goes with, and how far from those are that the user told.
std::string lens_remark(const ExportCamera& camera, const std::string& told_by) {
  const std::string head = camera.name + ": ";
  if (!camera.estimated)
    return camera.told ? head + "the pose goes with the intrinsics of " + told_by
                       : head +
                             "the pose goes with the intrinsics that it was estimated with; no rig is at hand that "
                             "tells them";
  const Camera& lens = *camera.estimated;
  std::string text = head + "the pose goes with the intrinsics that were estimated with it: fx " +
                     short_text(lens.fx_px, 7) + ", fy " + short_text(lens.fy_px, 7) + ", cx " +
                     short_text(lens.cx_px, 7) + ", cy " + short_text(lens.cy_px, 7) + " px";
  if (camera.told)
    text += ", up to " + short_text(largest_pixel_difference(*camera.told, lens), 2) + " px from those of " + told_by;
  return text + "; to project with intrinsics that are told, calibrate with -m ml:told=exact";
}

// What the rig says of the tree of frames, so that nobody has to ask which numbers were composed.
std::string rig_frames_remark(const ExportCamera& camera) {
  std::vector<std::string> parts;
  if (camera.rig_says_frames)
    parts.push_back(camera.link + " is placed so that " +
                    (camera.optical_frame.empty() ? "the optical frame" : camera.optical_frame) + ", at " +
                    place_text(*camera.T_link_camera) + " in it, is right");
  if (!camera.parent.empty())
    parts.push_back("it hangs on " + camera.parent + " as in the robot's tree, at " +
                    place_text(camera.T_robot_parent) + " in " + camera.estimate.parent + " (--parent " +
                    camera.estimate.parent + " hangs it there)");
  return parts.empty() ? "" : camera.name + ": " + joined(parts, "; ");
}

// How the axes of a camera's link were read, where nobody says.
std::string axes_remark(const ExportCamera& camera) {
  if (camera.T_link_camera || camera.link == camera.optical_frame) return "";
  if (camera.link == camera.name)
    return camera.name +
           ": is exported as an optical frame (z forward); `link` of the rig, or --link, names the one of " +
           "your tree";
  if (is_optical_name(camera.link)) return "";
  return camera.name + ": " + camera.link +
         " is taken as the camera's body (x forward) in the optical centre; where a " +
         "driver or URDF fixes the optical frame below it, --optical says where";
}

}  // namespace

std::string sigma_text(const ExportCamera& camera) {
  if (!camera.is_known() || !camera.estimate.covariance) return "";
  const Matrix6d& covariance = *camera.estimate.covariance;
  return list_of_sigmas(covariance, 0, 100.0) + " cm; about " + list_of_sigmas(covariance, 3, rad_to_deg(1.0)) + " deg";
}

std::vector<std::string> remarks_of(const ExportJob& job) {
  std::vector<std::string> remarks = job.warnings;
  remarks.insert(remarks.end(), job.frame_notes.begin(), job.frame_notes.end());
  const std::string told_by = job.rig_source.empty() ? "the rig" : job.rig_source;
  for (const ExportCamera& camera : job.cameras) {
    if (!camera.is_known()) {
      remarks.push_back(camera.name + ": left out where six degrees of freedom are needed, for not all are known");
      continue;
    }
    const std::string sigma = sigma_text(camera);
    remarks.push_back(camera.name + " (optical) in " + camera.estimate.parent + ": " +
                      (sigma.empty() ? "the result states no uncertainty" : "one sigma " + sigma));
    remarks.push_back(lens_remark(camera, told_by));
  }
  return remarks;
}

std::vector<std::string> tree_notes(const ExportJob& job) {
  std::vector<std::string> notes;
  for (const ExportCamera& camera : job.cameras)
    for (const std::string& note : {axes_remark(camera), rig_frames_remark(camera)})
      if (camera.is_known() && !note.empty()) notes.push_back(note);
  return notes;
}

std::vector<TreeTransform> tree_transforms(const ExportJob& job) {
  std::vector<TreeTransform> transforms;
  for (const ExportCamera& camera : job.cameras) {
    if (!camera.is_known()) continue;
    const std::string& parent = camera.parent.empty() ? camera.estimate.parent : camera.parent;
    const Rigid3 T_parent_camera = camera.T_robot_parent.inverse() * camera.estimate.T_parent_child;
    if (camera.T_link_camera) {
      transforms.push_back({camera.name, parent, camera.link, T_parent_camera * camera.T_link_camera->inverse(), true});
    } else if (exporting::is_optical_link(camera)) {
      transforms.push_back({camera.name, parent, camera.link, T_parent_camera, true});
    } else {
      transforms.push_back({camera.name, parent, camera.link, T_parent_camera * body_from_optical().inverse(), true});
      transforms.push_back({camera.name, camera.link, exporting::optical_frame_of(camera), body_from_optical(), false});
    }
  }
  Problems problems;
  std::map<std::string, const TreeTransform*> children;
  for (const TreeTransform& transform : transforms) {
    const auto [there, is_new] = children.emplace(transform.child, &transform);
    if (!is_new)
      problems.add({"", 0, transform.camera, for_message(transform.child),
                    "would have two parents, being a frame of " + there->second->camera +
                        ", too; give each camera a link of its own (rig.yaml, or --link)"});
    if (transform.child == transform.parent || (transform.is_estimated && children.count(transform.parent) > 0))
      problems.add({"", 0, transform.camera, for_message(transform.child),
                    "would be above and below " + transform.parent + "; --link names the camera's link"});
  }
  problems.throw_if_any();
  return transforms;
}

}  // namespace rigproof
