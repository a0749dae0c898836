#include "report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "also_estimated.h"
#include "rigproof/calib/diagnose/board_scale.h"
#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/calib/estimate/stated_levels.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/exclusions.h"

namespace rigproof::ml {
namespace {

std::vector<Exclusion> all_left_out(const Preparation& prepared) {
  std::vector<Exclusion> all = prepared.original.exclusions;
  all.insert(all.end(), prepared.excluded.begin(), prepared.excluded.end());
  return all;
}

class Reporter {
 public:
  Reporter(const Preparation& prepared, const Fit& fit, const Fit* other, const Examination& found,
           MlEstimate* estimate)
      : prepared_(prepared),
        fit_(fit),
        other_(other),
        found_(found),
        contradictions_(found.contradictions),
        estimate_(*estimate) {}

  void run() {
    const NoiseLevels levels = found_.sums ? stated_levels(prepared_, fit_, *found_.sums) : fit_.noise;
    const Problem problem = problem_at(prepared_, fit_, levels);
    GroupSums sums;
    const ArrowSystem system = problem.linearise(fit_.state, Weighting::kInformation, &estimate_.cost, &sums);
    const auto eliminated = EliminatedSystem::eliminate(system, 0.0);
    copy_state(problem.layout());
    if (!eliminated) {
      estimate_.result.reasons.emplace_back("poses.undetermined");
      return;
    }
    globals_ = invert_information(eliminated->schur());
    const Eigen::MatrixXd J = camera_chart(fit_.state, problem.layout());
    joint_ = cameras_covariance(J, globals_.covariance, fit_);
    free_ = J * globals_.free_directions;
    gate_joint_ = exceeds_limits() ? gate_covariance(J) : joint_;
    allow_for_other_model();
    report_cameras();
    report_pairs();
    check_lengths();
    report_contradictions();
    report_status();
    report_residuals(sums);
    report_also_estimated(prepared_, fit_, globals_.covariance, &estimate_.result);
  }

 private:
  // Where the data leave open which odometry model holds, the other one's answer and uncertainty count with its
  // probability: the law of total variance, about the answer that is given. Whether it is of use is judged by the
  // likelier model alone, as by the likeliest level.
  void allow_for_other_model() {
    if (other_ == nullptr) return;
    const std::optional<GroupSums> sums =
        problem_at(prepared_, *other_, other_->noise).sums_with_leverage(other_->state);
    const Problem problem =
        problem_at(prepared_, *other_, sums ? stated_levels(prepared_, *other_, *sums) : other_->noise);
    const auto eliminated =
        EliminatedSystem::eliminate(problem.linearise(other_->state, Weighting::kInformation, nullptr, nullptr), 0.0);
    if (!eliminated) return;
    const GlobalCovariance globals = invert_information(eliminated->schur());
    if (free_.cols() > 0 || globals.free_directions.cols() > 0) return;
    const Eigen::MatrixXd J = camera_chart(other_->state, problem.layout());
    const Eigen::MatrixXd joint = cameras_covariance(J, globals.covariance, *other_);
    Eigen::VectorXd apart(joint_.rows());
    for (std::size_t c = 0; c < fit_.state.T_robot_camera.size(); ++c)
      apart.segment<6>(6 * static_cast<Eigen::Index>(c)) =
          transform_error(other_->state.T_robot_camera[c], fit_.state.T_robot_camera[c]);
    const double share = 1.0 - estimate_.odometry.probability;
    joint_ = (1.0 - share) * joint_ + share * (joint + apart * apart.transpose());
  }

  Eigen::MatrixXd cameras_covariance(const Eigen::MatrixXd& J, const Eigen::MatrixXd& globals, const Fit& fit) const {
    Eigen::MatrixXd joint = J * globals * J.transpose();
    add_common_errors(prepared_.sigmas(), fit.noise.along_way, &joint);
    return joint;
  }

  bool exceeds_limits() const {
    const PosteriorLimits& limits = prepared_.options.limits;
    const std::array<double, 6> limit = {limits.xy_m,     limits.xy_m,     limits.z_m,
                                         limits.tilt_rad, limits.tilt_rad, limits.yaw_rad};
    for (Eigen::Index i = 0; i < joint_.rows(); ++i)
      if (!(std::sqrt(joint_(i, i)) <= limit[static_cast<std::size_t>(i % 6)])) return true;
    return false;
  }

  Eigen::MatrixXd gate_covariance(const Eigen::MatrixXd& J) const {
    if (!found_.sums) return joint_;
    const Problem problem = problem_at(prepared_, fit_, gate_levels(prepared_, fit_, *found_.sums));
    const auto eliminated =
        EliminatedSystem::eliminate(problem.linearise(fit_.state, Weighting::kInformation, nullptr, nullptr), 0.0);
    if (!eliminated) return joint_;
    return cameras_covariance(J, invert_information(eliminated->schur()).covariance, fit_);
  }

  void copy_state(const Layout& layout) {
    CalibrationState& state = estimate_.state;
    state.T_robot_camera = fit_.state.T_robot_camera;
    state.T_world_board = fit_.state.T_world_board;
    for (const RobotPose& pose : fit_.state.poses) state.T_world_robot.push_back(pose.transform());
    state.odometry_scale = fit_.state.odometry_scale();
    state.odometry_yaw_factor = fit_.state.odometry_yaw_factor();
    for (int c = 0; c < layout.cameras; ++c)
      state.depth_scale.push_back(1.0 + fit_.state.nuisances.of(Nuisance::kDepthScale, c)[0]);
    CalibrationNoise& noise = estimate_.noise;
    noise.odometry_model = fit_.noise.odometry_model;
    noise.along_way = fit_.noise.along_way;
    noise.odometry_xy_m = fit_.noise.odometry_xy_m;
    noise.odometry_yaw_rad = fit_.noise.odometry_yaw_rad;
    noise.suspension_height_m = fit_.noise.suspension_height_m;
    noise.suspension_tilt_rad = fit_.noise.suspension_tilt_rad;
    noise.priors = prepared_.sigmas();
    estimate_.corner_scale = fit_.noise.corner_scale;
    estimate_.ground_scale = fit_.noise.ground_scale;
    estimate_.board_plane_scale = fit_.noise.board_plane_scale;
    estimate_.iterations = fit_.summary.iterations;
    estimate_.converged = fit_.summary.converged;
  }

  // Degrees of a transform whose error contains a direction that the data leave free.
  static std::array<bool, 6> determined(const Eigen::MatrixXd& free) {
    constexpr double kShare = 1e-4;  // of the direction's largest part
    std::array<bool, 6> result = {true, true, true, true, true, true};
    for (Eigen::Index column = 0; column < free.cols(); ++column)
      for (int axis = 0; axis < 6; ++axis)
        if (std::abs(free(axis, column)) > kShare) result[static_cast<std::size_t>(axis)] = false;
    return result;
  }

  Eigen::MatrixXd normalised_free() const {
    Eigen::MatrixXd result = free_;
    for (Eigen::Index column = 0; column < result.cols(); ++column) {
      const double largest = result.col(column).cwiseAbs().maxCoeff();
      if (largest > 0.0) result.col(column) /= largest;
    }
    return result;
  }

  void report_cameras() {
    const Eigen::MatrixXd free = normalised_free();
    const int ground_planes = static_cast<int>(prepared_.used.ground_planes.size());
    for (const int c : prepared_.solved_cameras()) {
      EstimatedTransform transform;
      transform.parent = prepared_.original.robot_frame;
      transform.child = prepared_.original.cameras[static_cast<std::size_t>(c)].name;
      transform.T_parent_child = fit_.state.T_robot_camera[static_cast<std::size_t>(c)];
      const Matrix6d covariance = joint_.block<6, 6>(6 * c, 6 * c), gate = gate_joint_.block<6, 6>(6 * c, 6 * c);
      CameraObservability observability =
          assess_camera(prepared_.original, c, prepared_.views, prepared_.alignment, found_.motion, ground_planes);
      apply_posterior_gate(gate, transform.child, &observability, prepared_.options.limits);
      const std::array<bool, 6> free_of = determined(free.middleRows(6 * c, 6));
      for (std::size_t axis = 0; axis < 6; ++axis)
        transform.observable[axis] = observability.observable[axis] && free_of[axis];
      if (transform.observable != observability.observable && observability.findings.empty())
        add_reason(Finding("pose.open").of(transform.child));
      transform.covariance = covariance;
      for (const Finding& finding : observability.findings) add_reason(finding);
      estimate_.result.camera_to_robot.push_back(std::move(transform));
    }
    report_joint();
  }

  void report_joint() {
    const std::vector<EstimatedTransform>& cameras = estimate_.result.camera_to_robot;
    const bool complete =
        std::all_of(cameras.begin(), cameras.end(), [](const EstimatedTransform& t) { return t.fully_observable(); });
    if (!complete) return;
    const std::vector<int> solved = prepared_.solved_cameras();
    Eigen::MatrixXd joint(6 * static_cast<Eigen::Index>(solved.size()), 6 * static_cast<Eigen::Index>(solved.size()));
    for (std::size_t a = 0; a < solved.size(); ++a)
      for (std::size_t b = 0; b < solved.size(); ++b)
        joint.block<6, 6>(6 * static_cast<Eigen::Index>(a), 6 * static_cast<Eigen::Index>(b)) =
            joint_.block<6, 6>(6 * solved[a], 6 * solved[b]);
    estimate_.result.joint_covariance = std::move(joint);
  }

  void report_pairs() {
    const std::vector<int> solved = prepared_.solved_cameras();
    const Eigen::MatrixXd free = normalised_free();
    for (std::size_t a = 0; a < solved.size(); ++a) {
      for (std::size_t b = a + 1; b < solved.size(); ++b) {
        const Eigen::MatrixXd P = pair_chart(fit_.state.T_robot_camera, solved[a], solved[b]);
        EstimatedTransform transform;
        transform.parent = prepared_.original.cameras[static_cast<std::size_t>(solved[a])].name;
        transform.child = prepared_.original.cameras[static_cast<std::size_t>(solved[b])].name;
        const std::size_t j = static_cast<std::size_t>(solved[a]), k = static_cast<std::size_t>(solved[b]);
        transform.T_parent_child = fit_.state.T_robot_camera[j].inverse() * fit_.state.T_robot_camera[k];
        const Matrix6d covariance = P * joint_ * P.transpose();
        transform.covariance = covariance;
        transform.observable = determined(P * free);
        if (!transform.fully_observable() && estimate_.result.reasons.empty())
          add_reason(Finding("pair.open").of({transform.child, transform.parent}));
        gate_pair(P * gate_joint_ * P.transpose(), &transform);
        estimate_.result.camera_to_camera.push_back(std::move(transform));
      }
    }
  }

  // Between cameras no axis is special: the widest limits of gate 2 hold for all.
  void gate_pair(const Matrix6d& covariance, EstimatedTransform* pair) {
    double worst_m = 0.0, worst_rad = 0.0;
    for (int axis = 0; axis < 6; ++axis) {
      const double sigma = std::sqrt(covariance(axis, axis));
      double& worst = axis < 3 ? worst_m : worst_rad;
      worst = std::max(worst, sigma);
      const double limit = axis < 3 ? prepared_.options.limits.xy_m : prepared_.options.limits.yaw_rad;
      if (!(sigma <= limit)) pair->observable[static_cast<std::size_t>(axis)] = false;
    }
    if (worst_m > prepared_.options.limits.xy_m || worst_rad > prepared_.options.limits.yaw_rad)
      add_reason(Finding("pair.too_uncertain", {{"sigma_cm", 100.0 * worst_m},
                                                {"sigma_deg", rad_to_deg(worst_rad)},
                                                {"limit_cm", 100.0 * prepared_.options.limits.xy_m},
                                                {"limit_deg", rad_to_deg(prepared_.options.limits.yaw_rad)}})
                     .of({pair->child, pair->parent}));
  }

  void add_reason(const Finding& finding) { add_once(finding, &estimate_.result.reasons); }

  // The board's size against depth and odometry; and what had to be taken on trust.
  void check_lengths() {
    if (found_.lens_spoils()) return;  // depth on the board would be blamed for the lens
    std::optional<OdometryScale> odometry;
    const int index = Layout::of(prepared_.used, prepared_.priors).place(Nuisance::kOdometryFactors);
    const bool trusted = !found_.symptoms.odometry && found_.motion_suffices();
    if (trusted && fit_.noise.odometry_model == OdometryModel::kPerIncrement)
      odometry = {fit_.state.odometry_scale(), index < 0 ? 0.0 : std::sqrt(globals_.covariance(index, index))};
    const BoardScale scale = check_board_scale(prepared_.used, prepared_.views, odometry);
    contradictions_.cameras.insert(contradictions_.cameras.begin(), scale.contradictions.begin(),
                                   scale.contradictions.end());
    std::vector<Finding>& notes = estimate_.result.notes;
    notes.insert(notes.end(), scale.notes.begin(), scale.notes.end());
  }

  // Most likely causes first, then what speaks for them, then what the motion does not answer.
  void report_contradictions() {
    Result& result = estimate_.result;
    std::vector<Finding> causes = found_.wrong_frames, symptoms = contradictions_.cameras;
    if (found_.cause) causes.insert(causes.end(), found_.cause->findings.begin(), found_.cause->findings.end());
    symptoms.insert(symptoms.end(), contradictions_.odometry.begin(), contradictions_.odometry.end());
    if (causes.empty() && symptoms.empty()) return;
    const bool all =
        !found_.wrong_frames.empty() || !contradictions_.cameras.empty() || found_.lens_spoils() || found_.upside_down;
    state_contradictions(causes, symptoms);
    if (found_.upside_down && found_.motion_suffices()) result.reasons.clear();  // "no ground seen" is a consequence
    const bool motion_first = !found_.motion_suffices() && causes.empty();
    result.reasons.insert(motion_first ? result.reasons.end() : result.reasons.begin(), symptoms.begin(),
                          symptoms.end());
    result.reasons.insert(result.reasons.begin(), causes.begin(), causes.end());
    causes_first(&result.reasons);
    for (EstimatedTransform& transform : result.camera_to_robot) {
      for (const std::size_t axis : {0U, 1U, 5U}) transform.observable[axis] = false;
      if (all) transform.observable.fill(false);
    }
    withhold_pairs(all);
    result.joint_covariance.reset();
  }

  void state_contradictions(const std::vector<Finding>& causes, const std::vector<Finding>& symptoms) {
    estimate_.contradictions = causes;
    estimate_.contradictions.insert(estimate_.contradictions.end(), symptoms.begin(), symptoms.end());
    // Odometry in another unit bends the corners' solution, too. The board is checked without it.
    const bool board = contradictions_.cameras.size() > found_.contradictions.cameras.size();
    const bool images = !found_.contradictions.cameras.empty() && !found_.cause && contradictions_.odometry.empty();
    estimate_.only_odometry_contradicts = found_.wrong_frames.empty() && !found_.lens_spoils() && !board && !images;
  }

  // Cameras that hardly see the board together hang on the odometry, which is contradicted.
  void withhold_pairs(bool all) {
    const std::vector<int> solved = prepared_.solved_cameras(), group = prepared_.seen_together(fit_.view_left_out);
    auto transform = estimate_.result.camera_to_camera.begin();
    for (std::size_t a = 0; a < solved.size(); ++a) {
      for (std::size_t b = a + 1; b < solved.size(); ++b, ++transform) {
        const bool together = group[static_cast<std::size_t>(solved[a])] == group[static_cast<std::size_t>(solved[b])];
        if (all || !together) transform->observable.fill(false);
        if (!all && !together) add_reason(Finding("pair.disconnected").of({transform->child, transform->parent}));
      }
    }
  }

  void report_status() {
    Result& result = estimate_.result;
    bool all = true, any = false;
    const auto look = [&](const EstimatedTransform& transform) {
      for (const bool observable : transform.observable) {
        all = all && observable;
        any = any || observable;
      }
    };
    for (const EstimatedTransform& transform : result.camera_to_robot) look(transform);
    for (const EstimatedTransform& transform : result.camera_to_camera) look(transform);
    for (std::size_t c = 0; c < prepared_.original.cameras.size(); ++c) {
      if (prepared_.solved(static_cast<int>(c))) continue;
      all = false;
      add_reason(with_lack_of_views(Finding("camera.no_pose"), all_left_out(prepared_), static_cast<int>(c))
                     .of(prepared_.original.cameras[c].name));
    }
    result.status = all ? ResultStatus::kSolved : any ? ResultStatus::kPartial : ResultStatus::kRefused;
    // Along what the data leave open there is nothing to settle at; that is a reason above.
    if (!estimate_.converged && result.status == ResultStatus::kSolved) result.notes.emplace_back("solver.unsettled");
  }

  void report_residuals(const GroupSums& sums) {
    const auto add = [&](const char* name, std::initializer_list<Group> groups) {
      GroupSum total;
      for (const Group group : groups)
        for (std::size_t c = 0; c < prepared_.original.cameras.size(); ++c)
          total += sum_of(sums, group, static_cast<int>(c));
      if (total.dimensions == 0) return;
      const double rms = std::sqrt(total.square / total.dimensions);
      estimate_.result.residuals.push_back({name, "sigma", static_cast<int>(std::lround(total.dimensions)), rms});
    };
    add("corners", {Group::kCorners});
    add("ground", {Group::kGround});
    add("board planes", {Group::kBoardPlane});
    add("odometry", {Group::kOdometryXy, Group::kOdometryYaw});
  }

  const Preparation& prepared_;
  const Fit& fit_;
  const Fit* other_;
  const Examination& found_;
  Contradictions contradictions_;
  GlobalCovariance globals_;
  Eigen::MatrixXd joint_;
  Eigen::MatrixXd gate_joint_;  // by which is refused
  Eigen::MatrixXd free_;
  MlEstimate& estimate_;
};

void add_views(const Preparation& prepared, const Fit& fit, int camera, CameraUse* use) {
  const Problem problem(prepared.used, prepared.priors, fit.noise);
  double square = 0.0;
  for (std::size_t v = 0; v < prepared.used.board_views.size(); ++v) {
    const BoardView& view = prepared.used.board_views[v];
    if (view.camera != camera) continue;
    const double rms = problem.view_fit(fit.state, v).rms_px;
    if (fit.view_left_out[v]) {
      if (prepared.has_pose(v))
        use->left_out.push_back({camera, view.stop, view.file, Finding("view.residual", {{"residual_px", rms}})});
      continue;
    }
    ++use->used;
    square += rms * rms;
  }
  if (use->used > 0) use->reprojection_rms_px = std::sqrt(square / use->used);
}

}  // namespace

void report_solution(const Preparation& prepared, const Fit& fit, const Fit* other, const Examination& found,
                     MlEstimate* estimate) {
  Reporter(prepared, fit, other, found, estimate).run();
}

void report_use(const Preparation& prepared, const Fit* fit, Result* result) {
  for (std::size_t c = 0; c < prepared.original.cameras.size(); ++c) {
    CameraUse use;
    use.camera = prepared.original.cameras[c].name;
    use.left_out = exclusions_of(all_left_out(prepared), static_cast<int>(c));
    if (fit != nullptr && !fit->state.poses.empty()) add_views(prepared, *fit, static_cast<int>(c), &use);
    result->use.push_back(std::move(use));
  }
}

}  // namespace rigproof::ml
