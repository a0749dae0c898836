#include "rival_result.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/exclusions.h"

namespace rigproof::rivals {

void report_use(const Observations& observations, const std::vector<ViewPose>& views, const UsedViews& used,
                const Finding& reason_for_others, Result* result) {
  for (std::size_t k = 0; k < observations.cameras.size(); ++k) {
    const int camera = static_cast<int>(k);
    CameraUse use;
    use.camera = observations.cameras[k].name;
    use.left_out = exclusions_of(observations.exclusions, camera);
    double sum = 0.0;
    for (const ViewPose& view : views) {
      if (view.camera != camera) continue;
      if (used.count({view.stop, camera}) > 0) {
        ++use.used;
        sum += view.reprojection_rms_px * view.reprojection_rms_px;
      } else {
        const std::string& file = observations.board_views[static_cast<std::size_t>(view.view)].file;
        use.left_out.push_back({camera, view.stop, file, reason_for_others});
      }
    }
    use.reprojection_rms_px = use.used > 0 ? std::sqrt(sum / use.used) : 0.0;
    std::stable_sort(use.left_out.begin(), use.left_out.end(),
                     [](const Exclusion& a, const Exclusion& b) { return a.stop < b.stop; });
    result->use.push_back(use);
  }
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

void conclude_by_cameras(const Observations& observations, Result* result) {
  if (observations.cameras.empty()) result->reasons.emplace_back("rig.no_camera");
  if (result->camera_to_robot.empty())
    result->status = ResultStatus::kRefused;
  else if (result->camera_to_robot.size() < observations.cameras.size())
    result->status = ResultStatus::kPartial;
  else
    result->status = ResultStatus::kSolved;
}

}  // namespace rigproof::rivals
