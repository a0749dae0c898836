#include "examination.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rigproof/calib/diagnose/board_scale.h"
#include "rigproof/calib/estimate/lens_change.h"
#include "swapped_frames.h"

namespace rigproof::ml {
namespace {

class Examiner {
 public:
  Examiner(const Preparation& prepared, const Fit& fit, const MotionVerdict& motion) : prepared_(prepared), fit_(fit) {
    found_.motion = motion;
  }

  Examination run() {
    const Problem problem = problem_at(prepared_, fit_, fit_.noise);
    found_.sums = problem.sums_with_leverage(fit_.state);
    if (found_.sums) found_.contradictions = find_contradictions(problem, fit_.state, *found_.sums);
    check_upside_down();
    look_at_odometry();
    look_at_frames();
    found_.lenses = lens_test();
    look_again_at_lenses();
    found_.symptoms.odometry = found_.symptoms.odometry || !found_.contradictions.odometry.empty();
    found_.symptoms.bad_corners = found_.contradictions.bad_corners;
    found_.symptoms.bad_corners.resize(prepared_.original.cameras.size(), false);
    // Odometry in millimetres can bend the corners and agree with the bent ones.
    for (const bool bad : found_.symptoms.bad_corners) found_.symptoms.odometry = found_.symptoms.odometry || bad;
    note_lens_trust();
    found_.symptoms.lenses = !found_.contradictions.cameras.empty() || (found_.lenses && found_.lenses->suspicious());
    if (!found_.motion_suffices()) found_.symptoms.lenses = found_.symptoms.frames = false;
    if (!found_.symptoms.any() || prepared_.original.stops.size() < 3 || !found_.wrong_frames.empty() ||
        board_explains())
      return std::move(found_);
    found_.cause =
        find_cause(prepared_.original, found_.symptoms, [this](const Observations& repaired, bool same_views) {
          return refit(repaired, same_views, found_.symptoms.lenses);
        });
    return std::move(found_);
  }

 private:
  // A board of another size bends the corners' solution where depth is believed, and looks like a wrong lens then.
  bool board_explains() {
    const BoardScale scale = check_board_scale(prepared_.used, prepared_.views, std::nullopt);
    if (scale.depth_unit) return true;
    if (scale.contradictions.empty() || !scale.log_depth_ratio) return false;
    found_.symptoms.lenses = true;
    Observations repaired = prepared_.original;
    repaired.board.square_m *= std::exp(*scale.log_depth_ratio);
    const std::optional<Trial> trial = refit(repaired, false, true);
    return trial && trial->clean;
  }

  void look_at_odometry() {
    const StampShift shift = estimate_stamp_shift(prepared_.used, fit_.noise, fit_.state);
    found_.symptoms.stops_ahead = shift.stops;
    found_.symptoms.odometry = shift.contradicts();
    found_.symptoms.odometry_scale = fit_.state.odometry_scale();
    found_.wild_rows = find_wild_rows(prepared_.used, fit_.noise, fit_.state);
    constexpr std::size_t kMany = 5;  // more than one in five are no exception
    if (kMany * found_.wild_rows.size() > std::max(kMany, prepared_.used.stops.size())) return;
    for (const WildRow& row : found_.wild_rows) found_.notes.push_back(finding_of(row, prepared_.used));
  }

  // Views of a solution that nothing else agrees with, per camera.
  std::vector<int> views_left_out() const {
    std::vector<int> count(prepared_.used.cameras.size(), 0);
    for (std::size_t v = 0; v < prepared_.used.board_views.size(); ++v)
      if (fit_.view_left_out[v] && prepared_.has_pose(v))
        ++count[static_cast<std::size_t>(prepared_.used.board_views[v].camera)];
    return count;
  }

  std::vector<SwappedFrames> swapped_frames() const {
    std::vector<bool> doubtful(prepared_.used.stops.size(), false);
    for (std::size_t v = 0; v < prepared_.used.board_views.size(); ++v)
      if (fit_.view_left_out[v] && prepared_.has_pose(v))
        doubtful[static_cast<std::size_t>(prepared_.used.board_views[v].stop)] = true;
    for (const WildRow& row : find_wild_rows(prepared_.used, fit_.noise, fit_.state)) {
      doubtful[static_cast<std::size_t>(row.stop)] = true;
      if (row.slip) doubtful[static_cast<std::size_t>(row.stop) - 1] = true;
    }
    return likelier_swapped(problem_at(prepared_, fit_, fit_.noise), fit_.state,
                            find_swapped_frames(prepared_.used, prepared_.views, fit_.state, doubtful));
  }

  // Swapped frames spoil a recording; single wrong ones are left out.
  void look_at_frames() {
    const std::vector<int> left_out = views_left_out();
    std::vector<int> views(prepared_.used.cameras.size(), 0);
    for (const BoardView& view : prepared_.used.board_views) ++views[static_cast<std::size_t>(view.camera)];
    const bool suspicious = !found_.contradictions.odometry.empty() || !found_.contradictions.cameras.empty() ||
                            std::any_of(left_out.begin(), left_out.end(), [](int count) { return count > 0; }) ||
                            !found_.wild_rows.empty();
    if (suspicious && prepared_.used.cameras.size() > 1 && found_.motion_suffices()) {
      // At the stated levels wrong frames are outliers; estimated levels may have swallowed them.
      MlOptions strict = prepared_.options;
      strict.start.reset();
      strict.estimate_corner_level = strict.estimate_plane_level = false;
      const Preparation other(prepared_.original, strict, &prepared_.views);
      const Fit other_fit = fit_model(other, {fit_.noise.odometry_model, fit_.noise.along_way});
      for (const SwappedFrames& swapped : Examiner(other, other_fit, found_.motion).swapped_frames())
        found_.wrong_frames.push_back(finding_of(swapped, prepared_.used));
    }
    found_.symptoms.frames = !found_.contradictions.cameras.empty() || !found_.contradictions.odometry.empty();
    constexpr int kMany = 5;  // more than one in five
    for (std::size_t c = 0; c < views.size(); ++c) {
      if (left_out[c] <= 1 || kMany * left_out[c] <= views[c]) continue;
      found_.symptoms.frames = true;
      found_.contradictions.cameras.push_back(
          Finding("frames.contradict", {{"left_out", left_out[c]}, {"views", views[c]}})
              .of(prepared_.used.cameras[c].name));
    }
    if (found_.symptoms.frames) return;
    for (std::size_t v = 0; v < prepared_.used.board_views.size(); ++v)
      if (fit_.view_left_out[v] && prepared_.has_pose(v)) note_wrong_frame(prepared_.used.board_views[v]);
  }

  void note_wrong_frame(const BoardView& view) {
    found_.notes.push_back(Finding("frame.contradicts")
                               .of(prepared_.used.cameras[static_cast<std::size_t>(view.camera)].name)
                               .at({view.stop}));
  }

  // Half a pixel turns a camera like a wrong mounting does: only views at the images' edges tell them apart.
  void note_lens_trust() {
    constexpr double kSlip_px = 0.5, kDetects = 5.0;
    if (!found_.lenses || found_.lenses->suspicious()) return;
    const double sigma_px = found_.lenses->common_shift.sigma.tail<2>().maxCoeff();
    if (kDetects * sigma_px < kSlip_px || !(sigma_px < 1e3)) return;
    found_.notes.push_back(Finding("lens.on_trust", {{"sigma_px", sigma_px}}));
  }

  std::optional<LensTest> lens_test() const {
    if (prepared_.priors.has(Nuisance::kLens)) return std::nullopt;
    return test_lenses(problem_at(prepared_, fit_, fit_.noise, with_doubted_lenses(prepared_.priors)), fit_.state);
  }

  // A shift of all principal points widens the levels of suspension and odometry, which hide it then. Where there may
  // be one, it is judged by the levels that the data have without it.
  void look_again_at_lenses() {
    if (!found_.lenses || found_.lenses->suspicious() || !found_.motion_suffices()) return;
    LensEstimate& shift = found_.lenses->common_shift;
    if (!shift.may_contradict()) return;
    Observations repaired = prepared_.original;
    const Eigen::Vector3d change(0.0, shift.value[1], shift.value[2]);
    for (std::size_t c = 0; c < repaired.cameras.size(); ++c) change_lens(static_cast<int>(c), change, &repaired);
    const std::optional<Trial> trial = refit(repaired, true, true);
    if (!trial || !trial->lenses) return;
    LensEstimate without = trial->lenses->common_shift;
    without.move_by(shift.value);
    shift = without;
  }

  std::optional<Trial> refit(const Observations& repaired, bool same_views, bool with_lenses) const {
    MlOptions options = prepared_.options;
    options.start.reset();
    std::vector<ViewPose> views;
    for (const ViewPose& view : prepared_.views)
      if (view.stop < static_cast<int>(repaired.stops.size())) views.push_back(view);
    options.tolerance = std::max(options.tolerance, 1e-4);
    const Preparation prepared(repaired, options, same_views ? &views : nullptr);
    if (!prepared.solvable()) return std::nullopt;
    constexpr int kRounds = 1;
    const Fit refitted = fit_model(prepared, likely_law(repaired.odometry_noise.model), kRounds);
    Examiner other(prepared, refitted, motion_of(prepared));
    Trial trial;
    trial.unexplained = other.unexplained();
    trial.odometry_xy_m = refitted.noise.odometry_xy_m;
    trial.odometry_yaw_rad = refitted.noise.odometry_yaw_rad;
    if (with_lenses) trial.lenses = other.lens_test();
    trial.clean = other.clean(trial.lenses);
    return trial;
  }

  OdometryLaw likely_law(OdometryModel declared) const {
    if (declared == OdometryModel::kUnknown) return {OdometryModel::kPerIncrement, fit_.noise.along_way};
    return {declared, prepared_.options.along_way};
  }

  // Whether nothing in the solution of a trial contradicts itself.
  bool clean(const std::optional<LensTest>& lenses) {
    const Problem problem = problem_at(prepared_, fit_, fit_.noise);
    const std::optional<GroupSums> sums = problem.sums_with_leverage(fit_.state);
    if (!sums || (lenses && lenses->suspicious())) return false;
    found_.contradictions = find_contradictions(problem, fit_.state, *sums);
    check_upside_down();
    if (!found_.contradictions.odometry.empty() || !found_.contradictions.cameras.empty()) return false;
    for (const int count : views_left_out())
      if (count > 1) return false;
    return true;
  }

  // -2 ln of the likelihood, where what was left out counts as very wrong: else leaving out would explain everything.
  double unexplained() const {
    constexpr double kVeryWrong = 1e4;     // whitened square
    constexpr double kUnexplained = 1e15;  // -2 ln
    const Problem problem = problem_at(prepared_, fit_, fit_.noise);
    const double sum = minus_two_log_likelihood(problem, fit_.state);
    double left_out = static_cast<double>(prepared_.rejected_planes);
    for (std::size_t v = 0; v < prepared_.used.board_views.size(); ++v)
      if (fit_.view_left_out[v]) left_out += static_cast<double>(prepared_.used.board_views[v].corners.size());
    // Odometry of which nothing is left but its scale explains nothing.
    const auto factors = fit_.state.nuisances.of(Nuisance::kOdometryFactors).array().abs();
    const auto sigmas = prepared_.priors.covariance(Nuisance::kOdometryFactors).diagonal().array().sqrt();
    if ((factors > 3.0 * sigmas).any() || !std::isfinite(sum)) return kUnexplained;
    return sum + left_out * problem.loss.cost(kVeryWrong);
  }

  // The sense of the odometry's turns tells up from down. Planes that then hang above the cameras say that the turns
  // are mirrored, or belong to other stops.
  void check_upside_down() {
    int above = 0;
    for (const PlaneObservation& plane : prepared_.original.ground_planes) {
      const std::optional<Eigen::Vector3d>& up = prepared_.alignment.up_camera[static_cast<std::size_t>(plane.camera)];
      if (up && up->dot(-plane.inverse_depth_plane.normalized()) < -0.9) ++above;
    }
    found_.upside_down = above > 0 && 2 * above > static_cast<int>(prepared_.original.ground_planes.size());
    if (!found_.upside_down) return;
    found_.contradictions.odometry.push_back(Finding("odometry.upside_down"));
  }

  const Preparation& prepared_;
  const Fit& fit_;
  Examination found_;
};

}  // namespace

MotionVerdict motion_of(const Preparation& prepared) {
  return assess_motion(prepared.original, prepared.views, prepared.alignment, prepared.guess,
                       prepared.solved_cameras());
}

Examination examine(const Preparation& prepared, const Fit& fit, const MotionVerdict& motion) {
  return Examiner(prepared, fit, motion).run();
}

}  // namespace rigproof::ml
