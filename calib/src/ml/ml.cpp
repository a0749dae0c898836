#include "rigproof/calib/ml.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "ml/board_scale.h"
#include "ml/contradictions.h"
#include "ml/covariance.h"
#include "ml/diagnosis.h"
#include "ml/odometry_rows.h"
#include "ml/robust_views.h"
#include "ml/shared_ground_error.h"
#include "ml/solver.h"
#include "ml/swapped_frames.h"
#include "rigproof/calib/initial_guess.h"
#include "rigproof/calib/trajectory_alignment.h"
#include "rigproof/calib/view_poses.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

using ml::Group;

template <typename... Args>
std::string format(const char* pattern, Args... args) {
  char text[512];
  std::snprintf(text, sizeof(text), pattern, args...);
  return text;
}

// Probability of an odometry model above which the other one's answer is of no account.
constexpr double kSureOfModel = 0.999;

// Where no gate says more.
constexpr const char* kOpenDirection =
    "not all of its pose is determined: what the data tell along some direction is lost in rounding; add stops";

// One odometry model's solution.
struct Fit {
  ml::NoiseLevels noise;
  ml::State state;
  std::vector<bool> view_left_out;
  ml::SolverSummary summary;
  double minus_two_log_likelihood = 0.0;
};

ml::NoiseLevels starting_levels(const Observations& observations, OdometryModel model, const MlOptions& options) {
  ml::NoiseLevels levels;
  levels.odometry_model = model;
  const OdometryNoise& given = observations.odometry_noise;
  levels.odometry_xy_m = std::max(given.sigma_xy_m.value_or(levels.odometry_xy_m), ml::kMinOdometryXy_m);
  levels.odometry_yaw_rad = std::max(given.sigma_yaw_rad.value_or(levels.odometry_yaw_rad), ml::kMinOdometryYaw_rad);
  levels.suspension_height_m =
      std::max(options.suspension_height_sigma_m.value_or(levels.suspension_height_m), ml::kMinSuspensionHeight_m);
  levels.suspension_tilt_rad =
      std::max(options.suspension_tilt_sigma_rad.value_or(levels.suspension_tilt_rad), ml::kMinSuspensionTilt_rad);
  levels.corner_scale.assign(observations.cameras.size(), 1.0);
  levels.ground_scale.assign(observations.cameras.size(), 1.0);
  levels.board_plane_scale.assign(observations.cameras.size(), 1.0);
  return levels;
}

ml::EstimatedLevels estimated_levels(const Observations& observations, const MlOptions& options) {
  ml::EstimatedLevels levels;
  levels.odometry_xy = !observations.odometry_noise.sigma_xy_m;
  levels.odometry_yaw = !observations.odometry_noise.sigma_yaw_rad;
  levels.suspension_height = !options.suspension_height_sigma_m;
  levels.suspension_tilt = !options.suspension_tilt_sigma_rad;
  levels.corners = options.estimate_corner_level;
  levels.planes = options.estimate_plane_level;
  return levels;
}

ml::Priors priors_of(const Observations& observations, const MlOptions& options) {
  ml::Priors priors;
  priors.odometry_scale = options.odometry_scale_sigma;
  priors.odometry_yaw_factor = options.odometry_yaw_factor_sigma;
  for (const RigCamera& camera : observations.cameras)
    priors.depth_bias.push_back(camera.depth ? camera.depth->noise.scale_sigma : 0.0);
  priors.focal_relative = options.focal_relative_sigma;
  priors.principal_point_px = options.principal_point_sigma_px;
  return priors;
}

ml::State starting_state(const Observations& observations, const CalibrationState& start) {
  ml::State state;
  state.T_robot_camera = start.T_robot_camera;
  state.T_world_board = start.T_world_board;
  for (const Rigid3& T : start.T_world_robot) state.poses.push_back(ml::RobotPose::from_transform(T));
  state.odometry_scale = start.odometry_scale;
  state.odometry_yaw_factor = start.odometry_yaw_factor;
  state.depth_bias.assign(observations.cameras.size(), 0.0);
  for (std::size_t c = 0; c < start.depth_scale.size(); ++c) state.depth_bias[c] = start.depth_scale[c] - 1.0;
  state.intrinsics.assign(observations.cameras.size(), Eigen::Vector3d::Zero());
  state.ground_offset.assign(observations.cameras.size(), Eigen::Vector3d::Zero());
  return state;
}

// Odometry's own world: absolute poses are compared with it, so the state moves there.
void move_to_odometry_frame(const Observations& observations, ml::State* state) {
  if (observations.stops.empty()) return;
  // The planar rigid motion that best maps the estimated positions and headings to the odometry's.
  Eigen::Vector2d mean_from = Eigen::Vector2d::Zero(), mean_to = Eigen::Vector2d::Zero();
  const double n = static_cast<double>(observations.stops.size());
  double sine = 0.0, cosine = 0.0;
  for (std::size_t i = 0; i < observations.stops.size(); ++i) {
    mean_from += Eigen::Vector2d(state->poses[i].x_m, state->poses[i].y_m) / n;
    mean_to += Eigen::Vector2d(observations.stops[i].x_m, observations.stops[i].y_m) / n;
    const double turn = observations.stops[i].yaw_rad - state->poses[i].yaw_rad;
    sine += std::sin(turn);
    cosine += std::cos(turn);
  }
  const double yaw = std::atan2(sine, cosine);
  const Eigen::Vector2d shift = mean_to - Eigen::Rotation2Dd(yaw) * mean_from;
  const Rigid3 T_odom_world = planar_pose(shift.x(), shift.y(), yaw);
  for (ml::RobotPose& pose : state->poses) pose = ml::RobotPose::from_transform(T_odom_world * pose.transform());
  state->T_world_board = T_odom_world * state->T_world_board;
}

// Median of what the residuals of the groups are, in sigmas: how wide the loss must be to see them at the start.
double start_width(const ml::Problem& problem, const ml::State& state) {
  ml::GroupSums sums;
  problem.linearise(state, ml::Weighting::kRobust, nullptr, &sums);
  double widest = 1.0;
  for (const std::vector<ml::GroupSum>& group : sums)
    for (const ml::GroupSum& sum : group)
      if (sum.dimensions > 0) widest = std::max(widest, std::sqrt(sum.square / sum.dimensions));
  return std::min(widest, 1e4);
}

// The loss is narrowed step by step: a start that is off by many sigmas still pulls with all its residuals.
void anneal(ml::Problem* problem, ml::State* state) {
  const double c2 = problem->loss.c2;
  ml::SolverOptions rough;
  rough.max_iterations = 6;
  rough.tolerance = 1e-2;
  for (double width = start_width(*problem, *state); width > 1.5; width = std::sqrt(width)) {
    problem->loss.c2 = c2 * width * width;
    ml::minimise(*problem, rough, state);
  }
  problem->loss.c2 = c2;
}

// The worst view of every stop, if it is wrong: what it had bent of the stop's other views may then straighten.
bool leave_out_wrong_views(ml::Problem* problem, const ml::State& state) {
  constexpr double kWrongView = 0.05;  // mean weight: nearly every corner is tens of sigmas off
  const std::vector<BoardView>& views = problem->observations().board_views;
  std::vector<double> worst(problem->observations().stops.size(), kWrongView);
  std::vector<std::optional<std::size_t>> wrong(worst.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (problem->view_left_out[v]) continue;
    const std::size_t stop = static_cast<std::size_t>(views[v].stop);
    const double weight = problem->view_fit(state, v).mean_weight;
    if (weight >= worst[stop]) continue;
    worst[stop] = weight;
    wrong[stop] = v;
  }
  bool changed = false;
  for (const std::optional<std::size_t>& view : wrong)
    if (view) problem->view_left_out[*view] = changed = true;
  return changed;
}

class Estimator {
 public:
  Estimator(const Observations& observations, const MlOptions& options)
      : original_(observations), options_(options), used_(observations) {}

  MlEstimate run() {
    const auto begin = std::chrono::steady_clock::now();
    estimate_.result.method = "ml";
    if (start(nullptr)) {
      decide_odometry();
      examine();
      report();
    }
    add_use();
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    estimate_.result.solve_s = elapsed.count();
    return std::move(estimate_);
  }

 private:
  // Poses of the views, the vertical, the ground and the closed-form guess. False: there is nothing to solve.
  // @param views what the same views gave before; null: they are looked at
  bool start(const std::vector<ViewPose>* views) {
    if (views != nullptr) {
      views_ = *views;
    } else {
      ViewPoses poses = estimate_view_poses(original_);
      views_ = std::move(poses.poses);
      excluded_ = std::move(poses.exclusions);
      ml::refine_robustly(original_, &views_);
    }
    alignment_ = align_trajectories(original_, views_);
    const GroundCheck ground = check_ground_planes(original_, alignment_);
    rejected_planes_ = ground.rejected.size();
    guess_ = initial_guess(original_, views_, alignment_, ground);
    excluded_.insert(excluded_.end(), ground.rejected.begin(), ground.rejected.end());
    if (!guess_.T_world_board) {
      estimate_.result.reasons.push_back("No camera ever saw the board: nothing can be calibrated.");
      return false;
    }
    estimate_.motion = assess_motion(original_, views_, alignment_, guess_, solved_cameras());
    keep_usable(ground);
    start_ = options_.start ? starting_state(original_, *options_.start) : starting_state(original_, guessed());
    return true;
  }

  std::vector<int> solved_cameras() const {
    std::vector<int> cameras;
    for (std::size_t c = 0; c < guess_.T_robot_camera.size(); ++c)
      if (guess_.T_robot_camera[c]) cameras.push_back(static_cast<int>(c));
    return cameras;
  }

  bool solved(int camera) const { return guess_.T_robot_camera[static_cast<std::size_t>(camera)].has_value(); }

  void keep_usable(const GroundCheck& ground) {
    used_.ground_planes.clear();
    used_.board_planes.clear();
    for (std::size_t i = 0; i < original_.ground_planes.size(); ++i)
      if (ground.accepted[i] && solved(original_.ground_planes[i].camera))
        used_.ground_planes.push_back(original_.ground_planes[i]);
    for (const PlaneObservation& plane : original_.board_planes)
      if (solved(plane.camera)) used_.board_planes.push_back(plane);
    if (options_.estimate_plane_level) ground_offset_ = ml::shared_ground_errors(used_);
  }

  CalibrationState guessed() const {
    CalibrationState state;
    for (const std::optional<Rigid3>& T : guess_.T_robot_camera) state.T_robot_camera.push_back(T.value_or(Rigid3()));
    state.T_world_board = *guess_.T_world_board;
    state.T_world_robot = guess_.T_world_robot;
    return state;
  }

  ml::Priors priors() const {
    ml::Priors priors = priors_of(used_, options_);
    priors.ground_offset = ground_offset_;
    return priors;
  }

  // @param other the other model's solution, if there is one: it differs by the odometry only.
  Fit fit(OdometryModel model, const Fit* other = nullptr) const {
    Fit fit;
    ml::Problem problem(used_, priors(), starting_levels(used_, model, options_));
    if (other != nullptr) {
      const ml::NoiseLevels own = problem.noise;
      problem.noise = other->noise;
      problem.noise.odometry_model = own.odometry_model;
      problem.noise.odometry_xy_m = own.odometry_xy_m;
      problem.noise.odometry_yaw_rad = own.odometry_yaw_rad;
    }
    fit.state = other != nullptr ? other->state : start_;
    for (int c = 0; c < problem.layout().cameras; ++c) problem.camera_fixed[static_cast<std::size_t>(c)] = !solved(c);
    for (const Exclusion& excluded : excluded_)
      for (std::size_t v = 0; v < used_.board_views.size(); ++v)
        if (used_.board_views[v].stop == excluded.stop && used_.board_views[v].camera == excluded.camera &&
            excluded.reason.find("ground") == std::string::npos && !has_pose(v))
          problem.view_left_out[v] = true;
    if (model == OdometryModel::kPerPose) move_to_odometry_frame(used_, &fit.state);
    anneal(&problem, &fit.state);
    const ml::EstimatedLevels levels = estimated_levels(used_, options_);
    ml::SolverOptions solver;
    solver.tolerance = options_.tolerance;
    fit.summary = ml::minimise_with_levels(levels, solver, &problem, &fit.state);
    if (reseat_poses(problem, &fit.state)) fit.summary = ml::minimise_with_levels(levels, solver, &problem, &fit.state);
    for (int round = 0; round < max_rounds_ && leave_out_wrong_views(&problem, fit.state); ++round)
      fit.summary = ml::minimise_with_levels(levels, solver, &problem, &fit.state);
    fit.minus_two_log_likelihood = ml::minus_two_log_likelihood(problem, fit.state);
    fit.noise = problem.noise;
    fit.view_left_out = problem.view_left_out;
    return fit;
  }

  // A stop that started from a wrong view may sit where its right views cannot pull it back: every view proposes a
  // pose, and the one that most views agree with is taken.
  bool reseat_poses(const ml::Problem& problem, ml::State* state) const {
    constexpr double kBetter = 0.25;  // of a view's weight: noise moves less
    bool changed = false;
    std::vector<std::vector<const ViewPose*>> views_at(used_.stops.size());
    for (const ViewPose& view : views_) views_at[static_cast<std::size_t>(view.stop)].push_back(&view);
    for (std::size_t i = 0; i < views_at.size(); ++i) {
      const auto agreement = [&] {
        double sum = 0.0;
        for (const ViewPose* view : views_at[i])
          sum += problem.view_fit(*state, static_cast<std::size_t>(view->view)).mean_weight;
        return sum;
      };
      double best = agreement() + kBetter;
      if (best > static_cast<double>(views_at[i].size()) - 0.5) continue;
      ml::RobotPose kept = state->poses[i];
      for (const ViewPose* view : views_at[i]) {
        const Rigid3& X = state->T_robot_camera[static_cast<std::size_t>(view->camera)];
        state->poses[i] =
            ml::RobotPose::from_transform(state->T_world_board * view->T_camera_board.inverse() * X.inverse());
        const double weight = agreement();
        if (weight <= best) continue;
        best = weight;
        kept = state->poses[i];
        changed = true;
      }
      state->poses[i] = kept;
    }
    return changed;
  }

  bool has_pose(std::size_t view) const {
    return std::any_of(views_.begin(), views_.end(),
                       [view](const ViewPose& pose) { return pose.view == static_cast<int>(view); });
  }

  void decide_odometry() {
    const OdometryModel declared = original_.odometry_noise.model;
    OdometryDecision& decision = estimate_.odometry;
    if (declared != OdometryModel::kUnknown) {
      decision.model = declared;
      fit_ = fit(declared);
      return;
    }
    fit_ = fit(OdometryModel::kPerIncrement);
    Fit other = fit(OdometryModel::kPerPose, &fit_);
    decision.decided_from_data = true;
    double difference = other.minus_two_log_likelihood - fit_.minus_two_log_likelihood;
    if (!std::isfinite(difference)) difference = 0.0;  // a drive that leaves the equations open decides nothing
    if (difference < 0.0) std::swap(fit_, other);
    decision.model = fit_.noise.odometry_model;
    decision.log_likelihood_ratio = 0.5 * std::abs(difference);
    decision.probability = 1.0 / (1.0 + std::exp(-decision.log_likelihood_ratio));
    note_decision(other);
    if (decision.probability < kSureOfModel) other_ = std::move(other);
  }

  static bool at_floor(const ml::NoiseLevels& noise) {
    return noise.odometry_xy_m < 2.0 * ml::kMinOdometryXy_m && noise.odometry_yaw_rad < 2.0 * ml::kMinOdometryYaw_rad;
  }

  void note_decision(const Fit& other) {
    const OdometryDecision& decision = estimate_.odometry;
    const char* name = odometry_model_name(decision.model);
    std::vector<std::string>& notes = estimate_.result.notes;
    if (at_floor(fit_.noise) && at_floor(other.noise))
      notes.push_back("Odometry noise per pose and per increment are indistinguishable: both are at the resolution.");
    else if (decision.probability < 0.95)
      notes.push_back(format("Odometry noise taken as %s; the data prefer it only weakly (probability %.2f).", name,
                             decision.probability));
    else
      notes.push_back(format("Odometry noise is %s (log likelihood ratio %.1f): %.2f mm, %.3f deg.", name,
                             decision.log_likelihood_ratio, 1e3 * fit_.noise.odometry_xy_m,
                             rad_to_deg(fit_.noise.odometry_yaw_rad)));
  }

  // The level of a group by which uncertainty is stated. An estimated level is itself uncertain: with few redundant
  // dimensions its square, as Student's t says, must be taken nu / (nu - 2) times larger. With next to none, the
  // odometry is far better than the cameras, or there is nearly nothing of it: then the level at which the data would
  // have told it from less, and at most the paper's nominal one.
  void allow_for_estimation(Group group, const ml::GroupSums& sums, double ml::NoiseLevels::*level, double nominal,
                            ml::NoiseLevels* levels) const {
    constexpr double kNextToNone = 4.0, kSure = 8.0;
    double& sigma = levels->*level;
    const double redundancy = ml::sum_of(sums, group).redundancy();
    if (redundancy > kNextToNone) {
      sigma *= std::sqrt(redundancy / (redundancy - 2.0));
      return;
    }
    const auto redundancy_at = [&](double trial) {
      ml::NoiseLevels tried = fit_.noise;
      tried.*level = trial;
      const std::optional<ml::GroupSums> at = final_problem(tried).sums_with_leverage(fit_.state);
      return at ? ml::sum_of(*at, group).redundancy() : 0.0;
    };
    double low = sigma, high = std::max(sigma, nominal);
    if (redundancy_at(high) < kSure) {
      sigma = high * std::sqrt(kNextToNone / (kNextToNone - 2.0));
      return;
    }
    for (int halving = 0; halving < 6; ++halving) {
      const double middle = std::sqrt(low * high);
      (redundancy_at(middle) < kSure ? low : high) = middle;
    }
    sigma = high;
  }

  // What in the solution contradicts itself, and the likely cause of it.
  void examine() {
    const ml::Problem problem = final_problem(fit_.noise);
    final_sums_ = problem.sums_with_leverage(fit_.state);
    if (final_sums_) contradictions_ = ml::find_contradictions(problem, fit_.state, *final_sums_);
    check_upside_down();
    look_at_odometry();
    look_at_frames();
    lenses_ = lens_test();
    symptoms_.odometry = symptoms_.odometry || !contradictions_.odometry.empty();
    symptoms_.bad_corners = contradictions_.bad_corners;
    symptoms_.bad_corners.resize(original_.cameras.size(), false);
    // Odometry in millimetres can bend the corners and agree with the bent ones.
    for (const bool bad : symptoms_.bad_corners) symptoms_.odometry = symptoms_.odometry || bad;
    note_lens_trust();
    symptoms_.lenses = !contradictions_.cameras.empty() || (lenses_ && lenses_->suspicious());
    if (!motion_suffices()) symptoms_.lenses = symptoms_.frames = false;
    if (!symptoms_.any() || original_.stops.size() < 3 || !wrong_frames_.empty() || board_explains()) return;
    cause_ = ml::find_cause(original_, symptoms_, [this](const Observations& repaired, bool same_views) {
      return refit(repaired, same_views);
    });
  }

  // A board of another size bends the corners' solution where depth is believed, and looks like a wrong lens then.
  bool board_explains() {
    const ml::BoardScale scale = ml::check_board_scale(used_, views_, std::nullopt);
    if (scale.depth_unit) return true;
    if (scale.contradictions.empty() || !scale.log_depth_ratio) return false;
    symptoms_.lenses = true;
    Observations repaired = original_;
    repaired.board.square_m *= std::exp(*scale.log_depth_ratio);
    const std::optional<ml::Trial> trial = refit(repaired, false);
    return trial && trial->clean;
  }

  void look_at_odometry() {
    const ml::StampShift shift = ml::estimate_stamp_shift(used_, fit_.noise, fit_.state);
    symptoms_.stops_ahead = shift.stops;
    symptoms_.odometry = shift.contradicts();
    symptoms_.odometry_scale = fit_.state.odometry_scale;
    wild_rows_ = ml::find_wild_rows(used_, fit_.noise, fit_.state);
    constexpr std::size_t kMany = 5;  // more than one in five are no exception
    if (kMany * wild_rows_.size() > std::max(kMany, used_.stops.size())) return;
    for (const ml::WildRow& row : wild_rows_) estimate_.result.notes.push_back(ml::sentence_of(row, used_));
  }

  // Where the motion leaves the mounting open, a solution is one of many: its residuals blame no lens and no frame.
  bool motion_suffices() const { return estimate_.motion.kind == MotionKind::kSufficient; }

  // Views of a solution that nothing else agrees with, per camera.
  std::vector<int> views_left_out() const {
    std::vector<int> count(used_.cameras.size(), 0);
    for (std::size_t v = 0; v < used_.board_views.size(); ++v)
      if (fit_.view_left_out[v] && has_pose(v)) ++count[static_cast<std::size_t>(used_.board_views[v].camera)];
    return count;
  }

  std::vector<ml::SwappedFrames> swapped_frames() const {
    std::vector<bool> doubtful(used_.stops.size(), false);
    for (std::size_t v = 0; v < used_.board_views.size(); ++v)
      if (fit_.view_left_out[v] && has_pose(v)) doubtful[static_cast<std::size_t>(used_.board_views[v].stop)] = true;
    for (const ml::WildRow& row : ml::find_wild_rows(used_, fit_.noise, fit_.state)) {
      doubtful[static_cast<std::size_t>(row.stop)] = true;
      if (row.slip) doubtful[static_cast<std::size_t>(row.stop) - 1] = true;
    }
    return ml::likelier_swapped(final_problem(fit_.noise), fit_.state,
                                ml::find_swapped_frames(used_, views_, fit_.state, doubtful));
  }

  // Swapped frames spoil a recording; single wrong ones are left out.
  void look_at_frames() {
    const std::vector<int> left_out = views_left_out();
    std::vector<int> views(used_.cameras.size(), 0);
    for (const BoardView& view : used_.board_views) ++views[static_cast<std::size_t>(view.camera)];
    const bool suspicious = !contradictions_.odometry.empty() || !contradictions_.cameras.empty() ||
                            std::any_of(left_out.begin(), left_out.end(), [](int count) { return count > 0; }) ||
                            !wild_rows_.empty();
    if (suspicious && used_.cameras.size() > 1 && motion_suffices()) {
      // At the stated levels wrong frames are outliers; estimated levels may have swallowed them.
      MlOptions strict = options_;
      strict.start.reset();
      strict.estimate_corner_level = strict.estimate_plane_level = false;
      Estimator other(original_, strict);
      other.start(&views_);
      other.fit_ = other.fit(fit_.noise.odometry_model);
      for (const ml::SwappedFrames& swapped : other.swapped_frames())
        wrong_frames_.push_back("Most likely cause: " + ml::description_of(swapped, used_) + ".");
    }
    symptoms_.frames = !contradictions_.cameras.empty() || !contradictions_.odometry.empty();
    constexpr int kMany = 5;  // more than one in five
    for (std::size_t c = 0; c < views.size(); ++c) {
      if (left_out[c] <= 1 || kMany * left_out[c] <= views[c]) continue;
      symptoms_.frames = true;
      contradictions_.cameras.push_back(
          format("%s: %d of %d frames contradict all others; frames of another camera or of other stops.",
                 used_.cameras[c].name.c_str(), left_out[c], views[c]));
    }
    if (symptoms_.frames) return;
    for (std::size_t v = 0; v < used_.board_views.size(); ++v)
      if (fit_.view_left_out[v] && has_pose(v)) note_wrong_frame(used_.board_views[v]);
  }

  void note_wrong_frame(const BoardView& view) {
    estimate_.result.notes.push_back(format("%s: the frame at stop %d contradicts all others: it is left out.",
                                            used_.cameras[static_cast<std::size_t>(view.camera)].name.c_str(),
                                            view.stop));
  }

  // Half a pixel turns a camera like a wrong mounting does: only views at the images' edges tell them apart.
  void note_lens_trust() {
    constexpr double kSlip_px = 0.5, kDetects = 5.0;
    if (!lenses_ || lenses_->suspicious()) return;
    const double sigma_px = lenses_->common_shift.sigma.tail<2>().maxCoeff();
    if (kDetects * sigma_px < kSlip_px || !(sigma_px < 1e3)) return;
    estimate_.result.notes.push_back(format(
        "Taken on trust: the principal points (these data know them to +-%.2f px: a slip of half a pixel need not "
        "show).",
        sigma_px));
  }

  std::optional<ml::LensTest> lens_test() const {
    ml::Priors doubted = priors();
    doubted.focal_relative = std::max(doubted.focal_relative, ml::kDoubtedFocal);
    doubted.principal_point_px = std::max(doubted.principal_point_px, ml::kDoubtedPrincipalPoint_px);
    if (options_.focal_relative_sigma > 0.0 || options_.principal_point_sigma_px > 0.0) return std::nullopt;
    return ml::test_lenses(final_problem(fit_.noise, doubted), fit_.state);
  }

  std::optional<ml::Trial> refit(const Observations& repaired, bool same_views) const {
    MlOptions options = options_;
    options.start.reset();
    std::vector<ViewPose> views;
    for (const ViewPose& view : views_)
      if (view.stop < static_cast<int>(repaired.stops.size())) views.push_back(view);
    options.tolerance = std::max(options.tolerance, 1e-4);
    Estimator other(repaired, options);
    other.max_rounds_ = 1;
    if (!other.start(same_views ? &views : nullptr)) return std::nullopt;
    const OdometryModel declared = repaired.odometry_noise.model;
    other.fit_ = other.fit(declared == OdometryModel::kUnknown ? OdometryModel::kPerIncrement : declared);
    ml::Trial trial;
    trial.unexplained = other.unexplained();
    trial.odometry_xy_m = other.fit_.noise.odometry_xy_m;
    trial.odometry_yaw_rad = other.fit_.noise.odometry_yaw_rad;
    if (symptoms_.lenses) trial.lenses = other.lens_test();
    trial.clean = other.clean(trial.lenses);
    return trial;
  }

  // Whether nothing in the solution of a trial contradicts itself.
  bool clean(const std::optional<ml::LensTest>& lenses) {
    const ml::Problem problem = final_problem(fit_.noise);
    const std::optional<ml::GroupSums> sums = problem.sums_with_leverage(fit_.state);
    if (!sums || (lenses && lenses->suspicious())) return false;
    contradictions_ = ml::find_contradictions(problem, fit_.state, *sums);
    check_upside_down();
    if (!contradictions_.odometry.empty() || !contradictions_.cameras.empty()) return false;
    for (const int count : views_left_out())
      if (count > 1) return false;
    return true;
  }

  // -2 ln of the likelihood, where what was left out counts as very wrong: else leaving out would explain everything.
  double unexplained() const {
    constexpr double kVeryWrong = 1e4;     // whitened square
    constexpr double kUnexplained = 1e15;  // -2 ln
    const ml::Problem problem = final_problem(fit_.noise);
    const double sum = ml::minus_two_log_likelihood(problem, fit_.state);
    double left_out = static_cast<double>(rejected_planes_);
    for (std::size_t v = 0; v < used_.board_views.size(); ++v)
      if (fit_.view_left_out[v]) left_out += static_cast<double>(used_.board_views[v].corners.size());
    // Odometry of which nothing is left but its scale explains nothing.
    const auto implausible = [](double value, double sigma) { return std::abs(value - 1.0) > 3.0 * sigma; };
    if (implausible(fit_.state.odometry_scale, options_.odometry_scale_sigma) ||
        implausible(fit_.state.odometry_yaw_factor, options_.odometry_yaw_factor_sigma) || !std::isfinite(sum))
      return kUnexplained;
    return sum + left_out * problem.loss.cost(kVeryWrong);
  }

  // The noise levels by which the uncertainty is stated.
  ml::NoiseLevels stated_levels() const {
    ml::NoiseLevels levels = fit_.noise;
    const std::optional<ml::GroupSums>& sums = final_sums_;
    if (!sums) return levels;
    const ml::NoiseLevels nominal;
    if (!original_.odometry_noise.sigma_xy_m)
      allow_for_estimation(Group::kOdometryXy, *sums, &ml::NoiseLevels::odometry_xy_m, nominal.odometry_xy_m, &levels);
    if (!original_.odometry_noise.sigma_yaw_rad)
      allow_for_estimation(Group::kOdometryYaw, *sums, &ml::NoiseLevels::odometry_yaw_rad, nominal.odometry_yaw_rad,
                           &levels);
    return levels;
  }

  ml::Problem final_problem(const ml::NoiseLevels& levels) const { return final_problem(levels, priors()); }

  ml::Problem final_problem(const ml::NoiseLevels& levels, const ml::Priors& priors) const {
    ml::Problem problem(used_, priors, levels);
    if (!fit_.view_left_out.empty()) problem.view_left_out = fit_.view_left_out;
    for (int c = 0; c < problem.layout().cameras; ++c) problem.camera_fixed[static_cast<std::size_t>(c)] = !solved(c);
    return problem;
  }

  void report() {
    const ml::Problem problem = final_problem(stated_levels());
    ml::GroupSums sums;
    const ml::ArrowSystem system = problem.linearise(fit_.state, ml::Weighting::kInformation, &estimate_.cost, &sums);
    const auto eliminated = ml::EliminatedSystem::eliminate(system, 0.0);
    copy_state(problem.layout());
    if (!eliminated) {
      estimate_.result.reasons.push_back("The equations have no solution: the robot poses are not determined.");
      return;
    }
    find_covariance(*eliminated);
    allow_for_other_model();
    report_cameras();
    report_pairs();
    check_lengths();
    report_contradictions();
    report_status();
    report_residuals(sums);
  }

  void find_covariance(const ml::EliminatedSystem& eliminated) {
    globals_ = ml::invert_information(eliminated.schur());
    const Eigen::MatrixXd J = ml::camera_chart(fit_.state, ml::Layout::of(used_, priors()));
    joint_ = J * globals_.covariance * J.transpose();
    free_ = J * globals_.free_directions;
    gate_joint_ = exceeds_limits() ? gate_covariance(J) : joint_;
  }

  // Where the data leave open which odometry model holds, the other one's answer and uncertainty count with its
  // probability: the law of total variance, about the answer that is given. Whether it is of use is judged by the
  // likelier model alone, as by the likeliest level.
  void allow_for_other_model() {
    if (!other_) return;
    Estimator alternative(*this);
    alternative.fit_ = *other_;
    alternative.final_sums_ = alternative.final_problem(other_->noise).sums_with_leverage(other_->state);
    const ml::Problem problem = alternative.final_problem(alternative.stated_levels());
    const auto eliminated = ml::EliminatedSystem::eliminate(
        problem.linearise(other_->state, ml::Weighting::kInformation, nullptr, nullptr), 0.0);
    if (!eliminated) return;
    alternative.find_covariance(*eliminated);
    if (free_.cols() > 0 || alternative.free_.cols() > 0) return;
    Eigen::VectorXd apart(joint_.rows());
    for (std::size_t c = 0; c < fit_.state.T_robot_camera.size(); ++c)
      apart.segment<6>(6 * static_cast<Eigen::Index>(c)) =
          transform_error(other_->state.T_robot_camera[c], fit_.state.T_robot_camera[c]);
    const double share = 1.0 - estimate_.odometry.probability;
    joint_ = (1.0 - share) * joint_ + share * (alternative.joint_ + apart * apart.transpose());
  }

  bool exceeds_limits() const {
    const PosteriorLimits& limits = options_.limits;
    const std::array<double, 6> limit = {limits.xy_m,     limits.xy_m,     limits.z_m,
                                         limits.tilt_rad, limits.tilt_rad, limits.yaw_rad};
    for (Eigen::Index i = 0; i < joint_.rows(); ++i)
      if (!(std::sqrt(joint_(i, i)) <= limit[static_cast<std::size_t>(i % 6)])) return true;
    return false;
  }

  // Whether an answer is of use is judged by the odometry's level as it most likely is, not by how badly a handful of
  // stops know it: the estimate counts with its redundant dimensions, the paper's nominal level as four more. What is
  // stated keeps the whole uncertainty.
  Eigen::MatrixXd gate_covariance(const Eigen::MatrixXd& J) const {
    if (!final_sums_) return joint_;
    constexpr double kNominalDimensions = 4.0;
    ml::NoiseLevels levels = fit_.noise;
    const ml::NoiseLevels nominal;
    const auto shrink = [&](Group group, double ml::NoiseLevels::*level) {
      const double redundancy = std::max(0.0, ml::sum_of(*final_sums_, group).redundancy());
      const double estimated = levels.*level, usual = nominal.*level;
      levels.*level = std::sqrt((redundancy * estimated * estimated + kNominalDimensions * usual * usual) /
                                (redundancy + kNominalDimensions));
    };
    if (!original_.odometry_noise.sigma_xy_m) shrink(Group::kOdometryXy, &ml::NoiseLevels::odometry_xy_m);
    if (!original_.odometry_noise.sigma_yaw_rad) shrink(Group::kOdometryYaw, &ml::NoiseLevels::odometry_yaw_rad);
    const ml::Problem problem = final_problem(levels);
    const auto eliminated = ml::EliminatedSystem::eliminate(
        problem.linearise(fit_.state, ml::Weighting::kInformation, nullptr, nullptr), 0.0);
    if (!eliminated) return joint_;
    return J * ml::invert_information(eliminated->schur()).covariance * J.transpose();
  }

  void copy_state(const ml::Layout& layout) {
    CalibrationState& state = estimate_.state;
    state.T_robot_camera = fit_.state.T_robot_camera;
    state.T_world_board = fit_.state.T_world_board;
    for (const ml::RobotPose& pose : fit_.state.poses) state.T_world_robot.push_back(pose.transform());
    state.odometry_scale = fit_.state.odometry_scale;
    state.odometry_yaw_factor = fit_.state.odometry_yaw_factor;
    for (int c = 0; c < layout.cameras; ++c)
      state.depth_scale.push_back(1.0 + fit_.state.depth_bias[static_cast<std::size_t>(c)]);
    CalibrationNoise& noise = estimate_.noise;
    noise.odometry_model = fit_.noise.odometry_model;
    noise.odometry_xy_m = fit_.noise.odometry_xy_m;
    noise.odometry_yaw_rad = fit_.noise.odometry_yaw_rad;
    noise.suspension_height_m = fit_.noise.suspension_height_m;
    noise.suspension_tilt_rad = fit_.noise.suspension_tilt_rad;
    noise.odometry_scale_prior = options_.odometry_scale_sigma;
    noise.odometry_yaw_factor_prior = options_.odometry_yaw_factor_sigma;
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
    const int ground_planes = static_cast<int>(used_.ground_planes.size());
    for (const int c : solved_cameras()) {
      EstimatedTransform transform;
      transform.parent = original_.robot_frame;
      transform.child = original_.cameras[static_cast<std::size_t>(c)].name;
      transform.T_parent_child = fit_.state.T_robot_camera[static_cast<std::size_t>(c)];
      const Matrix6d covariance = joint_.block<6, 6>(6 * c, 6 * c), gate = gate_joint_.block<6, 6>(6 * c, 6 * c);
      CameraObservability observability =
          assess_camera(original_, c, views_, alignment_, estimate_.motion, ground_planes);
      apply_posterior_gate(gate, transform.child, &observability, options_.limits);
      const std::array<bool, 6> free_of = determined(free.middleRows(6 * c, 6));
      for (std::size_t axis = 0; axis < 6; ++axis)
        transform.observable[axis] = observability.observable[axis] && free_of[axis];
      if (transform.observable != observability.observable && observability.sentences.empty())
        add_reason(transform.child + ": " + kOpenDirection);
      transform.covariance = covariance;
      for (const std::string& sentence : observability.sentences) add_reason(sentence);
      estimate_.result.camera_to_robot.push_back(std::move(transform));
    }
    report_joint();
  }

  void report_joint() {
    const std::vector<EstimatedTransform>& cameras = estimate_.result.camera_to_robot;
    const bool complete =
        std::all_of(cameras.begin(), cameras.end(), [](const EstimatedTransform& t) { return t.fully_observable(); });
    if (!complete) return;
    const std::vector<int> solved = solved_cameras();
    Eigen::MatrixXd joint(6 * static_cast<Eigen::Index>(solved.size()), 6 * static_cast<Eigen::Index>(solved.size()));
    for (std::size_t a = 0; a < solved.size(); ++a)
      for (std::size_t b = 0; b < solved.size(); ++b)
        joint.block<6, 6>(6 * static_cast<Eigen::Index>(a), 6 * static_cast<Eigen::Index>(b)) =
            joint_.block<6, 6>(6 * solved[a], 6 * solved[b]);
    estimate_.result.joint_covariance = std::move(joint);
  }

  void report_pairs() {
    const std::vector<int> solved = solved_cameras();
    const Eigen::MatrixXd free = normalised_free();
    for (std::size_t a = 0; a < solved.size(); ++a) {
      for (std::size_t b = a + 1; b < solved.size(); ++b) {
        const Eigen::MatrixXd P = ml::pair_chart(fit_.state.T_robot_camera, solved[a], solved[b]);
        EstimatedTransform transform;
        transform.parent = original_.cameras[static_cast<std::size_t>(solved[a])].name;
        transform.child = original_.cameras[static_cast<std::size_t>(solved[b])].name;
        const std::size_t j = static_cast<std::size_t>(solved[a]), k = static_cast<std::size_t>(solved[b]);
        transform.T_parent_child = fit_.state.T_robot_camera[j].inverse() * fit_.state.T_robot_camera[k];
        const Matrix6d covariance = P * joint_ * P.transpose();
        transform.covariance = covariance;
        transform.observable = determined(P * free);
        if (!transform.fully_observable() && estimate_.result.reasons.empty())
          add_reason(transform.child + " in " + transform.parent + ": " + kOpenDirection);
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
      const double limit = axis < 3 ? options_.limits.xy_m : options_.limits.yaw_rad;
      if (!(sigma <= limit)) pair->observable[static_cast<std::size_t>(axis)] = false;
    }
    if (worst_m > options_.limits.xy_m || worst_rad > options_.limits.yaw_rad)
      add_reason(format("%s in %s: too uncertain to be of use: +-%.1f cm, +-%.2f deg (limit %.1f cm, %.2f deg)",
                        pair->child.c_str(), pair->parent.c_str(), 100.0 * worst_m, rad_to_deg(worst_rad),
                        100.0 * options_.limits.xy_m, rad_to_deg(options_.limits.yaw_rad)));
  }

  void add_reason(const std::string& sentence) {
    std::vector<std::string>& reasons = estimate_.result.reasons;
    if (std::find(reasons.begin(), reasons.end(), sentence) == reasons.end()) reasons.push_back(sentence);
  }

  // The sense of the odometry's turns tells up from down. Planes that then hang above the cameras say that the turns
  // are mirrored, or belong to other stops.
  void check_upside_down() {
    int above = 0;
    for (const PlaneObservation& plane : original_.ground_planes) {
      const std::optional<Eigen::Vector3d>& up = alignment_.up_camera[static_cast<std::size_t>(plane.camera)];
      if (up && up->dot(-plane.inverse_depth_plane.normalized()) < -0.9) ++above;
    }
    upside_down_ = above > 0 && 2 * above > static_cast<int>(original_.ground_planes.size());
    if (!upside_down_) return;
    contradictions_.odometry.push_back(
        "By the odometry's turns the ground would lie above the cameras; a mirrored frame, turns of the other sign, or "
        "shifted stamps.");
  }

  // The board's size against depth and odometry; and what had to be taken on trust.
  void check_lengths() {
    if (lens_spoils()) return;  // depth on the board would be blamed for the lens
    std::optional<ml::OdometryScale> odometry;
    const int index = ml::Layout::of(used_, priors()).odometry_scale();
    const bool trusted = !symptoms_.odometry && motion_suffices();
    if (trusted && fit_.noise.odometry_model == OdometryModel::kPerIncrement)
      odometry = {fit_.state.odometry_scale, std::sqrt(globals_.covariance(index, index))};
    const ml::BoardScale scale = ml::check_board_scale(used_, views_, odometry);
    contradictions_.cameras.insert(contradictions_.cameras.begin(), scale.contradictions.begin(),
                                   scale.contradictions.end());
    std::vector<std::string>& notes = estimate_.result.notes;
    notes.insert(notes.end(), scale.notes.begin(), scale.notes.end());
  }

  bool lens_spoils() const { return cause_ && cause_->spoils_all; }

  // Most likely causes first, then what speaks for them, then what the motion does not answer.
  void report_contradictions() {
    Result& result = estimate_.result;
    std::vector<std::string> causes = wrong_frames_, symptoms = contradictions_.cameras;
    if (cause_) causes.push_back(cause_->sentence);
    symptoms.insert(symptoms.end(), contradictions_.odometry.begin(), contradictions_.odometry.end());
    if (causes.empty() && symptoms.empty()) return;
    const bool all = !wrong_frames_.empty() || !contradictions_.cameras.empty() || lens_spoils() || upside_down_;
    if (upside_down_ && motion_suffices()) result.reasons.clear();  // "no ground seen" is a consequence
    const bool motion_first = !motion_suffices() && causes.empty();
    result.reasons.insert(motion_first ? result.reasons.end() : result.reasons.begin(), symptoms.begin(),
                          symptoms.end());
    result.reasons.insert(result.reasons.begin(), causes.begin(), causes.end());
    for (EstimatedTransform& transform : result.camera_to_robot) {
      for (const std::size_t axis : {0U, 1U, 5U}) transform.observable[axis] = false;
      if (all) transform.observable.fill(false);
    }
    if (all)
      for (EstimatedTransform& transform : result.camera_to_camera) transform.observable.fill(false);
    result.joint_covariance.reset();
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
    for (std::size_t c = 0; c < original_.cameras.size(); ++c) {
      if (solved(static_cast<int>(c))) continue;
      all = false;
      add_reason(original_.cameras[c].name + " never saw the board: it has no pose.");
    }
    result.status = all ? ResultStatus::kSolved : any ? ResultStatus::kPartial : ResultStatus::kRefused;
    // Along what the data leave open there is nothing to settle at; that is a reason above.
    if (!estimate_.converged && result.status == ResultStatus::kSolved)
      result.notes.push_back("The iteration did not settle: treat the result with care.");
  }

  void report_residuals(const ml::GroupSums& sums) {
    const auto add = [&](const char* name, std::initializer_list<Group> groups) {
      ml::GroupSum total;
      for (const Group group : groups)
        for (std::size_t c = 0; c < original_.cameras.size(); ++c)
          total += ml::sum_of(sums, group, static_cast<int>(c));
      if (total.dimensions == 0) return;
      const double rms = std::sqrt(total.square / total.dimensions);
      estimate_.result.residuals.push_back({name, "sigma", total.dimensions, rms});
    };
    add("corners", {Group::kCorners});
    add("ground", {Group::kGround});
    add("board planes", {Group::kBoardPlane});
    add("odometry", {Group::kOdometryXy, Group::kOdometryYaw});
  }

  void add_use() {
    for (std::size_t c = 0; c < original_.cameras.size(); ++c) {
      CameraUse use;
      use.camera = original_.cameras[c].name;
      const auto mine = [c](const Exclusion& e) { return e.camera == static_cast<int>(c); };
      std::copy_if(original_.exclusions.begin(), original_.exclusions.end(), std::back_inserter(use.left_out), mine);
      std::copy_if(excluded_.begin(), excluded_.end(), std::back_inserter(use.left_out), mine);
      if (!fit_.state.poses.empty()) add_views(static_cast<int>(c), &use);
      estimate_.result.use.push_back(std::move(use));
    }
  }

  void add_views(int camera, CameraUse* use) const {
    const ml::Problem problem(used_, priors(), fit_.noise);
    double square = 0.0;
    for (std::size_t v = 0; v < used_.board_views.size(); ++v) {
      const BoardView& view = used_.board_views[v];
      if (view.camera != camera) continue;
      const double rms = problem.view_fit(fit_.state, v).rms_px;
      if (fit_.view_left_out[v]) {
        if (has_pose(v)) use->left_out.push_back({camera, view.stop, view.file, format("residual %.1f px", rms)});
        continue;
      }
      ++use->used;
      square += rms * rms;
    }
    if (use->used > 0) use->reprojection_rms_px = std::sqrt(square / use->used);
  }

  const Observations& original_;
  const MlOptions& options_;
  Observations used_;  // without planes that are not the ground
  std::vector<ViewPose> views_;
  std::vector<Exclusion> excluded_;
  TrajectoryAlignment alignment_;
  InitialGuess guess_;
  ml::State start_;
  Fit fit_;
  std::optional<Fit> other_;  // the other odometry model's solution, where it is not out of the question
  int max_rounds_ = 8;        // in which wrong views are left out: one for each camera at a stop
  std::size_t rejected_planes_ = 0;
  ml::Symptoms symptoms_;
  std::vector<ml::WildRow> wild_rows_;
  std::optional<ml::GroupSums> final_sums_;
  bool upside_down_ = false;
  std::optional<ml::LensTest> lenses_;
  std::optional<ml::Cause> cause_;
  std::vector<std::string> wrong_frames_;
  std::vector<Eigen::Matrix3d> ground_offset_;  // covariance of what a camera's ground planes share; empty: none
  ml::Contradictions contradictions_;
  ml::GlobalCovariance globals_;
  Eigen::MatrixXd joint_;
  Eigen::MatrixXd gate_joint_;  // by which is refused
  Eigen::MatrixXd free_;
  MlEstimate estimate_;
};

class MlMethod : public Method {
 public:
  MethodTraits traits() const override {
    return {"ml", "Maximum likelihood of cameras, board, robot poses and nuisances together, with its uncertainty",
            "board, odometry; ground planes for the height", "camera to robot (6), camera to camera (6), covariance"};
  }
  Result solve(const Observations& observations) const override {
    return estimate_maximum_likelihood(observations).result;
  }
};

}  // namespace

MlEstimate estimate_maximum_likelihood(const Observations& observations, const MlOptions& options) {
  return Estimator(observations, options).run();
}

const Method& ml_method() {
  static const MlMethod method;
  return method;
}

}  // namespace rigproof
