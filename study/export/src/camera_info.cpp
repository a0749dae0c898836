// Intrinsics as ROS' camera_calibration_parsers reads them: a file for each camera.
#include "comments.h"
#include "rigproof/core/error.h"
#include "rigproof/core/yaml.h"
#include "rigproof/study/export/export.h"

namespace rigproof {
namespace {

YamlTree matrix(std::int64_t rows, std::int64_t columns, const std::vector<double>& data) {
  YamlTree tree = YamlTree::map();
  tree.set("rows", YamlTree::integer(rows));
  tree.set("cols", YamlTree::integer(columns));
  tree.set("data", YamlTree::numbers(data));
  return tree;
}

std::string camera_text(const ExportJob& job, const ExportCamera& camera) {
  const Camera& lens = *camera.intrinsics();
  const bool fisheye = lens.lens == Lens::kKannalaBrandt;
  const std::int64_t count = fisheye ? 4 : 5;
  YamlTree tree = YamlTree::map();
  tree.set("image_width", YamlTree::integer(lens.width_px));
  tree.set("image_height", YamlTree::integer(lens.height_px));
  tree.set("camera_name", YamlTree::text(camera.name));
  tree.set("camera_matrix", matrix(3, 3, {lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1}));
  tree.set("distortion_model", YamlTree::text(fisheye ? "equidistant" : "plumb_bob"));
  tree.set("distortion_coefficients", matrix(1, count, {lens.distortion.begin(), lens.distortion.begin() + count}));
  tree.set("rectification_matrix", matrix(3, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1}));
  tree.set("projection_matrix", matrix(3, 4, {lens.fx_px, 0, lens.cx_px, 0, 0, lens.fy_px, lens.cy_px, 0, 0, 0, 1, 0}));
  return exporting::hash_comment(exporting::head_lines(job)) + emit_yaml(tree);
}

ExportOutput write(const ExportJob& job) {
  ExportOutput output;
  for (const ExportCamera& camera : job.cameras)
    output.files.push_back({camera.name + ".yaml", camera_text(job, camera)});
  return output;
}

}  // namespace

ExportFormat camera_info_export() {
  ExportFormat format;
  format.name = "camera_info";
  format.what = "ROS camera_info, intrinsics alone: a file for each camera";
  format.is_tree = false;
  format.needs_poses = false;
  format.needs_intrinsics = true;
  format.file_per_camera = true;
  format.write = write;
  return format;
}

}  // namespace rigproof
