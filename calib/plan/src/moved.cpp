#include "rigproof/calib/plan/moved.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "knowledge.h"
#include "rigproof/core/chi_square.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr double kPower = 0.9;  // with which a shift must show

void check(const MovedOptions& options) {
  Problems problems;
  if (!(options.significance > 0.0 && options.significance < 0.5))
    problems.add({"", 0, "significance", number_text(options.significance), "allowed: more than 0, less than 0.5"});
  const auto require_positive = [&problems](const char* field, double value) {
    if (!(value > 0.0)) problems.add({"", 0, field, number_text(value), "must be positive"});
  };
  require_positive("smallest_shift_m", options.smallest_shift_m);
  require_positive("smallest_turn_rad", options.smallest_turn_rad);
  problems.throw_if_any();
}

// A set of cameras, or the whole rig as one body, that may have moved, and what of the difference that explains.
struct Hypothesis {
  std::vector<std::size_t> cameras;
  bool rig = false;
  moved::Explanation explanation;
};

// What old and new knowledge differ by.
struct Evidence {
  moved::Difference difference;
  const std::vector<Rigid3>& T_robot_camera;  // before
  double significance;

  Eigen::MatrixXd columns_of(const std::vector<std::size_t>& cameras) const {
    Eigen::MatrixXd E =
        Eigen::MatrixXd::Zero(difference.information.rows(), 6 * static_cast<Eigen::Index>(cameras.size()));
    for (std::size_t i = 0; i < cameras.size(); ++i)
      E.block<6, 6>(6 * static_cast<Eigen::Index>(cameras[i]), 6 * static_cast<Eigen::Index>(i)).setIdentity();
    return E;
  }

  Hypothesis cameras_moved(const std::vector<std::size_t>& cameras) const {
    return {cameras, false, moved::explain(difference, columns_of(cameras))};
  }

  Hypothesis rig_moved() const {
    std::vector<std::size_t> all(T_robot_camera.size());
    std::iota(all.begin(), all.end(), 0U);
    return {all, true, moved::explain(difference, moved::rig_motion(T_robot_camera))};
  }

  double rest_of(const Hypothesis& hypothesis) const {
    return std::max(0.0, difference.statistic - hypothesis.explanation.reduction);
  }

  // Whether noise leaves as much unexplained.
  bool explains(const Hypothesis& hypothesis) const {
    const int dof = difference.rank - hypothesis.explanation.rank;
    return (dof > 0 ? chi_square_tail(rest_of(hypothesis), dof) : 1.0) >= significance;
  }
};

// Noncentrality with which the test rejects with probability kPower.
double needed_noncentrality(double dof, double significance) {
  const double threshold = chi_square_quantile(1.0 - significance, dof);
  double low = 0.0, high = 10.0;
  while (noncentral_chi_square_tail(threshold, dof, high) < kPower) high *= 2.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (noncentral_chi_square_tail(threshold, dof, middle) < kPower ? low : high) = middle;
  }
  return high;
}

// The length of a shift along the worst combination of the columns that has the needed noncentrality.
double detectable(const Eigen::MatrixXd& information, double needed, const Eigen::MatrixXd& E) {
  const Eigen::MatrixXd A = E.transpose() * information * E;
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues()[0];
  constexpr double kNothing = 1e-6;
  return least > kNothing ? std::sqrt(needed / least) : std::numeric_limits<double>::infinity();
}

void set_shift(const moved::Explanation& explanation, Eigen::Index row, CameraShift* camera) {
  constexpr double kShare = 1e-3;  // of an undetermined direction
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const std::size_t i = static_cast<std::size_t>(axis);
    const bool open =
        explanation.undetermined.cols() > 0 && explanation.undetermined.row(row + axis).cwiseAbs().maxCoeff() > kShare;
    camera->shift[i] = open ? std::nullopt : std::optional(explanation.shift[row + axis]);
    camera->sigma[i] = open ? std::nullopt : std::optional(std::sqrt(explanation.covariance(row + axis, row + axis)));
  }
}

// A camera by itself, all others standing.
CameraShift shift_alone(const Evidence& evidence, std::size_t c, double needed, const MovedOptions& options) {
  CameraShift camera;
  const Eigen::MatrixXd E = evidence.columns_of({c});
  camera.detectable_shift_m = detectable(evidence.difference.information, needed, E.leftCols<3>());
  camera.detectable_turn_rad = detectable(evidence.difference.information, needed, E.rightCols<3>());
  const moved::Explanation alone = moved::explain(evidence.difference, E);
  if (alone.rank > 0) camera.p_value = chi_square_tail(alone.reduction, alone.rank);
  set_shift(alone, 0, &camera);
  const bool would_show =
      camera.detectable_shift_m <= options.smallest_shift_m && camera.detectable_turn_rad <= options.smallest_turn_rad;
  camera.verdict = would_show ? MovedVerdict::kStands : MovedVerdict::kCannotTell;
  return camera;
}

// Others that stand, beside what moved: each alone would take the shift of that upon itself.
void set_shifts_beside(const Evidence& evidence, const Hypothesis& guilty, MovedReport* report) {
  const Eigen::MatrixXd theirs =
      guilty.rig ? moved::rig_motion(evidence.T_robot_camera) : evidence.columns_of(guilty.cameras);
  for (std::size_t c = 0; c < report->cameras.size(); ++c) {
    CameraShift& camera = report->cameras[c];
    if (camera.verdict == MovedVerdict::kMoved || camera.verdict == MovedVerdict::kSuspect) continue;
    Eigen::MatrixXd E(theirs.rows(), theirs.cols() + 6);
    E << theirs, evidence.columns_of({c});
    const moved::Explanation both = moved::explain(evidence.difference, E);
    const int rank = both.rank - guilty.explanation.rank;
    const double reduction = std::max(0.0, both.reduction - guilty.explanation.reduction);
    camera.p_value = rank > 0 ? chi_square_tail(reduction, rank) : 1.0;
    set_shift(both, theirs.cols(), &camera);
  }
}

void accuse(const Evidence& evidence, const Hypothesis& guilty, MovedReport* report) {
  for (std::size_t i = 0; i < guilty.cameras.size(); ++i) {
    CameraShift& camera = report->cameras[guilty.cameras[i]];
    camera.verdict = MovedVerdict::kMoved;
    if (!guilty.rig) set_shift(guilty.explanation, 6 * static_cast<Eigen::Index>(i), &camera);
  }
  set_shifts_beside(evidence, guilty, report);
}

// Camera after camera until the rest is noise.
Hypothesis several_cameras(const Evidence& evidence, std::vector<std::size_t> cameras) {
  const std::size_t count = evidence.T_robot_camera.size();
  Hypothesis hypothesis;
  while (cameras.size() < count && (hypothesis.cameras.empty() || !evidence.explains(hypothesis))) {
    std::optional<Hypothesis> best;
    for (std::size_t c = 0; c < count; ++c) {
      if (std::find(cameras.begin(), cameras.end(), c) != cameras.end()) continue;
      std::vector<std::size_t> more = cameras;
      more.push_back(c);
      Hypothesis trial = evidence.cameras_moved(more);
      if (!best || evidence.rest_of(trial) < evidence.rest_of(*best)) best = std::move(trial);
    }
    hypothesis = std::move(*best);
    cameras = hypothesis.cameras;
  }
  return hypothesis;
}

// All that explain it, and not a hundred times worse than the best.
std::vector<const Hypothesis*> suspects_of(const Evidence& evidence, const std::vector<Hypothesis>& hypotheses,
                                           const Hypothesis& best) {
  const double margin = 2.0 * std::log(100.0);
  std::vector<const Hypothesis*> suspects;
  for (const Hypothesis& hypothesis : hypotheses)
    if (evidence.explains(hypothesis) && evidence.rest_of(hypothesis) < evidence.rest_of(best) + margin)
      suspects.push_back(&hypothesis);
  return suspects;
}

void suspect(const std::vector<const Hypothesis*>& suspects, MovedReport* report) {
  Finding ambiguous("moved.ambiguous");
  for (const Hypothesis* hypothesis : suspects) {
    if (hypothesis->rig) {
      ambiguous.values.emplace_back("with_rig", 1);
      continue;
    }
    CameraShift& camera = report->cameras[hypothesis->cameras.front()];
    ambiguous.cameras.push_back(camera.camera);
    camera.verdict = MovedVerdict::kSuspect;
  }
  report->reasons.push_back(ambiguous);
}

// One camera, or the rig as one body; else several cameras.
void name_who_moved(const Evidence& evidence, MovedReport* report) {
  std::vector<Hypothesis> single;
  for (std::size_t c = 0; c < report->cameras.size(); ++c) single.push_back(evidence.cameras_moved({c}));
  if (report->cameras.size() > 1) single.push_back(evidence.rig_moved());
  const Hypothesis& best = *std::min_element(
      single.begin(), single.end(),
      [&](const Hypothesis& a, const Hypothesis& b) { return evidence.rest_of(a) < evidence.rest_of(b); });
  if (!evidence.explains(best))
    return accuse(evidence, several_cameras(evidence, best.rig ? std::vector<std::size_t>() : best.cameras), report);
  const std::vector<const Hypothesis*> suspects = suspects_of(evidence, single, best);
  if (suspects.size() > 1) {
    suspect(suspects, report);
    return set_shifts_beside(evidence, best, report);
  }
  report->rig_moved = best.rig;
  if (best.rig) report->reasons.emplace_back("moved.rig");
  accuse(evidence, best, report);
}

// What the rig as one body could do unnoticed.
std::vector<std::string> open_motions(const Evidence& evidence, double needed, const MovedOptions& options) {
  static const std::array<const char*, 6> kMotions = {"x", "y", "z", "roll", "pitch", "yaw"};
  const Eigen::MatrixXd E = moved::rig_motion(evidence.T_robot_camera);
  std::vector<std::string> open;
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const double limit = axis < 3 ? options.smallest_shift_m : options.smallest_turn_rad;
    if (!(detectable(evidence.difference.information, needed, E.col(axis)) <= limit))
      open.emplace_back(kMotions[static_cast<std::size_t>(axis)]);
  }
  return open;
}

MovedReport compare(const std::vector<std::string>& names, const moved::KnownPoses& before,
                    const moved::NewKnowledge& now, const MovedOptions& options) {
  Evidence evidence{moved::difference(before, now.held), before.T_robot_camera, options.significance};
  MovedReport report;
  report.statistic = evidence.difference.statistic;
  report.degrees_of_freedom = evidence.difference.rank;
  double needed = 0.0;
  if (evidence.difference.rank > 0) {
    report.p_value = chi_square_tail(report.statistic, report.degrees_of_freedom);
    needed = needed_noncentrality(report.degrees_of_freedom, options.significance);
  }
  for (std::size_t c = 0; c < names.size(); ++c) {
    report.cameras.push_back(shift_alone(evidence, c, needed, options));
    report.cameras.back().camera = names[c];
  }
  if (report.p_value < options.significance) {
    report.outcome = MovedOutcome::kMoved;
    evidence.difference = moved::difference(before, now.free);
    name_who_moved(evidence, &report);
  } else if (std::all_of(report.cameras.begin(), report.cameras.end(),
                         [](const CameraShift& c) { return c.verdict == MovedVerdict::kStands; })) {
    report.outcome = MovedOutcome::kNothingMoved;
  }
  if (evidence.difference.rank == 0 || names.size() < 2) return report;
  const std::vector<std::string> open = open_motions(evidence, needed, options);
  if (!open.empty()) report.notes.push_back(Finding("moved.open_motions").along(open));
  return report;
}

// A camera that did not see the board: nothing can be said of it.
void add_unseen(const std::string& name, MovedReport* report) {
  CameraShift camera;
  camera.camera = name;
  camera.detectable_shift_m = camera.detectable_turn_rad = std::numeric_limits<double>::infinity();
  report->cameras.push_back(std::move(camera));
  report->reasons.push_back(Finding("moved.unseen").of(name));
  if (report->outcome == MovedOutcome::kNothingMoved) report->outcome = MovedOutcome::kCannotTell;
}

}  // namespace

const char* moved_verdict_name(MovedVerdict verdict) {
  switch (verdict) {
    case MovedVerdict::kStands:
      return "stands";
    case MovedVerdict::kMoved:
      return "moved";
    case MovedVerdict::kSuspect:
      return "suspect";
    case MovedVerdict::kCannotTell:
      break;
  }
  return "cannot tell";
}

MovedReport detect_movement(const Result& previous, const Observations& observations, const MovedOptions& options) {
  check(options);
  const moved::Match match = moved::match_cameras(previous, observations);
  MovedReport report;
  std::vector<Finding> notes, reasons;
  if (!match.names.empty()) {
    const Observations seen = moved::of_matched(observations, match);
    const moved::KnownPoses before = moved::previous_knowledge(previous, seen, match, &notes);
    const moved::NewKnowledge now = moved::new_knowledge(before, seen, options, &reasons, &notes);
    report = compare(match.names, before, now, options);
  }
  for (const std::string& name : match.unseen) add_unseen(name, &report);
  report.notes.insert(report.notes.begin(), notes.begin(), notes.end());
  report.reasons.insert(report.reasons.begin(), reasons.begin(), reasons.end());
  return report;
}

}  // namespace rigproof
