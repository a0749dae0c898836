#include "rigproof/study/export/into_urdf.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "comments.h"
#include "numbers.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "tree_frames.h"
#include "urdf_chain.h"

namespace rigproof {
namespace {

using exporting::UrdfChain;
using exporting::UrdfText;
using exporting::UrdfTree;

// More than a mount is off from what its designer drew: perhaps the link, or its axes, are others.
constexpr double kFar_m = 0.5, kFar_rad = deg_to_rad(45.0);

/// Where a camera is in the tree.
struct Place {
  const ExportCamera* camera = nullptr;
  std::string robot;      ///< link that the pose is given in
  std::string link;       ///< whose pose in the robot the camera fixes
  Rigid3 T_link_camera;   ///< of the optical frame in that link
  std::string mount;      ///< link whose joint is to change; empty: as found
  UrdfChain chain;        ///< from robot to link
  std::size_t joint = 0;  ///< that changes
  std::string note;
};

// Rotation from body to optical axes and nothing else, as short as files round pi/2.
bool is_pure_optical(const UrdfTree& tree, std::size_t joint) {
  try {
    const Vector6d off = transform_error(tree.T_parent_child(joint), exporting::body_from_optical());
    return off.head<3>().norm() < 1e-9 && off.tail<3>().norm() < 0.01;
  } catch (const Error&) {
    return false;
  }
}

bool holds_any(const std::string& name, const std::vector<std::string>& words) {
  return std::any_of(words.begin(), words.end(),
                     [&name](const std::string& word) { return name.find(word) != std::string::npos; });
}

// The optical frame of the colour camera at or below a link.
std::optional<std::string> optical_below(const UrdfTree& tree, const std::string& link) {
  if (is_optical_name(link)) return link;
  bool all_fixed = true;
  std::vector<std::string> optical, colour;
  for (const std::string& below : tree.subtree(link, &all_fixed))
    if (is_optical_name(below)) optical.push_back(below);
  for (const std::string& name : optical)
    if (holds_any(name, {"rgb", "color", "colour"})) colour.push_back(name);
  const std::vector<std::string>& found = colour.empty() ? optical : colour;
  if (found.empty()) return std::nullopt;
  if (found.size() == 1) return found.front();
  std::vector<std::string> shown;
  for (const std::string& name : found) shown.push_back(for_message(name));
  throw Error("below " + for_message(link) + " are several optical frames; --optical names one of " + joined(shown));
}

// The file's own chain counts, as robot_state_publisher has nothing else.
std::string chain_note(const UrdfTree& tree, const ExportCamera& camera, const Place& place) {
  const UrdfChain chain = tree.chain(place.mount, place.link);
  const Vector6d off = transform_error(tree.T_of(chain), *camera.T_link_camera);
  const double off_m = off.head<3>().norm(), off_rad = off.tail<3>().norm();
  if (off_m < 1e-3 && off_rad < deg_to_rad(0.1)) return "";
  return for_message(place.link) + " is " + short_text(100.0 * off_m, 3) + " cm and " +
         short_text(rad_to_deg(off_rad), 3) + " deg elsewhere in " + for_message(place.mount) +
         " than the rig says; the file's place counts, --optical gives another";
}

std::string link_remedy(const ExportCamera& camera) {
  return "--link " + for_message(camera.name) + "=LINK names the camera's link there, or --optical " +
         for_message(camera.name) + "=FRAME its optical frame";
}

// The frame that poses are given in. Robots without one on the ground usually begin with base_link.
std::string robot_link(const UrdfTree& tree, const std::string& name) {
  const bool has_base = name != "base_link" && tree.find_link("base_link");
  return tree.link(name, has_base
                             ? "--parent base_link gives poses in that (--parent-height-mm says how high it stands "
                               "above the ground)"
                             : "--parent LINK gives poses in one that it has");
}

void locate_link(const UrdfTree& tree, const ExportCamera& camera, Place* place) {
  if (camera.rig_says_frames && tree.find_link(camera.optical_frame)) {
    place->mount = tree.link(camera.link);
    place->link = tree.link(camera.optical_frame);
    place->note = chain_note(tree, camera, *place);
    return;
  }
  if (camera.T_link_camera) {
    place->link = place->mount = tree.link(camera.link, link_remedy(camera));
    place->T_link_camera = *camera.T_link_camera;
    return;
  }
  // Without a link that anybody named, the optical frame says all.
  const bool is_told = camera.link != camera.name || tree.find_link(camera.link).has_value();
  if (is_told || camera.optical_frame.empty()) place->mount = tree.link(camera.link, link_remedy(camera));
  if (!camera.optical_frame.empty()) {
    place->link = tree.link(camera.optical_frame);
  } else if (const auto optical = optical_below(tree, place->mount)) {
    place->link = *optical;
  } else {
    place->link = place->mount;
    place->T_link_camera = exporting::body_from_optical();
    place->note = "below " + for_message(place->mount) +
                  " is no optical frame: it is taken as the camera's body (x forward) in the optical centre";
  }
  if (place->mount == place->link && place->note.empty()) place->mount.clear();
}

// "camera" of "camera_color_optical_frame": what a driver calls its device.
std::string device_of(const std::string& optical_frame) {
  static const std::vector<std::string> kEnds = {"frame", "optical", "link",  "rgb",    "color", "colour", "depth",
                                                 "ir",    "infra",   "image", "sensor", "mono",  "gray",   "grey"};
  std::string name = exporting::plain_name(optical_frame);
  for (std::size_t at = name.rfind('_'); at != std::string::npos; at = name.rfind('_')) {
    if (std::find(kEnds.begin(), kEnds.end(), name.substr(at + 1)) == kEnds.end()) break;
    name.resize(at);
  }
  return name;
}

bool belongs_to(const std::string& link, const std::string& device) {
  const std::string name = exporting::plain_name(link);
  return name.compare(0, device.size(), device) == 0 && (name.size() == device.size() || name[device.size()] == '_');
}

// The joint that holds the device as a whole: up from the optical frame as long as links bear the device's name and
// nothing else hangs there.
std::size_t mount_joint(const UrdfTree& tree, const Place& place, const std::vector<Place>& places) {
  const std::vector<std::size_t>& down = place.chain.down;
  std::size_t chosen = down.size() - 1;
  if (chosen > 0 && is_pure_optical(tree, down[chosen])) --chosen;
  const std::string device = device_of(place.link);
  for (std::size_t i = chosen; i-- > 0;) {
    const std::string& child = tree.urdf().joints[down[i]].child;
    bool all_fixed = true;
    const std::set<std::string> below = tree.subtree(child, &all_fixed);
    const bool is_alone = std::none_of(places.begin(), places.end(), [&](const Place& other) {
      return other.camera != place.camera && below.count(other.link) > 0;
    });
    if (!belongs_to(child, device) || !all_fixed || !is_alone) break;
    chosen = i;
  }
  return down[chosen];
}

std::size_t joint_into(const UrdfTree& tree, const Place& place) {
  for (const std::size_t i : place.chain.down)
    if (tree.urdf().joints[i].child == place.mount) return i;
  throw Error("link " + for_message(place.mount) + " does not lie between " + for_message(place.robot) + " and " +
              for_message(place.link) + " in the tree");
}

void choose_joint(const UrdfTree& tree, const std::vector<Place>& places, Place* place) {
  place->chain = tree.chain(place->robot, place->link);
  if (place->chain.down.empty())
    throw Error("link " + for_message(place->link) + " does not hang below " + for_message(place->robot) +
                ", or is that link itself; no joint there can be changed for it");
  if (!place->camera->joint.empty()) {
    place->joint = tree.joint(place->camera->joint);
    const auto& down = place->chain.down;
    if (std::find(down.begin(), down.end(), place->joint) == down.end())
      throw tree.error_of(place->joint,
                          "does not lie between " + for_message(place->robot) + " and " + for_message(place->link));
  } else {
    place->joint = place->mount.empty() ? mount_joint(tree, *place, places) : joint_into(tree, *place);
  }
}

void refuse_computed_origin(const UrdfTree& tree, const Place& place) {
  const exporting::UrdfJoint& joint = tree.urdf().joints[place.joint];
  const bool computed = (joint.xyz && exporting::has_expression(joint.xyz->value)) ||
                        (joint.rpy && exporting::has_expression(joint.rpy->value)) ||
                        (joint.origins == 0 && joint.has_macro);
  if (!computed) return;
  const std::string name = exporting::identifier(exporting::plain_name(joint.child));
  throw tree.error_of(place.joint,
                      "its origin is computed" +
                          (joint.xyz ? " (xyz=\"" + for_message(joint.xyz->value) + "\")" : std::string()) +
                          ", and numbers cannot replace that. Write numbers there; or include the file of "
                          "--to xacro and write xyz=\"${" +
                          name + "_xyz}\" rpy=\"${" + name + "_rpy}\"");
}

// One Error with what each call has to say of its camera.
template <typename Call>
void for_all(std::vector<Place>* places, const Call& call) {
  Problems problems;
  for (Place& place : *places) try {
      call(&place);
    } catch (const Error& error) {
      problems.add({"", 0, place.camera->name, "", error.what()});
    }
  problems.throw_if_any();
}

std::vector<Place> find_places(const ExportJob& job, const UrdfTree& tree) {
  std::vector<Place> places;
  for (const ExportCamera& camera : job.cameras) {
    if (!camera.is_known()) continue;
    places.emplace_back();
    places.back().camera = &camera;
  }
  for_all(&places, [&](Place* place) {
    place->robot = robot_link(tree, place->camera->estimate.parent);
    locate_link(tree, *place->camera, place);
  });
  for_all(&places, [&](Place* place) {
    choose_joint(tree, places, place);
    refuse_computed_origin(tree, *place);
  });
  Problems problems;
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (places[i].joint == places[j].joint)
        problems.add(
            {"", 0, places[i].camera->name, "",
             tree.error_of(places[i].joint, "would change for " + places[j].camera->name +
                                                ", too; --joint names one for each, or --camera exports one of them")
                 .what()});
  problems.throw_if_any();
  return places;
}

// Where a joint has to be so that the camera is where it is, everything else on the chain as the file has it.
Rigid3 pose_of_joint(const UrdfTree& tree, const Place& place) {
  const auto& down = place.chain.down;
  const auto at = std::find(down.begin(), down.end(), place.joint);
  const Rigid3 T_robot_parent = tree.T_of({place.chain.up, {down.begin(), at}});
  const Rigid3 T_child_camera = tree.T_of({{}, {at + 1, down.end()}}) * place.T_link_camera;
  return T_robot_parent.inverse() * place.camera->estimate.T_parent_child * T_child_camera.inverse();
}

std::string text_of(const std::optional<exporting::XmlAttribute>& attribute) {
  return attribute ? attribute->value : "";
}

ChangedJoint describe(const UrdfTree& tree, const Place& place, const exporting::UrdfPose& pose) {
  const exporting::UrdfJoint& joint = tree.urdf().joints[place.joint];
  ChangedJoint changed;
  changed.camera = place.camera->name;
  changed.joint = joint.name;
  changed.parent = joint.parent;
  changed.child = joint.child;
  changed.line = joint.line;
  changed.optical = place.link;
  for (const std::size_t other : place.chain.down)
    if (other != place.joint) changed.others.push_back(tree.urdf().joints[other].name);
  changed.xyz_before = text_of(joint.xyz);
  changed.rpy_before = text_of(joint.rpy);
  changed.xyz_after = exporting::vector_text(pose.xyz_m);
  changed.rpy_after = exporting::vector_text(pose.rpy_rad);
  const Vector6d change = transform_error(pose.transform(), tree.T_parent_child(place.joint));
  changed.moved_m = change.head<3>().norm();
  changed.turned_rad = change.tail<3>().norm();
  return changed;
}

// The file, read anew, must put every camera where it is: a tenth of a nanometre is what the digits leave.
void check_written(const UrdfText& urdf, const std::vector<Place>& places) {
  const UrdfTree tree(urdf);
  for (const Place& place : places) {
    const Rigid3 T = tree.T_of(tree.chain(place.robot, place.link)) * place.T_link_camera;
    if (transform_error(T, place.camera->estimate.T_parent_child).norm() > 1e-8)
      throw std::logic_error("the edited URDF does not have " + place.camera->name + " where it belongs");
  }
}

std::string far_note(const ChangedJoint& joint) {
  if (joint.moved_m < kFar_m && joint.turned_rad < kFar_rad) return "";
  return joint.camera + ": joint " + for_message(joint.joint) + " moves by " + short_text(100.0 * joint.moved_m, 3) +
         " cm and " + short_text(rad_to_deg(joint.turned_rad), 3) + " deg; is " + for_message(joint.optical) +
         " the frame of its images?";
}

}  // namespace

IntoUrdf export_into_urdf(const ExportJob& job, const std::string& text, const std::string& file) {
  UrdfText urdf = exporting::parse_urdf(text, file);
  std::vector<Place> places = find_places(job, UrdfTree(urdf));
  IntoUrdf into;
  // From the root on: what hangs below a joint that has changed is reckoned from where it is then. Joints keep their
  // index.
  std::vector<Place*> order;
  for (Place& place : places) order.push_back(&place);
  std::stable_sort(order.begin(), order.end(), [](const Place* a, const Place* b) {
    const auto depth = [](const Place& p) {
      return std::find(p.chain.down.begin(), p.chain.down.end(), p.joint) - p.chain.down.begin();
    };
    return depth(*a) < depth(*b);
  });
  Problems problems;
  for (const Place* place : order) try {
      const UrdfTree tree(urdf);
      const exporting::UrdfPose pose = exporting::urdf_pose(pose_of_joint(tree, *place));
      into.joints.push_back(describe(tree, *place, pose));
      const ChangedJoint& changed = into.joints.back();
      urdf = exporting::parse_urdf(
          exporting::with_origin(urdf, urdf.joints[place->joint], changed.xyz_after, changed.rpy_after), file);
      if (!place->note.empty()) into.notes.push_back(changed.camera + ": " + place->note);
      if (std::string note = far_note(changed); !note.empty()) into.notes.push_back(std::move(note));
    } catch (const Error& error) {
      problems.add({"", 0, place->camera->name, "", error.what()});
    }
  problems.throw_if_any();
  check_written(urdf, places);
  into.text = urdf.text;
  return into;
}

}  // namespace rigproof
