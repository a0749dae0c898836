// Everything that is known of the cameras, versioned and described by a schema.
#include <algorithm>
#include <cmath>

#include "numbers.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/version.h"
#include "rigproof/core/yaml.h"
#include "rigproof/study/export/export.h"
#include "tree_frames.h"

namespace rigproof {
namespace {

constexpr int kVersion = 1;
const char* const kFormat = "rigproof-export";
// As in results.
const char* const kPartialKeys[] = {"tx_m", "ty_m", "tz_m", "roll_rad", "pitch_rad", "yaw_rad"};

YamlTree numbers(const Eigen::VectorXd& values) {
  return YamlTree::numbers(std::vector<double>(values.data(), values.data() + values.size()));
}

void add_pose(const Rigid3& T, YamlTree* tree) {
  tree->set("translation_m", numbers(T.translation));
  tree->set("quaternion_xyzw", numbers(T.rotation.coeffs()));
  YamlTree& rows = tree->set("matrix", YamlTree::sequence());
  const Eigen::Matrix4d matrix = T.matrix();
  for (Eigen::Index i = 0; i < 4; ++i) rows.add(numbers(matrix.row(i).transpose()));
}

void add_partial_pose(const EstimatedTransform& estimate, YamlTree* tree) {
  const Rigid3 body = estimate.T_parent_child * exporting::body_from_optical().inverse();
  const exporting::UrdfPose pose = exporting::urdf_pose(body);
  std::vector<std::string> unknown;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto at = static_cast<Eigen::Index>(i % 3);
    if (!estimate.observable[i])
      unknown.emplace_back(kDegreeOfFreedomNames[i]);
    else
      tree->set(kPartialKeys[i], YamlTree::number(i < 3 ? pose.xyz_m[at] : pose.rpy_rad[at]));
  }
  tree->set("unobservable", YamlTree::texts(unknown));
}

YamlTree pose_tree(const EstimatedTransform& estimate) {
  YamlTree tree = YamlTree::map();
  tree.set("parent", YamlTree::text(estimate.parent));
  tree.set("child", YamlTree::text(estimate.child));
  if (estimate.fully_observable())
    add_pose(estimate.T_parent_child, &tree);
  else
    add_partial_pose(estimate, &tree);
  if (!estimate.covariance) return tree;
  YamlTree& sigmas = tree.set("sigma", YamlTree::map());
  for (std::size_t i = 0; i < 6; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (estimate.observable[i])
      sigmas.set(std::string(kDegreeOfFreedomNames[i]) + (i < 3 ? "_m" : "_rad"),
                 YamlTree::number(std::sqrt(std::max(0.0, (*estimate.covariance)(at, at)))));
  }
  return tree;
}

YamlTree lens_tree(const Camera& lens) {
  YamlTree tree = YamlTree::map();
  tree.set("width_px", YamlTree::integer(lens.width_px));
  tree.set("height_px", YamlTree::integer(lens.height_px));
  tree.set("fx_px", YamlTree::number(lens.fx_px));
  tree.set("fy_px", YamlTree::number(lens.fy_px));
  tree.set("cx_px", YamlTree::number(lens.cx_px));
  tree.set("cy_px", YamlTree::number(lens.cy_px));
  tree.set("lens", YamlTree::text(lens_name(lens.lens)));
  tree.set("distortion", YamlTree::numbers(std::vector<double>(
                             lens.distortion.begin(), lens.distortion.begin() + coefficient_count(lens.lens))));
  return tree;
}

YamlTree camera_tree(const ExportCamera& camera) {
  YamlTree tree = YamlTree::map();
  tree.set("camera", YamlTree::text(camera.name));
  tree.set("link", YamlTree::text(camera.link));
  if (!camera.optical_frame.empty()) tree.set("optical_frame", YamlTree::text(camera.optical_frame));
  tree.set("pose", pose_tree(camera.estimate));
  if (camera.intrinsics() == nullptr) return tree;
  tree.set("intrinsics", lens_tree(*camera.intrinsics()));
  tree.set("intrinsics_are", YamlTree::text(camera.estimated ? "estimated" : "told"));
  if (!camera.estimated || !camera.told) return tree;
  tree.set("told_intrinsics", lens_tree(*camera.told));
  tree.set("told_off_px", YamlTree::number(largest_pixel_difference(*camera.told, *camera.estimated)));
  return tree;
}

YamlTree transform_tree(const TreeTransform& transform) {
  YamlTree tree = YamlTree::map();
  tree.set("camera", YamlTree::text(transform.camera));
  tree.set("parent", YamlTree::text(transform.parent));
  tree.set("child", YamlTree::text(transform.child));
  add_pose(transform.T_parent_child, &tree);
  tree.set("rpy_rad", numbers(exporting::urdf_pose(transform.T_parent_child).rpy_rad));
  return tree;
}

std::vector<std::string> all_remarks(const ExportJob& job) {
  std::vector<std::string> remarks = remarks_of(job);
  for (const std::string& note : tree_notes(job)) remarks.push_back(note);
  return remarks;
}

ExportOutput write(const ExportJob& job) {
  YamlTree tree = YamlTree::map();
  tree.set("format", YamlTree::text(kFormat));
  tree.set("version", YamlTree::integer(kVersion));
  tree.set("tool_version", YamlTree::text(version()));
  tree.set("date", YamlTree::text(job.date));
  tree.set("result", YamlTree::text(job.result_file));
  tree.set("method", YamlTree::text(job.method));
  tree.set("status", YamlTree::text(result_status_name(job.status)));
  tree.set("remarks", YamlTree::texts(all_remarks(job)));
  YamlTree& cameras = tree.set("cameras", YamlTree::sequence());
  for (const ExportCamera& camera : job.cameras) cameras.add(camera_tree(camera));
  YamlTree& pairs = tree.set("camera_to_camera", YamlTree::sequence());
  for (const EstimatedTransform& pair : job.camera_to_camera)
    if (pair.fully_observable()) pairs.add(pose_tree(pair));
  YamlTree& transforms = tree.set("tree", YamlTree::sequence());
  for (const TreeTransform& transform : tree_transforms(job)) transforms.add(transform_tree(transform));
  return {{{"", emit_json(tree, 2) + "\n"}}, {}};
}

using Lines = std::vector<KeyLine>;

Lines pose_keys(const std::string& path, const std::string& what) {
  return {{path, "", what},
          {path + ".parent", "text", "frame that the pose is given in"},
          {path + ".child", "text", "frame whose pose it is: optical axes"},
          {path + ".translation_m?", "numbers", "x, y, z; where all six degrees of freedom are known"},
          {path + ".quaternion_xyzw?", "numbers", "the same"},
          {path + ".matrix?[]", "numbers", "the same as a row of 4x4"},
          {path + ".unobservable?", "texts", "degrees of freedom that the data do not determine"},
          {path + ".tx_m?", "number", "where not all are known: those that are"},
          {path + ".ty_m?", "number", "the same"},
          {path + ".tz_m?", "number", "the same"},
          {path + ".roll_rad?", "number", "the same, of the camera's body axes: R = Rz(yaw) Ry(pitch) Rx(roll)"},
          {path + ".pitch_rad?", "number", "the same"},
          {path + ".yaw_rad?", "number", "the same"},
          {path + ".sigma?", "", "one sigma of those that are known"},
          {path + ".sigma.NAME", "number", "tx_m ty_m tz_m rx_rad ry_rad rz_rad, along the parent's axes"}};
}

Lines lens_keys(const std::string& path, const std::string& what) {
  return {{path, "", what},
          {path + ".width_px", "integer", "of the image"},
          {path + ".height_px", "integer", "of the image"},
          {path + ".fx_px", "number", "focal length along x"},
          {path + ".fy_px", "number", "focal length along y"},
          {path + ".cx_px", "number", "principal point; pixel centres are whole numbers"},
          {path + ".cy_px", "number", "principal point"},
          {path + ".lens", "pinhole | brown_conrady | kannala_brandt", "model of the distortion"},
          {path + ".distortion", "numbers", "brown_conrady: k1 k2 p1 p2 k3; kannala_brandt: k1 k2 k3 k4"}};
}

}  // namespace

std::string export_json_schema() {
  Lines keys = {{"format", "text", kFormat},
                {"version", "integer", "of this format"},
                {"tool_version", "text", "of the program"},
                {"date", "text", "of the export; empty: not said"},
                {"result", "text", "the file that was exported"},
                {"method", "text", "what estimated it"},
                {"status", "solved | partial | refused", "whether everything was answered"},
                {"remarks", "texts", "what the user should know, in words"},
                {"cameras[]", "", "one a camera"},
                {"cameras[].camera", "text", "its name"},
                {"cameras[].link", "text", "the camera in the tree of frames"},
                {"cameras[].optical_frame?", "text", "its optical frame there, where somebody says"}};
  for (const Lines& lines :
       {pose_keys("cameras[].pose", "of the optical frame in the robot"),
        lens_keys("cameras[].intrinsics?", "those that the pose goes with"),
        Lines{{"cameras[].intrinsics_are?", "estimated | told", "where they are from"}},
        lens_keys("cameras[].told_intrinsics?", "those of the rig, where others were estimated"),
        Lines{{"cameras[].told_off_px?", "number", "largest distance between the two in the image"}},
        pose_keys("camera_to_camera[]", "poses of the cameras in each other"),
        Lines{{"tree[]", "", "transforms for a tree of frames"},
              {"tree[].camera", "text", "that it belongs to"},
              {"tree[].parent", "text", "frame"},
              {"tree[].child", "text", "frame, which has no other parent"},
              {"tree[].translation_m", "numbers", "x, y, z of the child in the parent"},
              {"tree[].quaternion_xyzw", "numbers", "from child to parent"},
              {"tree[].matrix[]", "numbers", "a row of 4x4"},
              {"tree[].rpy_rad", "numbers", "roll, pitch, yaw as URDF has them"}}})
    keys.insert(keys.end(), lines.begin(), lines.end());
  return schema_of_keys("Rigproof export: what `export --to json` writes", keys, kVersion);
}

ExportFormat json_export() {
  ExportFormat format;
  format.name = "json";
  format.what = "everything, partial poses too, with a schema: `rigproof schema export`";
  format.needs_poses = false;
  format.write = write;
  return format;
}

}  // namespace rigproof
