#include "rigproof/calib/methods/memroc.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "hand_eye_problem.h"
#include "partial_covariance.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/diagnose/observability.h"
#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/calib/estimate/depth_bias.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/median.h"
#include "rigproof/core/rotation_between.h"
#include "rigproof/core/text.h"
#include "rival_result.h"
#include "shared_views.h"

namespace rigproof {
namespace {

// A motion that the robust loss weighs less than this is reported as left out.
constexpr double kLeftOutWeight = 0.1;

/// What every step looks at.
struct Evidence {
  const Observations& observations;
  TrajectoryAlignment alignment;
  GroundCheck check;
  InitialGuess guess;
  std::vector<PlaneObservation> ground;  ///< accepted planes
  std::vector<ViewPose> views;           ///< that the motions are made of
  std::vector<Exclusion> left_out;

  int cameras() const { return static_cast<int>(observations.cameras.size()); }
  const std::string& name(int k) const { return observations.cameras[static_cast<std::size_t>(k)].name; }
  void leave_out(const ViewPose& view, const Finding& why) {
    const std::string& file = observations.board_views[static_cast<std::size_t>(view.view)].file;
    left_out.push_back({view.camera, view.stop, file, why});
  }
};

Evidence evidence_of(const Observations& observations, const ViewPoses& pnp) {
  Evidence evidence{observations, align_trajectories(observations, pnp.poses), {}, {}, {}, {}, pnp.exclusions};
  evidence.check = check_ground_planes(observations, evidence.alignment);
  evidence.guess = initial_guess(observations, pnp.poses, evidence.alignment, evidence.check);
  evidence.ground = evidence.check.planes(observations);
  for (std::size_t i = 0; i < pnp.poses.size(); ++i) {
    if (evidence.alignment.view_weights[i] >= kLeastPlanarWeight)
      evidence.views.push_back(pnp.poses[i]);
    else
      evidence.leave_out(pnp.poses[i], Finding("view.off_plane"));
  }
  return evidence;
}

struct Judgement {
  std::vector<CameraObservability> cameras;
  std::vector<int> determined;  ///< cameras whose whole pose the motion determines

  bool all() const {
    return std::all_of(cameras.begin(), cameras.end(), [](const CameraObservability& what) { return what.all(); });
  }
};

Judgement judge_cameras(const Evidence& evidence, const std::vector<ViewPose>& views) {
  Judgement judgement;
  for (int k = 0; k < evidence.cameras(); ++k) {
    const MotionVerdict motion = assess_motion(evidence.observations, views, evidence.alignment, evidence.guess, {k});
    judgement.cameras.push_back(assess_camera(evidence.observations, k, views, evidence.alignment, motion,
                                              evidence.check.count(evidence.observations, k)));
    if (motion.xy && motion.yaw && judgement.cameras.back().observable[0]) judgement.determined.push_back(k);
  }
  return judgement;
}

/// The determined cameras together; none where it did not converge.
struct Solution {
  HandEyeProblem problem;
  Eigen::MatrixXd covariance;
  bool converged = true;

  /// Index among the solved cameras, -1 if this one is not solved.
  int index_of(int k) const {
    const auto found = std::find(problem.cameras.begin(), problem.cameras.end(), k);
    return found == problem.cameras.end() ? -1 : static_cast<int>(found - problem.cameras.begin());
  }
  Matrix6d covariance_of(int index) const { return covariance.block<6, 6>(6 * index, 6 * index); }
};

void add_camera(const Evidence& evidence, int k, double height_bias, HandEyeProblem* problem) {
  const std::size_t index = problem->X.size(), camera = static_cast<std::size_t>(k);
  const std::optional<DepthStream>& depth = evidence.observations.cameras[camera].depth;
  problem->X.push_back(*evidence.guess.T_robot_camera[camera]);
  problem->depth_scale_sigma.push_back(std::hypot(depth ? depth->noise.scale_sigma : 0.0, height_bias));
  for (const ViewPair& pair : consecutive_pairs(evidence.views, k))
    problem->motions.push_back({index, pair.from, pair.to});
  for (const PlaneObservation& plane : evidence.ground) {
    if (plane.camera != k) continue;
    const PlaneHeight height = height_above(plane);
    problem->heights.push_back({index, height.height_m, height.sigma_m});
  }
}

void add_camera_pairs(const std::vector<ViewPose>& views, HandEyeProblem* problem) {
  for (std::size_t j = 0; j < problem->cameras.size(); ++j) {
    for (std::size_t k = j + 1; k < problem->cameras.size(); ++k) {
      const std::vector<SharedView> shared = shared_views(views, problem->cameras[j], problem->cameras[k]);
      for (std::size_t i = 1; i < shared.size(); ++i)
        problem->pairs.push_back({j, k, shared[i - 1].j, shared[i].j, shared[i - 1].k, shared[i].k});
    }
  }
}

Solution solve_determined(const Evidence& evidence, const std::vector<int>& cameras, bool joint) {
  Solution solution;
  if (cameras.empty()) return solution;
  HandEyeProblem& problem = solution.problem;
  problem.cameras = cameras;
  problem.odometry = odometry_poses(evidence.observations);
  const std::vector<double> height_biases = relative_height_biases(evidence.observations);
  for (const int k : cameras) add_camera(evidence, k, height_biases[static_cast<std::size_t>(k)], &problem);
  if (joint) add_camera_pairs(evidence.views, &problem);
  solution.converged = minimise(&problem);
  if (solution.converged)
    solution.covariance = covariance_of(problem, evidence.observations.odometry_noise);
  else
    problem.cameras.clear();
  return solution;
}

// Where the motion does not determine everything the planes' normals show the vertical better than it.
Rigid3 levelled_by_ground(const Evidence& evidence, int k, const Rigid3& X) {
  Eigen::Vector3d up_camera = Eigen::Vector3d::Zero();
  for (const PlaneObservation& plane : evidence.ground)
    if (plane.camera == k) up_camera -= plane.inverse_depth_plane.normalized();
  if (up_camera.norm() < 0.5) return X;
  const Eigen::Quaterniond correction = rotation_between(X.rotation * up_camera, Eigen::Vector3d::UnitZ());
  return Rigid3(correction * X.rotation, X.translation);
}

// Roll, pitch and height of a camera that saw the ground but never the board.
std::optional<Rigid3> pose_from_ground(const Evidence& evidence, int k) {
  const std::optional<Eigen::Vector3d>& up = evidence.alignment.up_camera[static_cast<std::size_t>(k)];
  if (!up) return std::nullopt;
  Rigid3 X(rotation_between(*up, Eigen::Vector3d::UnitZ()), Eigen::Vector3d::Zero());
  std::vector<double> heights;
  for (const PlaneObservation& plane : evidence.ground)
    if (plane.camera == k) heights.push_back(height_above(plane).height_m);
  if (!heights.empty()) X.translation.z() = median(std::move(heights));
  return X;
}

std::optional<Rigid3> guessed_pose(const Evidence& evidence, int k) {
  const std::optional<Rigid3>& guess = evidence.guess.T_robot_camera[static_cast<std::size_t>(k)];
  return guess ? levelled_by_ground(evidence, k, *guess) : pose_from_ground(evidence, k);
}

// Rows and columns of degrees that are not observable hold no number.
Matrix6d without_unobservable(const std::array<bool, 6>& observable, Matrix6d covariance) {
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (observable[static_cast<std::size_t>(i)]) continue;
    covariance.row(i).setZero();
    covariance.col(i).setZero();
  }
  return covariance;
}

std::vector<EstimatedTransform> cameras_in_robot(const Evidence& evidence, const Judgement& judgement,
                                                 const Solution& solution) {
  std::vector<EstimatedTransform> transforms;
  for (int k = 0; k < evidence.cameras(); ++k) {
    const CameraObservability& what = judgement.cameras[static_cast<std::size_t>(k)];
    const int index = solution.index_of(k);
    const std::optional<Rigid3> X =
        index >= 0 ? solution.problem.X[static_cast<std::size_t>(index)] : guessed_pose(evidence, k);
    if (!what.any() || !X) continue;
    const Matrix6d covariance = index >= 0 ? solution.covariance_of(index)
                                           : partial_covariance(evidence.observations, evidence.views, k, *X,
                                                                evidence.alignment, evidence.ground, evidence.guess);
    transforms.push_back({evidence.observations.robot_frame, evidence.name(k), *X,
                          without_unobservable(what.observable, covariance), what.observable});
  }
  return transforms;
}

// Pairs of cameras whose poses are whole follow from these, others from what both saw: those are told in a note.
void report_pairs(const Evidence& evidence, const Judgement& judgement, const Solution& solution, Result* result) {
  const auto whole = [&](int k) {
    return solution.index_of(k) >= 0 && judgement.cameras[static_cast<std::size_t>(k)].all();
  };
  std::vector<std::string> from_shared_views;
  for (int j = 0; j < evidence.cameras(); ++j) {
    for (int k = j + 1; k < evidence.cameras(); ++k) {
      EstimatedTransform pair{evidence.name(j), evidence.name(k), Rigid3(), std::nullopt};
      if (whole(j) && whole(k)) {
        const std::vector<Rigid3>& X = solution.problem.X;
        const int a = solution.index_of(j), b = solution.index_of(k);
        const Eigen::MatrixXd P = ml::pair_chart(X, a, b);
        pair.T_parent_child = X[static_cast<std::size_t>(a)].inverse() * X[static_cast<std::size_t>(b)];
        pair.covariance = Matrix6d(P * solution.covariance * P.transpose());
      } else if (const auto shared = transform_from_shared_views(evidence.views, j, k)) {
        pair.T_parent_child = shared->T_j_k;
        pair.covariance = shared->covariance;
        from_shared_views.push_back(evidence.name(j) + "-" + evidence.name(k));
      } else {
        continue;
      }
      result->camera_to_camera.push_back(pair);
    }
  }
  if (!from_shared_views.empty())
    result->notes.push_back(Finding("pairs.from_shared_views", {{"pairs", joined(from_shared_views)}}));
}

// A view is left out if no motion that it belongs to counts.
void leave_out_views_without_weight(const std::vector<MotionTerm>& motions, Evidence* evidence) {
  std::map<int, const MotionTerm*> best;
  for (const MotionTerm& term : motions) {
    for (const ViewPose* view : {term.from, term.to}) {
      const MotionTerm*& known = best.emplace(view->view, &term).first->second;
      if (term.weight >= known->weight) known = &term;
    }
  }
  for (const ViewPose& view : evidence->views) {
    const auto found = best.find(view.view);
    if (found == best.end() || found->second->weight >= kLeftOutWeight) continue;
    const Vector6d& off = found->second->residual;
    evidence->leave_out(view, Finding("view.off_neighbours", {{"off_cm", 100.0 * off.head<3>().norm()},
                                                              {"off_deg", rad_to_deg(off.tail<3>().norm())}}));
  }
}

// `square` gives the square of a term's residual.
template <typename Term, typename Square>
void add_residuals(const char* name, const char* unit, const std::vector<Term>& terms, const Square& square,
                   std::vector<ResidualSummary>* residuals) {
  if (terms.empty()) return;
  double sum = 0.0;
  for (const Term& term : terms) sum += square(term);
  residuals->push_back(
      {name, unit, static_cast<int>(terms.size()), std::sqrt(sum / static_cast<double>(terms.size()))});
}

std::vector<ResidualSummary> residuals_of(const HandEyeProblem& problem) {
  std::vector<ResidualSummary> residuals;
  if (problem.cameras.empty()) return residuals;
  const auto degrees2 = [](double radians2) { return std::pow(rad_to_deg(1.0), 2) * radians2; };
  const auto add = [&residuals](const char* name, const char* unit, const auto& terms, const auto& square) {
    add_residuals(name, unit, terms, square, &residuals);
  };
  add("motions, translation", "m", problem.motions,
      [](const MotionTerm& term) { return term.residual.head<3>().squaredNorm(); });
  add("motions, rotation", "deg", problem.motions,
      [&](const MotionTerm& term) { return degrees2(term.residual.tail<3>().squaredNorm()); });
  add("camera pairs, translation", "m", problem.pairs, [](const CameraPairTerm& term) {
    return term.residual.segment<3>(0).squaredNorm() + term.residual.segment<3>(6).squaredNorm();
  });
  add("camera pairs, rotation", "deg", problem.pairs, [&](const CameraPairTerm& term) {
    return degrees2(term.residual.segment<3>(3).squaredNorm() + term.residual.segment<3>(9).squaredNorm());
  });
  add("ground height", "m", problem.heights, [](const HeightTerm& term) { return term.residual.squaredNorm(); });
  return residuals;
}

// One note for each camera and reason, with the stops.
void report_ground(const Evidence& evidence, std::vector<Finding>* notes) {
  for (const Exclusion& rejected : evidence.check.rejected) {
    const Finding note = Finding("plane.left_out").of(evidence.name(rejected.camera)).by({rejected.why});
    const auto known =
        std::find_if(notes->begin(), notes->end(), [&note](const Finding& other) { return other.at({}) == note; });
    if (known == notes->end())
      notes->push_back(note.at({rejected.stop}));
    else
      known->stops.push_back(rejected.stop);
  }
  if (evidence.alignment.source == VerticalSource::kGround) notes->emplace_back("vertical.from_ground");
}

// What cameras share is said once, with all their names.
std::vector<Finding> reasons_of(const std::vector<CameraObservability>& cameras) {
  std::vector<Finding> reasons;
  if (cameras.empty()) reasons.emplace_back("rig.no_camera");
  for (const CameraObservability& seen : cameras) {
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
  return reasons;
}

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
    return solve_memroc(observations, estimate_view_poses(observations), {joint_});
  }

 private:
  bool joint_;
};

}  // namespace

Result solve_memroc(const Observations& observations, const ViewPoses& views, const MemrocOptions& options) {
  Evidence evidence = evidence_of(observations, views);
  Judgement judgement = judge_cameras(evidence, views.poses);
  const Solution solution = solve_determined(evidence, judgement.determined, options.joint);
  for (const int k : solution.problem.cameras)
    apply_posterior_gate(solution.covariance_of(solution.index_of(k)), evidence.name(k),
                         &judgement.cameras[static_cast<std::size_t>(k)]);
  Result result;
  result.method = options.joint ? "joint_memroc" : "memroc";
  if (!solution.converged) result.notes.emplace_back("solver.no_convergence");
  result.camera_to_robot = cameras_in_robot(evidence, judgement, solution);
  const bool complete = judgement.all() && !solution.problem.cameras.empty();
  if (complete) result.joint_covariance = solution.covariance;
  leave_out_views_without_weight(solution.problem.motions, &evidence);
  rivals::report_use(observations, views.poses, evidence.left_out, &result);
  result.residuals = residuals_of(solution.problem);
  report_ground(evidence, &result.notes);
  report_pairs(evidence, judgement, solution, &result);
  result.reasons = reasons_of(judgement.cameras);
  rivals::conclude(complete, &result);
  return result;
}

std::vector<const Method*> memroc_methods() {
  static const Memroc alone(false), joint(true);
  return {&joint, &alone};
}

}  // namespace rigproof
