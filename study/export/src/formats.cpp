#include <algorithm>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/study/export/export.h"
#include "tree_frames.h"

namespace rigproof {

ExportFormat urdf_export();
ExportFormat xacro_export();
ExportFormat static_tf_export();
ExportFormat launch_export();
ExportFormat kalibr_export();
ExportFormat opencv_export();
ExportFormat camera_info_export();
ExportFormat json_export();
ExportFormat matrix_export();

// A format is a line here.
const std::vector<ExportFormat>& export_formats() {
  static const std::vector<ExportFormat> all = {
      urdf_export(),   xacro_export(),       static_tf_export(), launch_export(), kalibr_export(),
      opencv_export(), camera_info_export(), json_export(),      matrix_export(),
  };
  return all;
}

std::vector<std::string> export_format_names() {
  std::vector<std::string> names;
  for (const ExportFormat& format : export_formats()) names.push_back(format.name);
  return names;
}

const ExportFormat& export_format(const std::string& name) {
  for (const ExportFormat& format : export_formats())
    if (format.name == name) return format;
  throw Error("--to: \"" + for_message(name) + "\": " + suggestion(name, export_format_names()));
}

namespace {

void check_intrinsics(const ExportJob& job, const ExportFormat& format) {
  Problems problems;
  for (const ExportCamera& camera : job.cameras)
    if (camera.intrinsics() == nullptr)
      problems.add({"", 0, camera.name, "",
                    format.name + " holds intrinsics, and neither the result nor a rig tells them; name the rig with "
                                  "--rig, a rig.yaml, a recording or observations.json"});
  problems.throw_if_any();
}

void check_poses(const ExportJob& job) {
  if (std::any_of(job.cameras.begin(), job.cameras.end(), [](const ExportCamera& c) { return c.is_known(); })) return;
  throw Error("no camera's pose is known in all six degrees of freedom; --to json holds those that are known",
              ExitCode::kRefused);
}

}  // namespace

ExportOutput write_export(const ExportJob& job, const ExportFormat& format) {
  if (format.needs_intrinsics) check_intrinsics(job, format);
  if (format.needs_poses) check_poses(job);
  ExportOutput output = format.write(job);
  if (!format.is_tree) return output;
  const std::vector<std::string> notes = tree_notes(job);
  output.notes.insert(output.notes.begin(), notes.begin(), notes.end());
  return output;
}

}  // namespace rigproof
