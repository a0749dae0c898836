// Kalibr's camchain: intrinsics, and the pose of each camera's predecessor in it (T_cn_cnm1).
#include <Eigen/QR>
#include <algorithm>
#include <vector>

#include "comments.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/core/yaml.h"
#include "rigproof/study/export/export.h"

namespace rigproof {
namespace {

// A lens of k1 k2 p1 p2 may differ by this from one with k3: less than that costs no calibration anything.
constexpr double kLargestDifference_px = 0.5;

/// Kalibr's radtan has no k3. The four coefficients with which all of the image comes out as near as can be: distorted
/// points are linear in them.
Camera without_k3(const Camera& lens) {
  constexpr int kSteps = 24;
  std::vector<Eigen::Vector4d> rows;
  std::vector<double> right;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d pixel((lens.width_px - 1) * i / double{kSteps}, (lens.height_px - 1) * j / double{kSteps});
      Eigen::Vector3d ray;
      if (!lens.unproject(pixel, &ray)) continue;
      const double x = ray.x(), y = ray.y(), r2 = x * x + y * y;
      rows.push_back(lens.fx_px * Eigen::Vector4d(x * r2, x * r2 * r2, 2.0 * x * y, r2 + 2.0 * x * x));
      rows.push_back(lens.fy_px * Eigen::Vector4d(y * r2, y * r2 * r2, r2 + 2.0 * y * y, 2.0 * x * y));
      right.push_back(pixel.x() - lens.cx_px - lens.fx_px * x);
      right.push_back(pixel.y() - lens.cy_px - lens.fy_px * y);
    }
  Eigen::MatrixX4d A(static_cast<Eigen::Index>(rows.size()), 4);
  for (std::size_t i = 0; i < rows.size(); ++i) A.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  const Eigen::Map<const Eigen::VectorXd> b(right.data(), A.rows());
  const Eigen::Vector4d k = A.colPivHouseholderQr().solve(b);
  Camera fitted = lens;
  fitted.distortion = {k[0], k[1], k[2], k[3], 0.0};
  return fitted;
}

Camera as_kalibr(const ExportCamera& camera, std::vector<std::string>* notes, Problems* problems) {
  const Camera& lens = *camera.intrinsics();
  if (lens.lens != Lens::kBrownConrady || lens.distortion[4] == 0.0) return lens;
  const Camera fitted = without_k3(lens);
  const double off_px = largest_pixel_difference(lens, fitted);
  const std::string what = "Kalibr's radtan has no k3 (" + short_text(lens.distortion[4], 3) +
                           "); k1 k2 p1 p2 in its stead are up to " + short_text(off_px, 2) + " px off";
  if (off_px > kLargestDifference_px)
    problems->add(
        {"", 0, camera.name, "",
         what + ", allowed is " + short_text(kLargestDifference_px, 1) + " px; opencv and json hold this lens"});
  notes->push_back(camera.name + ": " + what);
  return fitted;
}

const char* distortion_model(Lens lens) {
  if (lens == Lens::kKannalaBrandt) return "equidistant";
  return lens == Lens::kBrownConrady ? "radtan" : "none";
}

/// Pose of camera a in camera b, from the pair where the result states it: that is known without the robot, too.
std::optional<Rigid3> pose_in(const ExportJob& job, const ExportCamera& a, const ExportCamera& b) {
  for (const EstimatedTransform& pair : job.camera_to_camera) {
    if (!pair.fully_observable()) continue;
    if (pair.parent == b.name && pair.child == a.name) return pair.T_parent_child;
    if (pair.parent == a.name && pair.child == b.name) return pair.T_parent_child.inverse();
  }
  if (!a.is_known() || !b.is_known() || a.estimate.parent != b.estimate.parent) return std::nullopt;
  return b.estimate.T_parent_child.inverse() * a.estimate.T_parent_child;
}

YamlTree rows_of(const Eigen::Matrix4d& matrix) {
  YamlTree rows = YamlTree::sequence();
  for (Eigen::Index i = 0; i < 4; ++i)
    rows.add(YamlTree::numbers({matrix(i, 0), matrix(i, 1), matrix(i, 2), matrix(i, 3)}));
  return rows;
}

YamlTree camera_tree(const Camera& lens, const std::string& name) {
  YamlTree tree = YamlTree::map();
  tree.set("camera_model", YamlTree::text("pinhole"));
  tree.set("intrinsics", YamlTree::numbers({lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px}));
  tree.set("distortion_model", YamlTree::text(distortion_model(lens.lens)));
  std::vector<double> coefficients;
  if (lens.lens != Lens::kPinhole) coefficients.assign(lens.distortion.begin(), lens.distortion.begin() + 4);
  tree.set("distortion_coeffs", YamlTree::numbers(coefficients));
  tree.set("resolution", YamlTree::numbers({double(lens.width_px), double(lens.height_px)}));
  tree.set("rostopic", YamlTree::text("/" + name + "/image_raw"));
  return tree;
}

ExportOutput write(const ExportJob& job) {
  ExportOutput output;
  Problems problems;
  YamlTree chain = YamlTree::map();
  std::vector<std::string> names;
  const ExportCamera* before = nullptr;
  for (const ExportCamera& camera : job.cameras) {
    const std::string key = "cam" + std::to_string(names.size());
    YamlTree tree = camera_tree(as_kalibr(camera, &output.notes, &problems), camera.name);
    if (before != nullptr) {
      const std::optional<Rigid3> T = pose_in(job, *before, camera);
      if (!T) {
        output.notes.push_back(camera.name + ": left out, for its pose beside " + before->name + " is not known");
        continue;
      }
      tree.set("T_cn_cnm1", rows_of(T->matrix()));
    }
    chain.set(key, std::move(tree));
    names.push_back(key + " is " + camera.name);
    before = &camera;
  }
  problems.throw_if_any();
  std::vector<std::string> head = exporting::head_lines(job);
  head.push_back(joined(names) + ". T_cn_cnm1 is the pose of the camera before in this one. Topics are made up.");
  head.insert(head.end(), output.notes.begin(), output.notes.end());
  output.files.push_back({"", exporting::hash_comment(head) + emit_yaml(chain)});
  return output;
}

}  // namespace

ExportFormat kalibr_export() {
  ExportFormat format;
  format.name = "kalibr";
  format.what = "Kalibr's camchain: intrinsics and T_cn_cnm1";
  format.is_tree = false;
  format.needs_poses = false;
  format.needs_intrinsics = true;
  format.write = write;
  return format;
}

}  // namespace rigproof
