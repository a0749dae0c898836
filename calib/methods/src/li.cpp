// Li, Heng, Koser, Pollefeys 2013: cameras from a pattern that they see together, without odometry and ground.
#include <cmath>

#include "pattern_bundle.h"
#include "pattern_graph.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/core/exclusions.h"
#include "rival_result.h"

namespace rigproof {
namespace {

using rivals::PatternBundle;
using rivals::PatternPart;

std::vector<std::string> names_of(const Observations& observations, const std::vector<int>& cameras) {
  std::vector<std::string> names;
  for (const int camera : cameras) names.push_back(observations.cameras[static_cast<std::size_t>(camera)].name);
  return names;
}

// T_j_k = T_j_root T_k_root^-1 with the covariance of both.
EstimatedTransform pair_of(const Observations& observations, const PatternBundle& bundle, std::size_t a,
                           std::size_t b) {
  const rivals::Quotient T_j_k(bundle.part.T_camera_root[a], bundle.part.T_camera_root[b]);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, bundle.covariance.cols());
  if (a > 0) J.middleCols<6>(6 * (static_cast<Eigen::Index>(a) - 1)) = T_j_k.by_A;
  if (b > 0) J.middleCols<6>(6 * (static_cast<Eigen::Index>(b) - 1)) = T_j_k.by_B;
  const std::vector<std::string> names = names_of(observations, {bundle.part.cameras[a], bundle.part.cameras[b]});
  return {names[0], names[1], T_j_k.T, Matrix6d(J * bundle.covariance * J.transpose())};
}

// Li, Heng, Koser, Pollefeys 2013: bundle adjustment of a pattern that several cameras see. Camera to camera only.
class LiMethod : public Method {
 public:
  MethodTraits traits() const override {
    return {"li",
            "Bundle adjustment of the board over all cameras that see it together (Li et al. 2013)",
            "board, seen by two cameras at one stop",
            "camera to camera only",
            MethodReads::kObservations,
            2e-4};
  }

  std::optional<Finding> why_not(const MethodInput& input) const override {
    const std::vector<BoardView>& views = input.observations.board_views;
    for (std::size_t i = 1; i < views.size(); ++i)
      if (views[i].stop == views[i - 1].stop) return {};
    return Finding("method.no_overlap");
  }

  Result solve(const Observations& observations) const override {
    Result result;
    result.method = "li";
    const ViewPoses views = estimate_view_poses(observations);
    const std::vector<PatternPart> parts = rivals::pattern_parts(observations, views.poses);
    rivals::UsedViews used;
    double squared = 0.0;
    int corners = 0;
    for (const PatternPart& part : parts) {
      if (part.cameras.size() < 2) continue;
      const PatternBundle bundle = rivals::adjust_pattern(observations, part);
      if (!bundle.converged)
        result.notes.push_back(Finding("solver.no_convergence").of(names_of(observations, part.cameras)));
      add_pairs(observations, bundle, &result);
      mark_used(views.poses, bundle, &used);
      squared += bundle.rms_px * bundle.rms_px * bundle.corners;
      corners += bundle.corners;
    }
    if (corners > 0) result.residuals.push_back({"corners", "px", corners, std::sqrt(squared / corners)});
    rivals::report_use(observations, views.poses, used, Finding("view.alone"), &result);
    conclude(observations, parts, &result);
    return result;
  }

 private:
  // Only pairs in the order of the cameras, whatever the order in which the tree reached them.
  static void add_pairs(const Observations& observations, const PatternBundle& bundle, Result* result) {
    for (std::size_t a = 0; a < bundle.part.cameras.size(); ++a)
      for (std::size_t b = 0; b < bundle.part.cameras.size(); ++b)
        if (bundle.part.cameras[a] < bundle.part.cameras[b])
          result->camera_to_camera.push_back(pair_of(observations, bundle, a, b));
  }

  static void mark_used(const std::vector<ViewPose>& views, const PatternBundle& bundle, rivals::UsedViews* used) {
    const std::set<int> cameras(bundle.part.cameras.begin(), bundle.part.cameras.end());
    for (const ViewPose& view : views)
      if (cameras.count(view.camera) > 0) used->insert({view.stop, view.camera});
    for (const auto& outlier : bundle.outliers) used->erase(outlier);
  }

  static void conclude(const Observations& observations, const std::vector<PatternPart>& parts, Result* result) {
    std::set<int> seen;
    for (const PatternPart& part : parts) seen.insert(part.cameras.begin(), part.cameras.end());
    for (std::size_t k = 0; k < observations.cameras.size(); ++k)
      if (seen.count(static_cast<int>(k)) == 0)
        result->reasons.push_back(
            with_lack_of_views(Finding("camera.no_pose"), observations.exclusions, static_cast<int>(k))
                .of(observations.cameras[k].name));
    std::vector<std::string> groups;
    for (const PatternPart& part : parts)
      groups.push_back("{" + rivals::listed(names_of(observations, part.cameras)) + "}");
    if (groups.size() > 1) result->reasons.push_back(Finding("cameras.apart", {{"groups", rivals::listed(groups)}}));
    if (observations.cameras.size() < 2) result->reasons.emplace_back("cameras.only_one");
    rivals::conclude(result->reasons.empty(), result);
  }
};

}  // namespace

std::vector<const Method*> li_methods() {
  static const LiMethod method;
  return {&method};
}

}  // namespace rigproof
