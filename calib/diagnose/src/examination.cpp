#include "examination.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "dead_odometry.h"
#include "depth_shape.h"
#include "exchanged_cameras.h"
#include "ground_misfit.h"
#include "rigproof/calib/diagnose/board_scale.h"
#include "rigproof/calib/estimate/lens_change.h"
#include "rigproof/calib/estimate/odometry_choice.h"
#include "rigproof/calib/estimate/shaking.h"
#include "rigproof/core/exclusions.h"
#include "start_misfit.h"
#include "steps.h"
#include "swapped_frames.h"
#include "yaw_drift.h"

namespace rigproof::ml {
namespace {

// More than one in so many are no exception.
constexpr std::size_t kMany = 5;

// The sense of the odometry's turns tells up from down. Planes that then hang above the cameras say that the turns
// are mirrored, or belong to other stops.
bool hangs_upside_down(const Preparation& prepared) {
  std::size_t above = 0;
  for (const PlaneObservation& plane : prepared.original.ground_planes) {
    const std::optional<Eigen::Vector3d>& up = prepared.alignment.up_camera[static_cast<std::size_t>(plane.camera)];
    if (up && up->dot(-plane.inverse_depth_plane.normalized()) < -0.9) ++above;
  }
  return above > 0 && 2 * above > prepared.original.ground_planes.size();
}

Contradictions contradictions_of(const Preparation& prepared, const Problem& problem, const State& state,
                                 const std::optional<GroupSums>& sums) {
  Contradictions found = sums ? find_contradictions(problem, state, *sums) : Contradictions();
  if (hangs_upside_down(prepared)) found.odometry.push_back(Finding("odometry.upside_down"));
  return found;
}

// Views of a solution that nothing else agrees with.
std::vector<const BoardView*> views_left_out(const Preparation& prepared, const Fit& fit) {
  std::vector<const BoardView*> left_out;
  for (std::size_t v = 0; v < prepared.used.board_views.size(); ++v)
    if (fit.view_left_out[v] && prepared.has_pose(v)) left_out.push_back(&prepared.used.board_views[v]);
  return left_out;
}

int count_of(const std::vector<const BoardView*>& views, int camera) {
  return static_cast<int>(
      std::count_if(views.begin(), views.end(), [camera](const BoardView* view) { return view->camera == camera; }));
}

std::vector<SwappedFrames> swapped_frames(const Preparation& prepared, const Fit& fit) {
  std::vector<bool> doubtful(prepared.used.stops.size(), false);
  for (const BoardView* view : views_left_out(prepared, fit)) doubtful[static_cast<std::size_t>(view->stop)] = true;
  for (const WildRow& row : find_wild_rows(prepared.used, fit.noise, fit.state)) {
    doubtful[static_cast<std::size_t>(row.stop)] = true;
    if (row.slip) doubtful[static_cast<std::size_t>(row.stop) - 1] = true;
  }
  return likelier_swapped(problem_at(prepared, fit, fit.noise), fit.state,
                          find_swapped_frames(prepared.used, prepared.views, fit.state, doubtful));
}

// At the stated levels wrong frames are outliers; estimated levels may have swallowed them.
std::vector<Finding> find_wrong_frames(const Preparation& prepared, const Fit& fit) {
  MlOptions strict = prepared.options;
  strict.start.reset();
  strict.estimate_corner_level = strict.estimate_plane_level = false;
  strict.displacement_scale = NoiseLevels().displacement_scale;
  const Preparation other = prepare(prepared.original, strict, &prepared.views);
  const Fit other_fit = fit_model(other, fit.noise.law);
  std::vector<Finding> wrong;
  for (const SwappedFrames& swapped : swapped_frames(other, other_fit))
    wrong.push_back(finding_of(swapped, prepared.used));
  return wrong;
}

// Of cameras of which many views had to be left out.
std::vector<Finding> contradicting_cameras(const Observations& observations,
                                           const std::vector<const BoardView*>& left_out) {
  std::vector<const BoardView*> all;
  for (const BoardView& view : observations.board_views) all.push_back(&view);
  std::vector<Finding> findings;
  for (std::size_t c = 0; c < observations.cameras.size(); ++c) {
    const int out = count_of(left_out, static_cast<int>(c)), views = count_of(all, static_cast<int>(c));
    if (out > 1 && static_cast<int>(kMany) * out > views)
      findings.push_back(
          Finding("frames.contradict", {{"left_out", out}, {"views", views}}).of(observations.cameras[c].name));
  }
  return findings;
}

// Of cameras of which many ground planes had to be left out.
std::vector<Finding> contradicting_ground(const Preparation& prepared) {
  const auto contradicts = [](const Exclusion& exclusion) {
    const Finding& why = exclusion.why;
    return exclusion.depth && (why.is("plane.other_height") || why.is("plane.off_vertical") ||
                               why.is("plane.ceiling") || why.is("plane.above"));
  };
  std::vector<Exclusion> all = prepared.original.exclusions;
  all.insert(all.end(), prepared.excluded.begin(), prepared.excluded.end());
  std::vector<Finding> findings;
  for (std::size_t c = 0; c < prepared.original.cameras.size(); ++c) {
    const std::vector<Exclusion> of_camera = exclusions_of(all, static_cast<int>(c));
    const std::vector<PlaneObservation>& planes = prepared.used.ground_planes;
    const auto out = static_cast<std::size_t>(std::count_if(of_camera.begin(), of_camera.end(), contradicts));
    const auto used =
        static_cast<std::size_t>(std::count_if(planes.begin(), planes.end(), [c](const PlaneObservation& plane) {
          return plane.camera == static_cast<int>(c);
        }));
    if (out > 1 && kMany * out > out + used)
      findings.push_back(Finding("ground.contradicts", {{"left_out", out}, {"planes", out + used}})
                             .of(prepared.original.cameras[c].name));
  }
  return findings;
}

std::optional<LensTest> lens_test(const Preparation& prepared, const Fit& fit) {
  return test_lenses(problem_at(prepared, fit, fit.noise, with_doubted_lenses(prepared.priors)), prepared.repeating,
                     prepared.priors, fit.state);
}

OdometryLaw likely_law(const Preparation& prepared, const Fit& fit, OdometryModel declared) {
  if (declared != OdometryModel::kUnknown) return declared_law(declared, prepared.options);
  OdometryLaw law = fit.noise.law;
  law.model = OdometryModel::kPerIncrement;
  return law;
}

// Whether nothing in the solution of a trial contradicts itself.
bool is_clean(const Preparation& prepared, const Fit& fit, const Problem& problem,
              const std::optional<LensTest>& lenses) {
  const std::vector<const BoardView*> left_out = views_left_out(prepared, fit);
  if (std::any_of(left_out.begin(), left_out.end(),
                  [&](const BoardView* view) { return count_of(left_out, view->camera) > 1; }))
    return false;
  const std::optional<GroupSums> sums = problem.sums_with_leverage(fit.state);
  if (!sums || (lenses && lenses->suspicious())) return false;
  const Contradictions found = contradictions_of(prepared, problem, fit.state, sums);
  return found.odometry.empty() && found.cameras.empty();
}

// -2 ln of the likelihood, where what was left out counts as very wrong: else leaving out would explain everything.
double unexplained(const Preparation& prepared, const Fit& fit, const Problem& problem) {
  constexpr double kVeryWrong = 1e4;     // whitened square
  constexpr double kUnexplained = 1e15;  // -2 ln
  const double sum = minus_two_log_likelihood(problem, fit.state) + prepared.repeating.cost();
  double left_out = static_cast<double>(prepared.rejected_planes);
  for (std::size_t v = 0; v < prepared.used.board_views.size(); ++v)
    if (fit.view_left_out[v]) left_out += static_cast<double>(prepared.used.board_views[v].corners.size());
  // Odometry of which nothing is left but its scale explains nothing.
  const auto factors = fit.state.nuisances.of(Nuisance::kOdometryFactors).array().abs();
  const auto sigmas = prepared.priors.covariance(Nuisance::kOdometryFactors).diagonal().array().sqrt();
  if ((factors > 3.0 * sigmas).any() || !std::isfinite(sum)) return kUnexplained;
  return sum + left_out * problem.loss.cost(kVeryWrong);
}

// The solution of repaired observations, by the law that the solution found.
std::optional<Trial> refit(const Preparation& before, const Fit& fit, const Observations& repaired, bool same_views,
                           const Trial* as_is, bool with_lenses) {
  MlOptions options = before.options;
  options.start.reset();
  options.tolerance = std::max(options.tolerance, 1e-4);
  std::vector<ViewPose> views;
  for (const ViewPose& view : before.views)
    if (view.stop < static_cast<int>(repaired.stops.size())) views.push_back(view);
  Preparation prepared = closed_form(repaired, options, same_views ? &views : nullptr);
  if (!prepared.solvable()) return std::nullopt;
  Trial trial;
  trial.start_misfit = start_misfit(prepared);
  if (as_is != nullptr && is_hopeless(trial.start_misfit, as_is->start_misfit)) return trial;
  complete(&prepared);
  constexpr int kRounds = 1;
  const Fit refitted = fit_model(prepared, likely_law(before, fit, repaired.odometry_noise.model), kRounds);
  const Problem problem = problem_at(prepared, refitted, refitted.noise);
  trial.unexplained = unexplained(prepared, refitted, problem);
  trial.odometry_xy_m = refitted.noise.odometry_xy_m;
  trial.odometry_yaw_rad = refitted.noise.odometry_yaw_rad;
  if (with_lenses) trial.lenses = lens_test(prepared, refitted);
  trial.lens_strains = lens_strains(prepared, refitted);
  trial.clean = is_clean(prepared, refitted, problem, trial.lenses);
  trial.shakes = trial.clean && shakes_anywhere(prepared, refitted);
  return trial;
}

// A shift of all principal points widens the levels of suspension and odometry, which hide it then. Where there may
// be one, it is judged by the levels that the data have without it.
LensEstimate looked_at_again(const Preparation& prepared, const Fit& fit, const LensEstimate& shift) {
  Observations repaired = prepared.original;
  const Eigen::Vector3d change(0.0, shift.value[1], shift.value[2]);
  for (std::size_t c = 0; c < repaired.cameras.size(); ++c) change_lens(static_cast<int>(c), change, &repaired);
  const std::optional<Trial> trial = refit(prepared, fit, repaired, true, nullptr, true);
  if (!trial || !trial->lenses) return shift;
  LensEstimate without = trial->lenses->common_shift;
  without.move_by(shift.value);
  return without;
}

std::optional<LensTest> examine_lenses(const Preparation& prepared, const Fit& fit, bool motion_suffices) {
  std::optional<LensTest> lenses = lens_test(prepared, fit);
  if (lenses && !lenses->suspicious() && motion_suffices && lenses->common_shift.may_contradict())
    lenses->common_shift = looked_at_again(prepared, fit, lenses->common_shift);
  return lenses;
}

Symptoms symptoms_of(const Preparation& prepared, const Fit& fit, const Examination& found) {
  const StampShift shift = estimate_stamp_shift(prepared.used, fit.noise, fit.state);
  Symptoms symptoms;
  symptoms.stops_ahead = shift.stops;
  symptoms.odometry_scale = fit.state.odometry_scale();
  symptoms.odometry_yaw_factor = fit.state.odometry_yaw_factor();
  symptoms.yaw_drift = estimate_yaw_drift(prepared.used, fit.noise, fit.state);
  symptoms.bad_corners = found.contradictions.bad_corners;
  symptoms.bad_corners.resize(prepared.original.cameras.size(), false);
  // Odometry in millimetres can bend the corners and agree with the bent ones, or outweigh the images so far that most
  // are left out, or that nothing is determined.
  const bool bent = std::count(symptoms.bad_corners.begin(), symptoms.bad_corners.end(), true) > 0;
  const bool outweighs = 2 * views_left_out(prepared, fit).size() > prepared.used.board_views.size();
  symptoms.odometry = shift.contradicts() || !found.contradictions.odometry.empty() || bent || outweighs || !found.sums;
  if (!found.motion_suffices()) return symptoms;
  const bool cameras = !found.contradictions.cameras.empty();
  symptoms.frames = cameras || !found.contradictions.odometry.empty();
  symptoms.lenses = cameras || (found.lenses && found.lenses->suspicious());
  return symptoms;
}

// A board of another size bends the corners' solution where depth is believed, and looks like a wrong lens then.
bool board_is_clean(const Preparation& prepared, const Fit& fit, const std::vector<BoardScale::Ratio>& ratios) {
  Observations repaired = prepared.original;
  for (const BoardScale::Ratio& ratio : ratios) {
    Board& board = ratio.board == 0 ? repaired.board : repaired.more_boards[static_cast<std::size_t>(ratio.board) - 1];
    board.square_m *= std::exp(ratio.log_depth_ratio);
  }
  const std::optional<Trial> trial = refit(prepared, fit, repaired, false, nullptr, true);
  return trial && trial->clean;
}

// Cameras whose depth differs from their corners by a factor that no unit explains, or all of them.
std::vector<std::pair<std::vector<int>, double>> depth_ratios(const Preparation& prepared, const BoardScale& scale) {
  constexpr double kFarOff = 0.2;  // ln: beyond it a focal length is out of reach of small steps
  std::vector<std::pair<std::vector<int>, double>> ratios;
  for (const Finding& finding : scale.contradictions) {
    if (!finding.is("depth.scale")) continue;
    for (const int c : prepared.solved_cameras())
      if (prepared.original.cameras[static_cast<std::size_t>(c)].name == finding.cameras.front())
        ratios.push_back({{c}, std::get<double>(finding.find("factor")->value)});
  }
  if (!ratios.empty() || scale.depth_unit) return ratios;
  for (const BoardScale::Ratio& of_board : scale.ratios)
    if (std::abs(of_board.log_depth_ratio) > kFarOff)
      ratios.push_back({prepared.used.boards() == 1 ? prepared.solved_cameras() : of_board.cameras,
                        std::exp(of_board.log_depth_ratio)});
  return ratios;
}

std::optional<Cause> cause_of(const Preparation& prepared, const Fit& fit, Symptoms symptoms) {
  const BoardScale scale = check_board_scale(prepared.used, prepared.views, std::nullopt);
  symptoms.depth_ratios = depth_ratios(prepared, scale);
  if (scale.depth_unit && symptoms.depth_ratios.empty()) return std::nullopt;
  symptoms.lenses = symptoms.lenses || !symptoms.depth_ratios.empty();
  if (!scale.contradictions.empty() && !scale.ratios.empty()) {
    if (!scale.depth_unit && board_is_clean(prepared, fit, scale.ratios)) return std::nullopt;
    symptoms.lenses = true;
  }
  const std::optional<Cause> cause =
      find_cause(prepared.original, symptoms, [&](const Observations& repaired, bool same_views, const Trial* as_is) {
        return refit(prepared, fit, repaired, same_views, as_is, symptoms.lenses);
      });
  // Depth that is wrong by a factor bends what else is tried.
  if (scale.depth_unit && cause && !cause->findings.front().is("lens.intrinsics")) return std::nullopt;
  return cause;
}

std::vector<Finding> notes_of_rows(const Preparation& prepared, const std::vector<WildRow>& rows) {
  std::vector<Finding> notes;
  if (kMany * rows.size() > std::max(kMany, prepared.used.stops.size())) return notes;
  for (const WildRow& row : rows) notes.push_back(finding_of(row, prepared.used));
  return notes;
}

// Of cameras whose driver hung, or whose files were copied.
void note_repeats(const Observations& observations, bool depth, std::vector<Finding>* notes) {
  for (std::size_t c = 0; c < observations.cameras.size(); ++c) {
    std::size_t images = 0, repeats = 0;
    for (const BoardView& view : observations.board_views) images += view.camera == static_cast<int>(c);
    for (const Exclusion& exclusion : exclusions_of(observations.exclusions, static_cast<int>(c))) {
      images += exclusion.why.is("image.repeats");
      repeats += exclusion.why.is(depth ? "depth.repeats" : "image.repeats");
    }
    if (repeats > 0)
      notes->push_back(
          Finding(depth ? "depth.frames_repeat" : "frames.repeat", {{"repeats", repeats}, {"images", images}})
              .of(observations.cameras[c].name));
  }
}

// Of depth that was left out as a whole: each cause once, with its cameras.
std::optional<Cause> cause_of_exclusions(const Observations& observations, const std::vector<Finding>& of_cameras) {
  // Where a camera's images contradict the others they are wrong, not depth that does not meet them.
  const auto by_images = [&of_cameras](const Finding& cause) {
    return cause.is("depth.contradicts") &&
           std::any_of(of_cameras.begin(), of_cameras.end(), [&cause](const Finding& found) {
             return found.is("frames.contradict") && found.cameras == cause.cameras;
           });
  };
  std::vector<Finding> each, causes;
  for (const Exclusion& exclusion : observations.exclusions)
    if (exclusion.why.severity == Severity::kCause && !by_images(exclusion.why)) add_once(exclusion.why, &each);
  for (const Finding& one : each) {
    const auto same = std::find_if(causes.begin(), causes.end(), [&one](const Finding& cause) {
      return cause.code == one.code && !one.is("depth.of_another_camera");
    });
    if (same == causes.end())
      causes.push_back(one);
    else
      same->cameras.push_back(one.cameras.front());
  }
  for (std::size_t i = 1; i < causes.size(); ++i) causes[i] = causes[i].with({{"joined_by", "and"}});
  return causes.empty() ? std::nullopt : std::optional(Cause{causes, true});
}

Cause joined(std::optional<Cause> first, const Cause& second) {
  if (!first) return second;
  for (const Finding& finding : second.findings) {
    const bool is_said = std::any_of(first->findings.begin(), first->findings.end(), [&finding](const Finding& said) {
      return said.code == finding.code && said.cameras == finding.cameras;
    });
    if (!is_said) first->findings.push_back(finding.with({{"joined_by", "and"}}));
  }
  return {first->findings, first->spoils_all || second.spoils_all};
}

Finding wrong_frame(const Observations& observations, const BoardView& view) {
  return Finding("frame.contradicts")
      .of(observations.cameras[static_cast<std::size_t>(view.camera)].name)
      .at({view.stop});
}

// Half a pixel turns a camera like a wrong mounting does: only views at the images' edges tell them apart.
std::optional<Finding> note_of_lens_trust(const std::optional<LensTest>& lenses) {
  constexpr double kSlip_px = 0.5, kDetects = 5.0;
  if (!lenses || lenses->suspicious()) return std::nullopt;
  const double sigma_px = lenses->common_shift.sigma.tail<2>().maxCoeff();
  if (kDetects * sigma_px < kSlip_px || !(sigma_px < 1e3)) return std::nullopt;
  return Finding("lens.on_trust", {{"sigma_px", sigma_px}});
}

bool leaves_in_order(const Preparation& prepared, const FoundStep& step) {
  return is_clean(prepared, step.fit, problem_at(prepared, step.fit, step.fit.noise), std::nullopt);
}

// Where both leave the data in order: a board that leaned at half time is explained a little by other lenses, too. A
// cause acts on all stops alike, also those that are not examined.
bool explains_more(const FoundStep& step, const Cause& cause, std::size_t stops) {
  constexpr double kDecides = 10.0;
  const double share = std::max(1.0, static_cast<double>(stops) / kDiagnosedStops);
  return step.gain > cause.gain * share + kDecides;
}

// What bends the answer is a cause, what does not a warning.
void take(const std::vector<Finding>& findings, bool bends, bool spoils_all, Examination* found) {
  if (bends)
    found->cause = Cause{findings, spoils_all};
  else
    found->notes.insert(found->notes.end(), findings.begin(), findings.end());
}

// What moved during the drive, and what else may be wrong. A step counts if it leaves the data in order: what is wrong
// otherwise has a best step, too. So has what is loose all the time, which still shakes then.
void find_moved_or_wrong(const Preparation& prepared, const Fit& fit, const std::vector<StepScore>& scores,
                         Examination* found) {
  std::optional<FoundStep> step;
  if (found->motion_suffices() && static_cast<int>(prepared.used.stops.size()) >= kLeastStopsForSteps)
    step = find_step(prepared, fit, scores);
  if (step && !leaves_in_order(prepared, *step)) step.reset();
  if (found->symptoms.any() && prepared.original.stops.size() >= 3)
    found->cause = cause_of(prepared, fit, found->symptoms);
  if (step && found->cause && explains_more(*step, *found->cause, prepared.used.stops.size())) found->cause.reset();
  if (found->cause) return;
  if (step) {
    take(step->findings, step->bends, true, found);
    if (found->cause) found->cause->leaves_shaking = shakes_anywhere(prepared, step->fit);
  } else if (found->motion_suffices() && !found->symptoms.any())
    if (const std::optional<FoundDrift> drift = find_yaw_drift(prepared, fit))
      take({drift->finding}, drift->bends, false, found);
}

// Lenses that are those of other cameras bend all else.
void find_cause_of(const Preparation& prepared, const Fit& fit, const std::vector<StepScore>& scores,
                   Examination* found) {
  if (found->motion_suffices())
    found->cause =
        find_exchanged_cameras(prepared, fit, [&](const Observations& repaired, bool same_views, const Trial* as_is) {
          return refit(prepared, fit, repaired, same_views, as_is, false);
        });
  if (!found->cause) find_moved_or_wrong(prepared, fit, scores, found);
}

}  // namespace

bool Examination::contradicts() const {
  return !wrong_frames.empty() || !contradictions.odometry.empty() || !contradictions.cameras.empty();
}

bool Examination::is_in_order() const {
  return !cause && !contradicts() && !symptoms.any() &&
         std::all_of(notes.begin(), notes.end(), [](const Finding& note) {
           return note.severity == Severity::kNote || note.is("camera.moved_slightly") ||
                  note.is("board.moved_slightly");
         });
}

std::optional<Cause> cause_without_excuses(const Preparation& prepared, const Fit& fit) {
  std::optional<Cause> cause =
      find_cause_in_images(prepared.original, [&](const Observations& repaired, bool same_views, const Trial* as_is) {
        return refit(prepared, fit, repaired, same_views, as_is, false);
      });
  if (cause && cause->leaves_shaking) cause.reset();
  return cause;
}

namespace {

// Ground that is off is suspected; farther off, nothing that rests on it can be trusted.
void take_ground_misfits(const Preparation& prepared, const Fit& fit, Examination* found) {
  if (!found->sums || found->cause || found->contradicts()) return;
  for (const Finding& finding : find_ground_misfits(prepared, fit, *found->sums))
    (finding.severity == Severity::kSuspect ? found->notes : found->contradictions.cameras).push_back(finding);
}

// Each camera's, by what those saw that boards tie to it.
std::vector<MotionVerdict> motions_of(const Preparation& prepared) {
  const std::vector<int> group = prepared.tied_by_boards();
  std::map<int, std::vector<int>> cameras;
  for (const int c : prepared.solved_cameras()) cameras[group[static_cast<std::size_t>(c)]].push_back(c);
  std::vector<MotionVerdict> motions(group.size());
  for (const auto& [number, tied] : cameras) {
    const MotionVerdict verdict =
        assess_motion(prepared.original, prepared.views, prepared.alignment, prepared.guess, tied);
    for (const int c : tied) motions[static_cast<std::size_t>(c)] = verdict;
  }
  return motions;
}

}  // namespace

const MotionVerdict& Examination::motion() const {
  static const MotionVerdict kNone;
  const auto sufficient = std::find_if(motions.begin(), motions.end(), [](const MotionVerdict& verdict) {
    return verdict.kind == MotionKind::kSufficient;
  });
  if (sufficient != motions.end()) return *sufficient;
  const auto any = std::max_element(motions.begin(), motions.end(), [](const MotionVerdict& a, const MotionVerdict& b) {
    return a.usable_poses < b.usable_poses;
  });
  return any == motions.end() ? kNone : *any;
}

Examination examine(const Preparation& prepared, const Fit& fit) {
  const Problem problem = problem_at(prepared, fit, fit.noise);
  Examination found;
  found.motions = motions_of(prepared);
  std::vector<StepScore> steps;
  found.sums = problem.sums_with_leverage(
      fit.state, splits_of(static_cast<int>(prepared.used.stops.size()), kSplitsAtFirst), &steps);
  found.upside_down = hangs_upside_down(prepared);
  found.contradictions = contradictions_of(prepared, problem, fit.state, found.sums);
  std::vector<Finding>& of_cameras = found.contradictions.cameras;
  const std::vector<WildRow> wild_rows = find_wild_rows(prepared.used, fit.noise, fit.state);
  const std::vector<const BoardView*> left_out = views_left_out(prepared, fit);
  const bool contradicted = !found.contradictions.odometry.empty() || !of_cameras.empty();
  if ((contradicted || !left_out.empty() || !wild_rows.empty()) && prepared.used.cameras.size() > 1 &&
      found.motion_suffices())
    found.wrong_frames = find_wrong_frames(prepared, fit);
  // Swapped frames spoil a recording; single wrong ones are left out.
  const std::vector<Finding> contradicting = contradicting_cameras(prepared.used, left_out);
  of_cameras.insert(of_cameras.end(), contradicting.begin(), contradicting.end());
  found.notes = notes_of_rows(prepared, wild_rows);
  if (!contradicted && contradicting.empty())
    for (const BoardView* view : left_out) found.notes.push_back(wrong_frame(prepared.used, *view));
  found.lenses = examine_lenses(prepared, fit, found.motion_suffices());
  if (!prepared.priors.has(Nuisance::kLens))
    if (const std::optional<Finding> note = note_of_lens_trust(found.lenses)) found.notes.push_back(*note);
  for (const bool depth : {false, true}) note_repeats(prepared.original, depth, &found.notes);
  if (found.contradictions.odometry.empty()) {  // else the vertical is wrong, too
    const std::vector<Finding> ground = contradicting_ground(prepared);
    of_cameras.insert(of_cameras.end(), ground.begin(), ground.end());
  }
  found.symptoms = symptoms_of(prepared, fit, found);
  const std::optional<Cause> foreign = cause_of_exclusions(prepared.original, of_cameras);
  if (const auto dead = find_dead_odometry(prepared.original, prepared.views, !found.contradictions.odometry.empty()))
    found.cause = Cause{{*dead}, false};
  else if (found.wrong_frames.empty())
    find_cause_of(prepared, fit, steps, &found);
  // What else is wrong bends planes, too.
  if (found.motion_suffices() && !found.cause && !foreign && !found.symptoms.any() && of_cameras.empty() &&
      found.wrong_frames.empty()) {
    const std::vector<Finding> misplaced = find_misplaced_depth(prepared, fit);
    if (!misplaced.empty()) found.cause = cause_without_excuses(prepared, fit);
    if (!found.cause) found.notes.insert(found.notes.end(), misplaced.begin(), misplaced.end());
  }
  if (!foreign) take_ground_misfits(prepared, fit, &found);
  // Depth that does not belong to its images contradicts images that are wrong themselves.
  if (foreign && (!found.cause || !found.cause->spoils_all)) found.cause = joined(found.cause, *foreign);
  return found;
}

}  // namespace rigproof::ml
