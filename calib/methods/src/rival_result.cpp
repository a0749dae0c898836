#include "rival_result.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/error_jacobians.h"
#include "rigproof/core/exclusions.h"

namespace rigproof::rivals {

void report_use(const Observations& observations, const std::vector<ViewPose>& views,
                const std::vector<Exclusion>& left_out, Result* result) {
  for (std::size_t k = 0; k < observations.cameras.size(); ++k) {
    const int camera = static_cast<int>(k);
    const std::vector<Exclusion> own = exclusions_of(left_out, camera);
    CameraUse use;
    use.camera = observations.cameras[k].name;
    use.left_out = exclusions_of(observations.exclusions, camera);
    use.left_out.insert(use.left_out.end(), own.begin(), own.end());
    std::stable_sort(use.left_out.begin(), use.left_out.end(),
                     [](const Exclusion& a, const Exclusion& b) { return a.stop < b.stop; });
    double sum = 0.0;
    for (const ViewPose& view : views) {
      const auto is_it = [&view](const Exclusion& exclusion) { return exclusion.stop == view.stop; };
      if (view.camera != camera || std::any_of(own.begin(), own.end(), is_it)) continue;
      ++use.used;
      sum += view.reprojection_rms_px * view.reprojection_rms_px;
    }
    use.reprojection_rms_px = use.used > 0 ? std::sqrt(sum / use.used) : 0.0;
    result->use.push_back(use);
  }
}

void report_use(const Observations& observations, const std::vector<ViewPose>& views, const UsedViews& used,
                const Finding& reason_for_others, Result* result) {
  std::vector<Exclusion> left_out;
  for (const ViewPose& view : views) {
    const std::string& file = observations.board_views[static_cast<std::size_t>(view.view)].file;
    if (used.count({view.stop, view.camera}) == 0)
      left_out.push_back({view.camera, view.stop, file, reason_for_others});
  }
  report_use(observations, views, left_out, result);
}

Quotient::Quotient(const Rigid3& A, const Rigid3& B) : T(A * B.inverse()) {
  const RelativeJacobian by_both = relative_error_jacobian_of_inverses(A, B);
  by_A = by_both.leftCols<6>();
  by_B = by_both.rightCols<6>();
}

EstimatedTransform camera_in_robot(const Observations& observations, int camera, const Rigid3& T_robot_camera) {
  EstimatedTransform transform;
  transform.parent = observations.robot_frame;
  transform.child = observations.cameras[static_cast<std::size_t>(camera)].name;
  transform.T_parent_child = T_robot_camera;
  return transform;
}

void add_pairs_from_robot(const Observations& observations, Result* result) {
  const auto pose_of = [&](const RigCamera& camera) { return result->find(observations.robot_frame, camera.name); };
  for (std::size_t j = 0; j < observations.cameras.size(); ++j) {
    for (std::size_t k = j + 1; k < observations.cameras.size(); ++k) {
      const RigCamera &first = observations.cameras[j], &second = observations.cameras[k];
      const EstimatedTransform *X_j = pose_of(first), *X_k = pose_of(second);
      if (X_j == nullptr || X_k == nullptr || !X_j->fully_observable() || !X_k->fully_observable()) continue;
      const Rigid3 T_j_k = X_j->T_parent_child.inverse() * X_k->T_parent_child;
      result->camera_to_camera.push_back({first.name, second.name, T_j_k, std::nullopt, X_j->observable});
    }
  }
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

void conclude(bool complete, Result* result) {
  if (result->camera_to_robot.empty() && result->camera_to_camera.empty())
    result->status = ResultStatus::kRefused;
  else
    result->status = complete ? ResultStatus::kSolved : ResultStatus::kPartial;
}

void conclude_by_cameras(const Observations& observations, Result* result) {
  if (observations.cameras.empty()) result->reasons.emplace_back("rig.no_camera");
  conclude(result->camera_to_robot.size() == observations.cameras.size(), result);
}

}  // namespace rigproof::rivals
