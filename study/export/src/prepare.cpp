#include <algorithm>
#include <set>

#include "parent_frame.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/study/export/export.h"

namespace rigproof {
namespace {

std::vector<std::string> names_of(const Result& result) {
  std::vector<std::string> names;
  for (const EstimatedTransform& estimate : result.camera_to_robot) names.push_back(estimate.child);
  return names;
}

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

template <typename Value>
void check_names(const std::map<std::string, Value>& values, const char* option, const std::vector<std::string>& known,
                 Problems* problems) {
  for (const auto& entry : values)
    if (!holds(known, entry.first))
      problems->add({"", 0, option, for_message(entry.first),
                     "the result has no such camera; " + suggestion(entry.first, known)});
}

std::string unknown_axes(const EstimatedTransform& estimate) {
  std::vector<std::string> axes;
  for (std::size_t i = 0; i < 6; ++i)
    if (!estimate.observable[i]) axes.emplace_back(kDegreeOfFreedomNames[i]);
  return joined(axes);
}

std::string place_of(const ExportOptions& options) {
  return options.result_file.empty() ? "result" : options.result_file;
}

void refuse_empty(const Result& result, const ExportOptions& options) {
  if (!result.camera_to_robot.empty()) return;
  throw Error(place_of(options) + ": is " + result_status_name(result.status) +
                  " and holds no pose; there is nothing to export",
              ExitCode::kRefused);
}

void refuse_partial(const Result& result, const ExportOptions& options) {
  if (options.partial) return;
  const std::string place = place_of(options);
  std::string unknown;
  for (const EstimatedTransform& estimate : result.camera_to_robot)
    if (!estimate.fully_observable())
      unknown += (unknown.empty() ? "" : "; ") + estimate.child + ": " + unknown_axes(estimate);
  if (result.status == ResultStatus::kSolved && unknown.empty()) return;
  throw Error(place + ": is " + result_status_name(result.status) +
                  (unknown.empty() ? "" : ", unknown are " + unknown) +
                  ". Correct what it names and calibrate again, or export what is known with --partial",
              ExitCode::kRefused);
}

template <typename Value>
const Value* find(const std::map<std::string, Value>& values, const std::string& name) {
  const auto found = values.find(name);
  return found == values.end() ? nullptr : &found->second;
}

void take_rig(const RigCamera& from, ExportCamera* camera) {
  if (!from.link.empty()) camera->link = from.link;
  camera->optical_frame = from.optical_frame;
  camera->T_link_camera = from.T_link_camera;
  camera->rig_says_frames = from.T_link_camera.has_value();
  if (from.camera.width_px > 0) camera->told = from.camera;
}

// Another link, or another frame below it: what the rig says of those that it names no longer holds.
void forget_rig_frames(ExportCamera* camera) {
  if (camera->rig_says_frames) camera->T_link_camera.reset();
  camera->rig_says_frames = false;
}

void take_options(const ExportOptions& options, ExportCamera* camera) {
  const auto* link = find(options.links, camera->name);
  if (link != nullptr && *link != camera->link) {
    forget_rig_frames(camera);
    camera->link = *link;
  }
  const auto* frame = find(options.optical_frames, camera->name);
  if (frame != nullptr && *frame != camera->optical_frame) {
    forget_rig_frames(camera);
    camera->optical_frame = *frame;
  }
  if (const auto* T = find(options.T_link_camera, camera->name)) {
    camera->T_link_camera = *T;
    camera->rig_says_frames = false;
  }
  if (const auto* joint = find(options.joints, camera->name)) camera->joint = *joint;
}

// A frame keeps its parent where that is fixed to the robot frame.
void take_parent(const FrameTree& tree, ExportCamera* camera) {
  const auto edge = tree.edges().find(camera->link);
  const std::string& robot = camera->estimate.parent;
  if (edge == tree.edges().end() || edge->second.parent == robot) return;
  const std::optional<Rigid3> T_robot_parent = tree.between(robot, edge->second.parent);
  const std::vector<std::string> above = tree.way_up(robot);
  // Not where the robot frame hangs below the camera.
  if (!T_robot_parent || std::find(above.begin(), above.end(), camera->link) != above.end()) return;
  camera->parent = edge->second.parent;
  camera->T_robot_parent = *T_robot_parent;
}

ExportCamera export_camera(const Result& result, const EstimatedTransform& estimate, const RigFacts& rig,
                           const ExportOptions& options, const exporting::ParentFrame& parent) {
  ExportCamera camera;
  camera.name = camera.link = estimate.child;
  camera.estimate = parent.given_here(heading_free(estimate));
  for (const RigCamera& from : rig.cameras)
    if (from.name == camera.name) take_rig(from, &camera);
  take_options(options, &camera);
  if (options.parent.empty()) take_parent(rig.tf_static, &camera);
  for (const EstimatedLens& lens : result.lenses)
    if (lens.camera == camera.name) camera.estimated = lens.intrinsics;
  return camera;
}

}  // namespace

void check_export_names(const Result& result, const ExportOptions& options) {
  if (result.camera_to_robot.empty()) return;  // it is refused for that
  const std::vector<std::string> known = names_of(result);
  Problems problems;
  for (const std::string& name : options.cameras)
    if (!holds(known, name))
      problems.add({"", 0, "--camera", for_message(name), "the result has no such camera; " + suggestion(name, known)});
  check_names(options.links, "--link", known, &problems);
  check_names(options.optical_frames, "--optical", known, &problems);
  check_names(options.T_link_camera, "--optical", known, &problems);
  check_names(options.joints, "--joint", known, &problems);
  problems.throw_if_any();
}

ExportJob prepare_export(const Result& result, const RigFacts& rig, const ExportOptions& options) {
  refuse_empty(result, options);
  check_export_names(result, options);
  refuse_partial(result, options);
  ExportJob job;
  job.method = result.method;
  job.status = result.status;
  job.result_file = options.result_file;
  job.rig_source = rig.source;
  job.date = options.date;
  job.warnings = options.warnings;
  const exporting::ParentFrame parent =
      exporting::parent_frame(result.camera_to_robot.front().parent, rig.tf_static, options);
  std::set<std::string> wanted;
  for (const EstimatedTransform& estimate : result.camera_to_robot) {
    if (!options.cameras.empty() && !holds(options.cameras, estimate.child)) continue;
    job.cameras.push_back(export_camera(result, estimate, rig, options, parent));
    wanted.insert(estimate.child);
  }
  job.frame_notes = parent.notes;
  const std::string note = options.parent.empty() ? exporting::note_of_other_parents(job.cameras, rig.tf_static) : "";
  if (!note.empty()) job.frame_notes.push_back(note);
  for (const EstimatedTransform& between : result.camera_to_camera)
    if (wanted.count(between.parent) > 0 && wanted.count(between.child) > 0) job.camera_to_camera.push_back(between);
  return job;
}

}  // namespace rigproof
