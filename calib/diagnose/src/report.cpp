#include "report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "also_estimated.h"
#include "board_places.h"
#include "estimated_lenses.h"
#include "lasting_errors.h"
#include "missed_frames.h"
#include "rigproof/calib/diagnose/board_scale.h"
#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/exclusions.h"

namespace rigproof::ml {
namespace {

using Findings = std::vector<Finding>;
using Transforms = std::vector<EstimatedTransform>;

void append(const Findings& more, Findings* findings) { findings->insert(findings->end(), more.begin(), more.end()); }

std::vector<Exclusion> all_left_out(const Preparation& prepared) {
  std::vector<Exclusion> all = prepared.original.exclusions;
  all.insert(all.end(), prepared.excluded.begin(), prepared.excluded.end());
  return all;
}

const std::string& name_of(const Preparation& prepared, int camera) {
  return prepared.original.cameras[static_cast<std::size_t>(camera)].name;
}

CalibrationState state_of(const Preparation& prepared, const State& solution) {
  CalibrationState state;
  state.T_robot_camera = solution.T_robot_camera;
  state.T_world_board = solution.T_world_board.front();
  state.T_world_more_boards.assign(solution.T_world_board.begin() + 1, solution.T_world_board.end());
  for (const RobotPose& pose : solution.poses) state.T_world_robot.push_back(pose.transform());
  state.odometry_scale = solution.odometry_scale();
  state.odometry_yaw_factor = solution.odometry_yaw_factor();
  for (int c = 0; c < static_cast<int>(solution.T_robot_camera.size()); ++c) {
    const CommonDepth common = common_depth(prepared.used, c);
    state.depth_scale.push_back(1.0 +
                                common.share * solution.nuisances.of(Nuisance::kCommonDepthScale, common.camera)[0] +
                                solution.nuisances.of(Nuisance::kDepthScale, c)[0]);
  }
  return state;
}

CalibrationNoise noise_of(const NoiseLevels& levels, const PriorSigmas& priors) {
  return {
      levels.law, levels.odometry_xy_m, levels.odometry_yaw_rad, levels.suspension_height_m, levels.suspension_tilt_rad,
      priors};
}

// Of several boards.
Findings boards_in_no_image(const Preparation& prepared) {
  Findings findings;
  for (int b = 0; prepared.used.boards() > 1 && b < prepared.used.boards(); ++b)
    if (!prepared.sees(b)) findings.push_back(Finding("board.in_no_image", {{"board", b + 1}}));
  return findings;
}

MlEstimate estimate_of(const Preparation& prepared, const OdometryChoice& choice, const Examination& found,
                       const Statement& stated) {
  const Fit& fit = choice.fit;
  MlEstimate estimate;
  estimate.state = state_of(prepared, fit.state);
  estimate.noise = noise_of(fit.noise, prepared.sigmas());
  estimate.corner_scale = fit.noise.corner_scale;
  estimate.ground_scale = fit.noise.ground_scale;
  estimate.board_plane_scale = fit.noise.board_plane_scale;
  estimate.displacement_scale = fit.noise.displacement_scale;
  estimate.odometry = choice.decision;
  estimate.motion = found.motion();
  if (prepared.repeating.errors.any()) {
    estimate.repeating = std::make_shared<const RemovedErrors>(prepared.repeating);
    estimate.views_without_repeating = prepared.used.board_views;
  }
  estimate.cost = stated.cost;
  estimate.iterations = fit.summary.iterations;
  estimate.converged = fit.summary.converged;
  estimate.result.notes = choice.notes;
  append(found.notes, &estimate.result.notes);
  append(boards_in_no_image(prepared), &estimate.result.notes);
  return estimate;
}

// Degrees of a transform whose error contains a direction that the data leave free.
std::array<bool, 6> determined(const Eigen::MatrixXd& free) {
  constexpr double kShare = 1e-4;  // of the direction's largest part
  std::array<bool, 6> result = {true, true, true, true, true, true};
  for (Eigen::Index column = 0; column < free.cols(); ++column)
    for (int axis = 0; axis < 6; ++axis)
      if (std::abs(free(axis, column)) > kShare) result[static_cast<std::size_t>(axis)] = false;
  return result;
}

std::vector<EstimatedTransform::Share> budget_of_camera(const Uncertainty& uncertainty, int c) {
  const Vector6d variances = uncertainty.joint.diagonal().segment<6>(6 * c);
  std::vector<EstimatedTransform::Share> budget;
  for (const BudgetLine& line : uncertainty.budget) {
    const Vector6d shares = line.variances.segment<6>(6 * c).cwiseQuotient(variances).cwiseMax(0.0).cwiseMin(1.0);
    if (!shares.allFinite()) return {};
    budget.push_back({line.source, {}});
    std::copy(shares.data(), shares.data() + 6, budget.back().share.begin());
  }
  return budget;
}

// Adds to the reasons why a part of it is open.
EstimatedTransform camera_transform(const Preparation& prepared, const State& solution, const MotionVerdict& motion,
                                    const Uncertainty& uncertainty, int c, Findings* reasons) {
  EstimatedTransform transform;
  transform.parent = prepared.original.robot_frame;
  transform.child = name_of(prepared, c);
  transform.T_parent_child = solution.T_robot_camera[static_cast<std::size_t>(c)];
  transform.covariance = Matrix6d(uncertainty.joint.block<6, 6>(6 * c, 6 * c));
  transform.budget = budget_of_camera(uncertainty, c);
  const std::vector<int> tied = prepared.tied_by_boards();
  const auto of_group = [&](const PlaneObservation& plane) {
    return tied[static_cast<std::size_t>(plane.camera)] == tied[static_cast<std::size_t>(c)];
  };
  const std::vector<PlaneObservation>& planes = prepared.used.ground_planes;
  const auto ground_planes = static_cast<int>(std::count_if(planes.begin(), planes.end(), of_group));
  CameraObservability observability =
      assess_camera(prepared.original, c, prepared.views, prepared.alignment, motion, ground_planes);
  apply_posterior_gate(uncertainty.gate_joint.block<6, 6>(6 * c, 6 * c), transform.child, &observability,
                       prepared.options.limits);
  const std::array<bool, 6> free_of = determined(uncertainty.free_directions.middleRows(6 * c, 6));
  for (std::size_t axis = 0; axis < 6; ++axis)
    transform.observable[axis] = observability.observable[axis] && free_of[axis];
  if (transform.observable != observability.observable && observability.findings.empty())
    add_once(Finding("pose.open").of(transform.child), reasons);
  for (const Finding& finding : observability.findings) add_once(finding, reasons);
  return transform;
}

// Of the solved cameras; absent where a part of any is open.
std::optional<Eigen::MatrixXd> joint_of(const std::vector<int>& solved, const Transforms& cameras,
                                        const Eigen::MatrixXd& joint) {
  if (!std::all_of(cameras.begin(), cameras.end(), [](const EstimatedTransform& t) { return t.fully_observable(); }))
    return std::nullopt;
  const Eigen::Index n = static_cast<Eigen::Index>(solved.size());
  Eigen::MatrixXd result(6 * n, 6 * n);
  for (Eigen::Index a = 0; a < n; ++a)
    for (Eigen::Index b = 0; b < n; ++b)
      result.block<6, 6>(6 * a, 6 * b) =
          joint.block<6, 6>(6 * solved[static_cast<std::size_t>(a)], 6 * solved[static_cast<std::size_t>(b)]);
  return result;
}

// Between cameras no axis is special: the widest limits of gate 2 hold for all.
void gate_pair(const PosteriorLimits& limits, const Matrix6d& covariance, EstimatedTransform* pair, Findings* reasons) {
  double worst_m = 0.0, worst_rad = 0.0;
  for (int axis = 0; axis < 6; ++axis) {
    const double sigma = std::sqrt(covariance(axis, axis));
    double& worst = axis < 3 ? worst_m : worst_rad;
    worst = std::max(worst, sigma);
    const double limit = axis < 3 ? limits.xy_m : limits.yaw_rad;
    if (!(sigma <= limit)) pair->observable[static_cast<std::size_t>(axis)] = false;
  }
  if (worst_m > limits.xy_m || worst_rad > limits.yaw_rad)
    add_once(Finding("pair.too_uncertain", {{"sigma_cm", 100.0 * worst_m},
                                            {"sigma_deg", rad_to_deg(worst_rad)},
                                            {"limit_cm", 100.0 * limits.xy_m},
                                            {"limit_deg", rad_to_deg(limits.yaw_rad)}})
                 .of({pair->child, pair->parent}),
             reasons);
}

// The error's axes are the parent camera's, and no angle of a file belongs to one of them: a rotation of which a part
// is open is told of no axis.
void tell_rotation_whole_or_not(std::array<bool, 6>* observable) {
  if (!std::all_of(observable->begin() + 3, observable->end(), [](bool known) { return known; }))
    std::fill(observable->begin() + 3, observable->end(), false);
}

EstimatedTransform pair_transform(const Preparation& prepared, const std::vector<Rigid3>& T_robot_camera,
                                  const Uncertainty& uncertainty, int j, int k, Findings* reasons) {
  const Eigen::MatrixXd P = pair_chart(T_robot_camera, j, k);
  EstimatedTransform transform;
  transform.parent = name_of(prepared, j);
  transform.child = name_of(prepared, k);
  transform.T_parent_child =
      T_robot_camera[static_cast<std::size_t>(j)].inverse() * T_robot_camera[static_cast<std::size_t>(k)];
  transform.covariance = Matrix6d(P * uncertainty.joint * P.transpose());
  transform.observable = determined(P * uncertainty.free_directions);
  if (!transform.fully_observable() && reasons->empty())
    reasons->push_back(Finding("pair.open").of({transform.child, transform.parent}));
  gate_pair(prepared.options.limits, P * uncertainty.gate_joint * P.transpose(), &transform, reasons);
  tell_rotation_whole_or_not(&transform.observable);
  return transform;
}

// visit(a, b) for every two of the solved cameras, in the order of the result's pairs.
template <typename Visit>
void for_each_pair(const std::vector<int>& solved, const Visit& visit) {
  for (std::size_t a = 0; a < solved.size(); ++a)
    for (std::size_t b = a + 1; b < solved.size(); ++b) visit(solved[a], solved[b]);
}

void report_transforms(const Preparation& prepared, const State& solution, const std::vector<MotionVerdict>& motions,
                       const Uncertainty& uncertainty, Result* result) {
  const std::vector<int> solved = prepared.solved_cameras();
  for (const int c : solved)
    result->camera_to_robot.push_back(
        camera_transform(prepared, solution, motions[static_cast<std::size_t>(c)], uncertainty, c, &result->reasons));
  result->joint_covariance = joint_of(solved, result->camera_to_robot, uncertainty.joint);
  for_each_pair(solved, [&](int j, int k) {
    result->camera_to_camera.push_back(
        pair_transform(prepared, solution.T_robot_camera, uncertainty, j, k, &result->reasons));
  });
}

// The board's size against depth and odometry; and what had to be taken on trust.
BoardScale check_lengths(const Preparation& prepared, const Fit& fit, const Examination& found,
                         const Eigen::MatrixXd& globals) {
  if (found.lens_spoils()) return {};  // depth on the board would be blamed for the lens
  std::optional<OdometryScale> odometry;
  const int index = Layout::of(prepared.used, prepared.priors).place(Nuisance::kOdometryFactors);
  // A factor that is known more narrowly than this stays at one, whatever the data show: it vouches for no board.
  constexpr double kLeastPrior = 0.03;
  const bool trusted = !found.symptoms.odometry && found.motion_suffices() &&
                       prepared.priors.sigma(Nuisance::kOdometryFactors, 0, 0) > kLeastPrior;
  if (trusted && fit.noise.law.model == OdometryModel::kPerIncrement)
    odometry = {fit.state.odometry_scale(), index < 0 ? 0.0 : std::sqrt(globals(index, index))};
  const BoardScale as_stated = check_board_scale(prepared.used, prepared.views, odometry);
  // Lenses that are estimated say more, unless what contradicts them has bent them.
  if (!prepared.priors.has(Nuisance::kLens) || !as_stated.contradictions.empty()) return as_stated;
  const Observations seen = with_estimated_lenses(prepared, fit, globals);
  return check_board_scale(seen, estimate_view_poses(seen).poses, odometry);
}

// Odometry in another unit bends the corners' solution, too. The board is checked without it.
bool only_odometry_contradicts(const Examination& found, const Findings& of_board) {
  const bool images = !found.contradictions.cameras.empty() && !found.cause && found.contradictions.odometry.empty();
  return found.wrong_frames.empty() && !found.lens_spoils() && of_board.empty() && !images;
}

// Cameras that hardly see the board together hang on the odometry, which is contradicted.
void withhold_pairs(const Preparation& prepared, const Fit& fit, bool all, Result* result) {
  const std::vector<int> group = prepared.seen_together(fit.view_left_out);
  auto transform = result->camera_to_camera.begin();
  for_each_pair(prepared.solved_cameras(), [&](int j, int k) {
    const bool together = group[static_cast<std::size_t>(j)] == group[static_cast<std::size_t>(k)];
    if (all || !together) transform->observable.fill(false);
    if (!all && !together)
      add_once(Finding("pair.disconnected").of({transform->child, transform->parent}), &result->reasons);
    ++transform;
  });
}

// Most likely causes first, then what speaks for them, then what the motion does not answer.
void report_contradictions(const Preparation& prepared, const Fit& fit, const Examination& found,
                           const Findings& of_board, MlEstimate* estimate) {
  Result& result = estimate->result;
  Findings causes = found.wrong_frames, symptoms = of_board;
  if (found.cause) append(found.cause->findings, &causes);
  append(found.contradictions.cameras, &symptoms);
  const bool all = !found.wrong_frames.empty() || !symptoms.empty() || found.lens_spoils() || found.upside_down;
  append(found.contradictions.odometry, &symptoms);
  if (causes.empty() && symptoms.empty()) return;
  estimate->contradictions = causes;
  append(symptoms, &estimate->contradictions);
  estimate->only_odometry_contradicts = only_odometry_contradicts(found, of_board);
  if (found.upside_down && found.motion_suffices()) result.reasons.clear();  // "no ground seen" is a consequence
  const bool motion_first = !found.motion_suffices() && causes.empty();
  result.reasons.insert(motion_first ? result.reasons.end() : result.reasons.begin(), symptoms.begin(), symptoms.end());
  result.reasons.insert(result.reasons.begin(), causes.begin(), causes.end());
  causes_first(&result.reasons);
  for (EstimatedTransform& transform : result.camera_to_robot) {
    for (const std::size_t axis : {0U, 1U, 5U}) transform.observable[axis] = false;
    if (all) transform.observable.fill(false);
  }
  withhold_pairs(prepared, fit, all, &result);
  result.joint_covariance.reset();
}

void report_status(const Preparation& prepared, bool converged, Result* result) {
  bool all = true, any = false;
  for (const Transforms* transforms : {&result->camera_to_robot, &result->camera_to_camera})
    for (const EstimatedTransform& transform : *transforms)
      for (const bool observable : transform.observable) {
        all = all && observable;
        any = any || observable;
      }
  for (int c = 0; c < static_cast<int>(prepared.original.cameras.size()); ++c) {
    if (prepared.solved(c)) continue;
    all = false;
    add_once(with_lack_of_views(Finding("camera.no_pose"), all_left_out(prepared), c).of(name_of(prepared, c)),
             &result->reasons);
  }
  result->status = all ? ResultStatus::kSolved : any ? ResultStatus::kPartial : ResultStatus::kRefused;
  // Along what the data leave open there is nothing to settle at; that is a reason above.
  if (!converged && result->status == ResultStatus::kSolved) result->notes.emplace_back("solver.unsettled");
}

// What is not answered for want of frames that have odometry. Where the images are wrong too, that comes first.
void report_missed_frames(const Observations& observations, Result* result) {
  const std::optional<Finding> missed = find_missed_frames(observations);
  if (!missed) return;
  result->reasons.push_back(*missed);
  causes_first(&result->reasons);
}

// Where a camera's images mostly repeat each other, that is why its poses are too few, and no mere note.
void report_frozen_images(Result* result) {
  const auto number = [](const Finding& finding, const char* name) {
    return std::get<double>(finding.find(name)->value);
  };
  const auto is_frozen = [&](const Finding& note) {
    const auto lacks_an_answer = [&](const EstimatedTransform& transform) {
      const auto& known = transform.observable;
      return transform.child == note.cameras.front() && std::find(known.begin(), known.end(), false) != known.end();
    };
    return note.is("frames.repeat") && 2.0 * number(note, "repeats") > number(note, "images") &&
           std::any_of(result->camera_to_robot.begin(), result->camera_to_robot.end(), lacks_an_answer);
  };
  Findings kept;
  for (const Finding& note : result->notes) {
    if (!is_frozen(note)) {
      kept.push_back(note);
      continue;
    }
    result->reasons.push_back(
        Finding("images.frozen", {{"repeats", number(note, "repeats")}, {"images", number(note, "images")}})
            .of(note.cameras));
  }
  result->notes = std::move(kept);
  causes_first(&result->reasons);
}

void report_residuals(const GroupSums& sums, Result* result) {
  const auto add = [&](const char* name, std::initializer_list<Group> groups) {
    GroupSum total;
    for (const Group group : groups)
      for (const GroupSum& sum : sums[static_cast<std::size_t>(group)]) total += sum;
    if (total.dimensions == 0) return;
    const double rms = std::sqrt(total.square / total.dimensions);
    result->residuals.push_back({name, "sigma", static_cast<int>(std::lround(total.dimensions)), rms});
  };
  add("corners", {Group::kCorners});
  add("ground", {Group::kGround});
  add("board planes", {Group::kBoardPlane});
  add("odometry", {Group::kOdometryXy, Group::kOdometryYaw});
}

void add_views(const Preparation& prepared, const Fit& fit, const Problem& problem, int camera, CameraUse* use) {
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

// What each camera contributed and what was left out of it, before the solution.
std::vector<CameraUse> unused(const Preparation& prepared) {
  std::vector<CameraUse> uses(prepared.original.cameras.size());
  for (int c = 0; c < static_cast<int>(uses.size()); ++c) {
    CameraUse& use = uses[static_cast<std::size_t>(c)];
    use.camera = name_of(prepared, c);
    use.left_out = exclusions_of(all_left_out(prepared), c);
  }
  return uses;
}

std::vector<CameraUse> use_of(const Preparation& prepared, const Fit& fit) {
  std::vector<CameraUse> uses = unused(prepared);
  const Problem problem = problem_at(prepared, fit, fit.noise);
  for (std::size_t c = 0; c < uses.size(); ++c) add_views(prepared, fit, problem, static_cast<int>(c), &uses[c]);
  return uses;
}

}  // namespace

MlEstimate report(const Preparation& prepared, const OdometryChoice& choice, const Examination& found,
                  const Statement& stated) {
  MlEstimate estimate = estimate_of(prepared, choice, found, stated);
  Result& result = estimate.result;
  if (stated.uncertainty) {
    const GlobalCovariance& globals = stated.uncertainty->globals;
    report_transforms(prepared, choice.fit.state, found.motions, *stated.uncertainty, &result);
    const BoardScale lengths = check_lengths(prepared, choice.fit, found, globals.covariance);
    append(lengths.notes, &result.notes);
    report_contradictions(prepared, choice.fit, found, lengths.contradictions, &estimate);
    report_status(prepared, estimate.converged, &result);
    if (result.status != ResultStatus::kSolved) {
      report_missed_frames(prepared.original, &result);
      report_frozen_images(&result);
    }
    report_residuals(stated.sums, &result);
    report_also_estimated(prepared, choice.fit, globals, &result);
    if (result.status != ResultStatus::kRefused) result.boards = standing_boards(prepared, choice.fit, globals);
    result.lasting = lasting_errors(prepared, choice, globals, result);
  } else {
    if (found.cause) append(found.cause->findings, &result.reasons);
    result.reasons.emplace_back("poses.undetermined");
  }
  result.use = use_of(prepared, choice.fit);
  return estimate;
}

MlEstimate report_unsolvable(const Preparation& prepared) {
  MlEstimate estimate;
  estimate.result.reasons.emplace_back("board.never_seen");
  report_missed_frames(prepared.original, &estimate.result);
  estimate.result.use = unused(prepared);
  return estimate;
}

}  // namespace rigproof::ml
