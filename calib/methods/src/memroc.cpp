#include "rigproof/calib/methods/memroc.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <map>

#include "hand_eye_problem.h"
#include "partial_covariance.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/diagnose/observability.h"
#include "rigproof/calib/estimate/depth_bias.h"
#include "rigproof/calib/geometry/initial_guess.h"
#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/core/conventions.h"
#include "shared_views.h"

namespace rigproof {
namespace {

// A motion that the robust loss weighs less than this is reported as left out.
constexpr double kLeftOutWeight = 0.1;

class MemrocSolver {
 public:
  MemrocSolver(const Observations& observations, const ViewPoses& views, const MemrocOptions& options)
      : observations_(observations),
        pnp_(views),
        options_(options),
        camera_count_(static_cast<int>(observations.cameras.size())),
        alignment_(align_trajectories(observations, views.poses)),
        ground_(check_ground_planes(observations, alignment_)),
        guess_(initial_guess(observations, views.poses, alignment_, ground_)) {}

  Result solve() {
    result_.method = options_.joint ? "joint_memroc" : "memroc";
    select_views();
    judge_cameras();
    solve_observable();
    report_cameras();
    report_pairs();
    report_use();
    report_residuals();
    report_ground();
    conclude();
    return std::move(result_);
  }

 private:
  const RigCamera& camera(int k) const { return observations_.cameras[static_cast<std::size_t>(k)]; }

  // Index among the solved cameras, -1 if this one is not solved.
  int solved_index(int k) const {
    const auto found = std::find(problem_.cameras.begin(), problem_.cameras.end(), k);
    return found == problem_.cameras.end() ? -1 : static_cast<int>(found - problem_.cameras.begin());
  }

  void leave_out(const ViewPose& view, const Finding& why) {
    left_out_.push_back(
        {view.camera, view.stop, observations_.board_views[static_cast<std::size_t>(view.view)].file, why});
  }

  void select_views() {
    for (std::size_t i = 0; i < pnp_.poses.size(); ++i) {
      if (alignment_.view_weights[i] >= kOutlierWeight)
        views_.push_back(pnp_.poses[i]);
      else
        leave_out(pnp_.poses[i], Finding("view.off_plane"));
    }
  }

  void judge_cameras() {
    for (int k = 0; k < camera_count_; ++k) {
      const MotionVerdict motion = assess_motion(observations_, pnp_.poses, alignment_, guess_, {k});
      observability_.push_back(
          assess_camera(observations_, k, pnp_.poses, alignment_, motion, ground_.count(observations_, k)));
      if (motion.xy && motion.yaw && observability_.back().observable[0]) problem_.cameras.push_back(k);
    }
  }

  void solve_observable() {
    if (problem_.cameras.empty()) return;
    problem_.odometry = odometry_poses(observations_);
    const std::vector<double> height_biases = relative_height_biases(observations_);
    for (const int k : problem_.cameras) {
      problem_.X.push_back(*guess_.T_robot_camera[static_cast<std::size_t>(k)]);
      const std::optional<DepthStream>& depth = camera(k).depth;
      problem_.depth_scale_sigma.push_back(
          std::hypot(depth ? depth->noise.scale_sigma : 0.0, height_biases[static_cast<std::size_t>(k)]));
      const std::size_t index = problem_.X.size() - 1;
      for (const ViewPair& pair : consecutive_pairs(views_, k)) problem_.motions.push_back({index, pair.from, pair.to});
    }
    if (options_.joint) add_camera_pairs();
    add_heights();
    if (!minimise(&problem_)) {
      result_.notes.emplace_back("solver.no_convergence");
      problem_.cameras.clear();
      return;
    }
    covariance_ = covariance_of(problem_, observations_.odometry_noise);
    for (std::size_t i = 0; i < problem_.cameras.size(); ++i) {
      const int k = problem_.cameras[i];
      apply_posterior_gate(covariance_block(i, i), camera(k).name, &observability_[static_cast<std::size_t>(k)]);
    }
  }

  Matrix6d covariance_block(std::size_t i, std::size_t j) const {
    return covariance_.block<6, 6>(6 * static_cast<Eigen::Index>(i), 6 * static_cast<Eigen::Index>(j));
  }

  void add_camera_pairs() {
    for (std::size_t j = 0; j < problem_.cameras.size(); ++j) {
      std::map<int, const ViewPose*> by_stop;
      for (const ViewPose& view : views_)
        if (view.camera == problem_.cameras[j]) by_stop[view.stop] = &view;
      for (std::size_t k = j + 1; k < problem_.cameras.size(); ++k) add_camera_pair(j, k, by_stop);
    }
  }

  void add_camera_pair(std::size_t j, std::size_t k, const std::map<int, const ViewPose*>& views_of_j) {
    const ViewPose *previous_j = nullptr, *previous_k = nullptr;
    for (const ViewPose& view_k : views_) {
      if (view_k.camera != problem_.cameras[k]) continue;
      const auto found = views_of_j.find(view_k.stop);
      if (found == views_of_j.end()) continue;
      if (previous_j != nullptr) problem_.pairs.push_back({j, k, previous_j, found->second, previous_k, &view_k});
      previous_j = found->second;
      previous_k = &view_k;
    }
  }

  void add_heights() {
    for (std::size_t i = 0; i < observations_.ground_planes.size(); ++i) {
      const PlaneObservation& plane = observations_.ground_planes[i];
      const int index = solved_index(plane.camera);
      if (!ground_.accepted[i] || index < 0) continue;
      const PlaneHeight height = height_above(plane);
      problem_.heights.push_back({static_cast<std::size_t>(index), height.height_m, height.sigma_m});
    }
  }

  // Rows and columns of degrees that are not observable hold no number.
  static void clear_unobservable(const std::array<bool, 6>& observable, Matrix6d* covariance) {
    for (Eigen::Index i = 0; i < 6; ++i) {
      if (observable[static_cast<std::size_t>(i)]) continue;
      covariance->row(i).setZero();
      covariance->col(i).setZero();
    }
  }

  void report_cameras() {
    bool all = true;
    for (int k = 0; k < camera_count_; ++k) {
      const CameraObservability& what = observability_[static_cast<std::size_t>(k)];
      all = all && what.all();
      const std::optional<Rigid3> X = best_pose(k);
      if (!what.any() || !X) continue;
      EstimatedTransform transform{observations_.robot_frame, camera(k).name, *X, std::nullopt, what.observable};
      if (const int index = solved_index(k); index >= 0) {
        transform.covariance = covariance_block(static_cast<std::size_t>(index), static_cast<std::size_t>(index));
        clear_unobservable(what.observable, &*transform.covariance);
      } else {
        transform.covariance =
            partial_covariance(observations_, views_, k, *X, what.observable, alignment_, ground_, guess_);
      }
      result_.camera_to_robot.push_back(transform);
    }
    if (all && !problem_.cameras.empty()) result_.joint_covariance = covariance_;
  }

  std::optional<Rigid3> best_pose(int k) const {
    const int index = solved_index(k);
    if (index >= 0) return problem_.X[static_cast<std::size_t>(index)];
    const std::optional<Rigid3>& guess = guess_.T_robot_camera[static_cast<std::size_t>(k)];
    return guess ? levelled_by_ground(k, *guess) : pose_from_ground(k);
  }

  // Where the motion does not determine everything the planes' normals show the vertical better than it.
  Rigid3 levelled_by_ground(int k, const Rigid3& X) const {
    Eigen::Vector3d up_camera = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < observations_.ground_planes.size(); ++i)
      if (ground_.accepted[i] && observations_.ground_planes[i].camera == k)
        up_camera -= observations_.ground_planes[i].inverse_depth_plane.normalized();
    if (up_camera.norm() < 0.5) return X;
    const Eigen::Quaterniond correction =
        Eigen::Quaterniond::FromTwoVectors(X.rotation * up_camera, Eigen::Vector3d::UnitZ());
    return Rigid3(correction * X.rotation, X.translation);
  }

  // Roll, pitch and height of a camera that saw the ground but never the board.
  std::optional<Rigid3> pose_from_ground(int k) const {
    const std::optional<Eigen::Vector3d>& up = alignment_.up_camera[static_cast<std::size_t>(k)];
    if (!up) return std::nullopt;
    Rigid3 X(Eigen::Quaterniond::FromTwoVectors(*up, Eigen::Vector3d::UnitZ()), Eigen::Vector3d::Zero());
    std::vector<double> heights;
    for (std::size_t i = 0; i < observations_.ground_planes.size(); ++i)
      if (ground_.accepted[i] && observations_.ground_planes[i].camera == k)
        heights.push_back(height_above(observations_.ground_planes[i]).height_m);
    std::sort(heights.begin(), heights.end());
    if (!heights.empty()) X.translation.z() = heights[heights.size() / 2];
    return X;
  }

  void report_pairs() {
    for (int j = 0; j < camera_count_; ++j)
      for (int k = j + 1; k < camera_count_; ++k)
        if (std::optional<EstimatedTransform> pair = camera_pair(j, k)) result_.camera_to_camera.push_back(*pair);
  }

  bool fully_solved(int k) const { return solved_index(k) >= 0 && observability_[static_cast<std::size_t>(k)].all(); }

  std::optional<EstimatedTransform> camera_pair(int j, int k) {
    EstimatedTransform transform{camera(j).name, camera(k).name, Rigid3(), std::nullopt, {}};
    transform.observable.fill(true);
    if (fully_solved(j) && fully_solved(k)) {
      const std::size_t a = static_cast<std::size_t>(solved_index(j)), b = static_cast<std::size_t>(solved_index(k));
      transform.T_parent_child = problem_.X[a].inverse() * problem_.X[b];
      transform.covariance = relative_covariance(a, b);
      return transform;
    }
    if (const std::optional<SharedViewTransform> shared = transform_from_shared_views(views_, j, k)) {
      transform.T_parent_child = shared->T_j_k;
      transform.covariance = shared->covariance;
      from_shared_views_.push_back(camera(j).name + "-" + camera(k).name);
      return transform;
    }
    return std::nullopt;
  }

  // X_jk = X_j^-1 X_k: dt = R_j^T (dt_k - dt_j + (t_k - t_j) x dphi_j), dphi = R_j^T (dphi_k - dphi_j)
  Matrix6d relative_covariance(std::size_t j, std::size_t k) const {
    const Eigen::Matrix3d R = problem_.X[j].rotation_matrix().transpose();
    Matrix6d J_k = Matrix6d::Zero();
    J_k.topLeftCorner<3, 3>() = R;
    J_k.bottomRightCorner<3, 3>() = R;
    Matrix6d J_j = -J_k;
    J_j.topRightCorner<3, 3>() = R * skew(problem_.X[k].translation - problem_.X[j].translation);
    const Matrix6d cross = J_j * covariance_block(j, k) * J_k.transpose();
    return J_j * covariance_block(j, j) * J_j.transpose() + J_k * covariance_block(k, k) * J_k.transpose() + cross +
           cross.transpose();
  }

  // A view is left out if no motion that it belongs to counts.
  void find_views_without_weight() {
    std::map<int, double> best_weight;
    std::map<int, Vector6d> residual;
    for (const MotionTerm& term : problem_.motions) {
      for (const ViewPose* view : {term.from, term.to}) {
        double& best = best_weight.emplace(view->view, 0.0).first->second;
        if (term.weight >= best) residual[view->view] = term.residual;
        best = std::max(best, term.weight);
      }
    }
    for (const ViewPose& view : views_) {
      const auto found = best_weight.find(view.view);
      if (found == best_weight.end() || found->second >= kLeftOutWeight) continue;
      const Vector6d& off = residual[view.view];
      leave_out(view, Finding("view.off_neighbours", {{"off_cm", 100.0 * off.head<3>().norm()},
                                                      {"off_deg", rad_to_deg(off.tail<3>().norm())}}));
    }
  }

  static void add_exclusions(const std::vector<Exclusion>& from, int camera, std::vector<Exclusion>* to) {
    std::copy_if(from.begin(), from.end(), std::back_inserter(*to),
                 [camera](const Exclusion& exclusion) { return exclusion.camera == camera; });
  }

  void report_use() {
    find_views_without_weight();
    for (int k = 0; k < camera_count_; ++k) {
      CameraUse use;
      use.camera = camera(k).name;
      add_exclusions(observations_.exclusions, k, &use.left_out);
      add_exclusions(pnp_.exclusions, k, &use.left_out);
      add_exclusions(left_out_, k, &use.left_out);
      std::stable_sort(use.left_out.begin(), use.left_out.end(),
                       [](const Exclusion& a, const Exclusion& b) { return a.stop < b.stop; });
      double sum = 0.0;
      for (const ViewPose& view : views_) {
        if (view.camera != k || is_left_out(view)) continue;
        ++use.used;
        sum += view.reprojection_rms_px * view.reprojection_rms_px;
      }
      use.reprojection_rms_px = use.used > 0 ? std::sqrt(sum / use.used) : 0.0;
      result_.use.push_back(use);
    }
  }

  bool is_left_out(const ViewPose& view) const {
    return std::any_of(left_out_.begin(), left_out_.end(), [&](const Exclusion& exclusion) {
      return exclusion.camera == view.camera && exclusion.stop == view.stop;
    });
  }

  void add_residual(const char* name, const char* unit, const std::vector<double>& norms) {
    if (norms.empty()) return;
    double sum = 0.0;
    for (const double norm : norms) sum += norm * norm;
    result_.residuals.push_back(
        {name, unit, static_cast<int>(norms.size()), std::sqrt(sum / static_cast<double>(norms.size()))});
  }

  void report_residuals() {
    if (problem_.cameras.empty()) return;
    std::vector<double> translations, rotations, pair_translations, pair_rotations, heights;
    for (const MotionTerm& term : problem_.motions) {
      translations.push_back(term.residual.head<3>().norm());
      rotations.push_back(rad_to_deg(term.residual.tail<3>().norm()));
    }
    for (const CameraPairTerm& term : problem_.pairs) {
      pair_translations.push_back(std::hypot(term.residual.segment<3>(0).norm(), term.residual.segment<3>(6).norm()));
      pair_rotations.push_back(
          rad_to_deg(std::hypot(term.residual.segment<3>(3).norm(), term.residual.segment<3>(9).norm())));
    }
    for (const HeightTerm& term : problem_.heights) heights.push_back(term.residual_m);
    add_residual("motions, translation", "m", translations);
    add_residual("motions, rotation", "deg", rotations);
    add_residual("camera pairs, translation", "m", pair_translations);
    add_residual("camera pairs, rotation", "deg", pair_rotations);
    add_residual("ground height", "m", heights);
  }

  // One note for each camera and reason, with the stops.
  void report_ground() {
    for (const Exclusion& rejected : ground_.rejected) {
      const Finding note = Finding("plane.left_out").of(camera(rejected.camera).name).by({rejected.why});
      const auto known = std::find_if(result_.notes.begin(), result_.notes.end(),
                                      [&note](const Finding& other) { return other.at({}) == note; });
      if (known == result_.notes.end())
        result_.notes.push_back(note.at({rejected.stop}));
      else
        known->stops.push_back(rejected.stop);
    }
    if (alignment_.source == VerticalSource::kGround) result_.notes.emplace_back("vertical.from_ground");
  }

  // What cameras share is said once, with all their names.
  void gather_reasons() {
    std::vector<Finding>& reasons = result_.reasons;
    if (camera_count_ == 0) reasons.emplace_back("rig.no_camera");
    for (const CameraObservability& seen : observability_) {
      for (const Finding& finding : seen.findings) {
        const auto known = std::find_if(reasons.begin(), reasons.end(), [&finding](const Finding& other) {
          return other.of(finding.cameras) == finding;
        });
        if (known == reasons.end())
          reasons.push_back(finding);
        else
          known->cameras.insert(known->cameras.end(), finding.cameras.begin(), finding.cameras.end());
      }
    }
  }

  void conclude() {
    gather_reasons();
    std::string pairs;
    for (const std::string& pair : from_shared_views_) pairs += (pairs.empty() ? "" : ", ") + pair;
    if (!pairs.empty()) result_.notes.push_back(Finding("pairs.from_shared_views", {{"pairs", pairs}}));
    bool complete = camera_count_ > 0;
    for (const CameraObservability& what : observability_) complete = complete && what.all();
    if (complete && !problem_.cameras.empty())
      result_.status = ResultStatus::kSolved;
    else if (!result_.camera_to_robot.empty() || !result_.camera_to_camera.empty())
      result_.status = ResultStatus::kPartial;
    else
      result_.status = ResultStatus::kRefused;
  }

  const Observations& observations_;
  const ViewPoses& pnp_;
  const MemrocOptions options_;
  const int camera_count_;
  const TrajectoryAlignment alignment_;
  const GroundCheck ground_;
  const InitialGuess guess_;

  std::vector<ViewPose> views_;  // that the motions are made of
  std::vector<Exclusion> left_out_;
  std::vector<CameraObservability> observability_;
  HandEyeProblem problem_;
  Eigen::MatrixXd covariance_;
  std::vector<std::string> from_shared_views_;
  Result result_;
};

class Memroc : public Method {
 public:
  explicit Memroc(bool joint) : joint_(joint) {}

  MethodTraits traits() const override {
    if (joint_)
      return {"joint_memroc",
              "MEMROC over all cameras together, with a term for every pair that shares views",
              "board, odometry, ground plane",
              "camera to robot (6), camera to camera",
              MethodReads::kObservations,
              4e-4};
    return {"memroc",
            "Hand-eye calibration for planar motion, each camera by itself (MEMROC)",
            "board, odometry, ground plane",
            "camera to robot (6), camera to camera",
            MethodReads::kObservations,
            1.5e-4};
  }

  Result solve(const Observations& observations) const override {
    const auto start = std::chrono::steady_clock::now();
    Result result = solve_memroc(observations, estimate_view_poses(observations), {joint_});
    result.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }

 private:
  bool joint_;
};

}  // namespace

Result solve_memroc(const Observations& observations, const ViewPoses& views, const MemrocOptions& options) {
  return MemrocSolver(observations, views, options).solve();
}

std::vector<const Method*> memroc_methods() {
  static const Memroc alone(false), joint(true);
  return {&joint, &alone};
}

}  // namespace rigproof
