#include "rigproof/calib/plan/moved.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "knowledge.h"
#include "remedies.h"
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

Eigen::MatrixXd columns_of(const std::vector<std::size_t>& cameras, std::size_t count) {
  Eigen::MatrixXd E =
      Eigen::MatrixXd::Zero(6 * static_cast<Eigen::Index>(count), 6 * static_cast<Eigen::Index>(cameras.size()));
  for (std::size_t i = 0; i < cameras.size(); ++i)
    E.block<6, 6>(6 * static_cast<Eigen::Index>(cameras[i]), 6 * static_cast<Eigen::Index>(i)).setIdentity();
  return E;
}

// A set of cameras, or the whole rig as one body, that may have moved, and what of the difference that explains.
struct Hypothesis {
  std::vector<std::size_t> cameras;
  bool rig = false;
  Eigen::MatrixXd motion;  // columns: what these may have done
  moved::Difference difference;
  moved::Explanation explanation;

  double rest() const { return std::max(0.0, difference.statistic - explanation.reduction); }

  // Whether noise leaves as much unexplained.
  bool explains(double significance) const {
    const int dof = difference.rank - explanation.rank;
    return (dof > 0 ? chi_square_tail(rest(), dof) : 1.0) >= significance;
  }
};

// Old and new knowledge.
struct Evidence {
  const moved::KnownPoses& before;
  const moved::NewKnowledge& now;
  double significance;

  std::size_t count() const { return before.T_robot_camera.size(); }

  moved::Difference difference(const Eigen::MatrixXd& motion) const {
    return moved::difference(before, now.if_moved(motion));
  }

  // Each is judged where the others stand: what the images leave open would else carry these along.
  Hypothesis cameras_moved(const std::vector<std::size_t>& cameras) const {
    Hypothesis hypothesis{cameras, false, columns_of(cameras, count()), {}, {}};
    hypothesis.difference = difference(hypothesis.motion);
    hypothesis.explanation = moved::explain(hypothesis.difference, hypothesis.motion);
    return hypothesis;
  }

  Hypothesis rig_moved() const { return rig_moved_along({0, 1, 2, 3, 4, 5}); }

  // At the new poses: the turn of the rig that the images leave open would, at the old ones, seem to explain by a
  // radian what one camera did by millimetres.
  Hypothesis rig_moved_along(const std::vector<Eigen::Index>& axes) const {
    Hypothesis hypothesis;
    hypothesis.cameras.resize(count());
    std::iota(hypothesis.cameras.begin(), hypothesis.cameras.end(), 0U);
    hypothesis.rig = true;
    hypothesis.difference = difference(moved::rig_motion(before.T_robot_camera)(Eigen::all, axes));
    hypothesis.motion = moved::rig_motion(hypothesis.difference.T_robot_camera)(Eigen::all, axes);
    hypothesis.explanation = moved::explain(hypothesis.difference, hypothesis.motion);
    return hypothesis;
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
CameraShift shift_alone(const moved::Difference& difference, const Eigen::MatrixXd& E, double needed,
                        const MovedOptions& options) {
  CameraShift camera;
  camera.detectable_shift_m = detectable(difference.information, needed, E.leftCols<3>());
  camera.detectable_turn_rad = detectable(difference.information, needed, E.rightCols<3>());
  const moved::Explanation alone = moved::explain(difference, E);
  if (alone.rank > 0) camera.p_value = chi_square_tail(alone.reduction, alone.rank);
  set_shift(alone, 0, &camera);
  const bool would_show =
      camera.detectable_shift_m <= options.smallest_shift_m && camera.detectable_turn_rad <= options.smallest_turn_rad;
  camera.verdict = would_show ? MovedVerdict::kStands : MovedVerdict::kCannotTell;
  return camera;
}

// Others that stand, beside what moved: each alone would take the shift of that upon itself.
void set_shifts_beside(const Hypothesis& guilty, MovedReport* report) {
  for (std::size_t c = 0; c < report->cameras.size(); ++c) {
    CameraShift& camera = report->cameras[c];
    if (camera.verdict == MovedVerdict::kMoved || camera.verdict == MovedVerdict::kSuspect) continue;
    Eigen::MatrixXd E(guilty.motion.rows(), guilty.motion.cols() + 6);
    E << guilty.motion, columns_of({c}, report->cameras.size());
    const moved::Explanation both = moved::explain(guilty.difference, E);
    const int rank = both.rank - guilty.explanation.rank;
    const double reduction = std::max(0.0, both.reduction - guilty.explanation.reduction);
    camera.p_value = rank > 0 ? chi_square_tail(reduction, rank) : 1.0;
    set_shift(both, guilty.motion.cols(), &camera);
  }
}

void accuse(const Hypothesis& guilty, MovedReport* report) {
  for (std::size_t i = 0; i < guilty.cameras.size(); ++i) {
    CameraShift& camera = report->cameras[guilty.cameras[i]];
    camera.verdict = MovedVerdict::kMoved;
    if (!guilty.rig) set_shift(guilty.explanation, 6 * static_cast<Eigen::Index>(i), &camera);
  }
  set_shifts_beside(guilty, report);
}

// Camera after camera until the rest is noise.
Hypothesis several_cameras(const Evidence& evidence, std::vector<std::size_t> cameras) {
  const std::size_t count = evidence.count();
  Hypothesis hypothesis;
  while (cameras.size() < count && (hypothesis.cameras.empty() || !hypothesis.explains(evidence.significance))) {
    std::optional<Hypothesis> best;
    for (std::size_t c = 0; c < count; ++c) {
      if (std::find(cameras.begin(), cameras.end(), c) != cameras.end()) continue;
      std::vector<std::size_t> more = cameras;
      more.push_back(c);
      Hypothesis trial = evidence.cameras_moved(more);
      if (!best || trial.rest() < best->rest()) best = std::move(trial);
    }
    hypothesis = std::move(*best);
    cameras = hypothesis.cameras;
  }
  return hypothesis;
}

const double kAsLikely = 2.0 * std::log(100.0);  // of the statistic: not a hundred times worse

// All that explain it about as well as the best.
std::vector<const Hypothesis*> suspects_of(const std::vector<Hypothesis>& hypotheses, const Hypothesis& best,
                                           double significance) {
  std::vector<const Hypothesis*> suspects;
  for (const Hypothesis& hypothesis : hypotheses)
    if (hypothesis.explains(significance) && hypothesis.rest() < best.rest() + kAsLikely)
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

// Of x, y and yaw of the rig on the robot odometry alone tells, and it may err by more than it states.
Finding of_the_rig(const Evidence& evidence) {
  Finding finding("moved.rig");
  if (evidence.rig_moved_along({0, 1, 5}).explains(evidence.significance))
    finding.values.emplace_back("by_odometry", 1);
  return finding;
}

// Were errors that last other ones than then, of some cameras or boards: whether nothing need have moved, and that
// explains it about as well.
bool others_explain(const Evidence& evidence, double rest_of_best,
                    const std::function<bool(const LastingErrors::Owner&)>& changed) {
  const std::optional<moved::NewKnowledge> apart = evidence.now.with_others(changed);
  if (!apart) return false;
  const moved::Difference standing =
      Evidence{evidence.before, *apart, evidence.significance}.difference(columns_of({}, evidence.count()));
  return standing.rank > 0 && standing.statistic < rest_of_best + kAsLikely &&
         chi_square_tail(standing.statistic, standing.rank) >= evidence.significance;
}

// Another board accuses cameras that did nothing; a lens that changed accuses the right one.
void doubt_errors(const Evidence& evidence, double rest_of_best, MovedReport* report) {
  std::vector<std::string> accused;
  for (const CameraShift& camera : report->cameras)
    if (camera.verdict == MovedVerdict::kMoved) accused.push_back(camera.camera);
  const auto is_accused = [&](const LastingErrors::Owner& owner) {
    return std::find(accused.begin(), accused.end(), owner.camera) != accused.end();
  };
  if (others_explain(evidence, rest_of_best, is_accused))
    report->reasons.push_back(Finding("moved.or_lens").of(accused));
  if (!others_explain(evidence, rest_of_best, [](const LastingErrors::Owner& owner) { return owner.board > 0; }))
    return;
  report->reasons.emplace_back("moved.or_board");
  for (CameraShift& camera : report->cameras)
    if (camera.verdict == MovedVerdict::kMoved) camera.verdict = MovedVerdict::kSuspect;
}

// One camera, or the rig as one body; else several cameras.
void name_who_moved(const Evidence& evidence, MovedReport* report) {
  std::vector<Hypothesis> single;
  for (std::size_t c = 0; c < report->cameras.size(); ++c) single.push_back(evidence.cameras_moved({c}));
  if (report->cameras.size() > 1) single.push_back(evidence.rig_moved());
  const Hypothesis& best = *std::min_element(
      single.begin(), single.end(), [](const Hypothesis& a, const Hypothesis& b) { return a.rest() < b.rest(); });
  if (!best.explains(evidence.significance)) {
    accuse(several_cameras(evidence, best.rig ? std::vector<std::size_t>() : best.cameras), report);
    return doubt_errors(evidence, std::numeric_limits<double>::infinity(), report);
  }
  const std::vector<const Hypothesis*> suspects = suspects_of(single, best, evidence.significance);
  if (suspects.size() > 1) {
    suspect(suspects, report);
    set_shifts_beside(best, report);
  } else {
    report->rig_moved = best.rig;
    if (best.rig) report->reasons.push_back(of_the_rig(evidence));
    accuse(best, report);
  }
  doubt_errors(evidence, best.rest(), report);
}

// What the rig as one body could do unnoticed.
std::vector<std::string> open_motions(const Eigen::MatrixXd& information, const std::vector<Rigid3>& T_robot_camera,
                                      double needed, const MovedOptions& options) {
  const Eigen::MatrixXd E = moved::rig_motion(T_robot_camera);
  std::vector<std::string> open;
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const double limit = axis < 3 ? options.smallest_shift_m : options.smallest_turn_rad;
    if (!(detectable(information, needed, E.col(axis)) <= limit))
      open.emplace_back(kRobotAxes[static_cast<std::size_t>(axis)]);
  }
  return open;
}

MovedReport compare(const std::vector<std::string>& names, const moved::KnownPoses& before,
                    const moved::NewKnowledge& now, const MovedOptions& options) {
  const Evidence evidence{before, now, options.significance};
  const moved::Difference standing = evidence.difference(columns_of({}, names.size()));
  MovedReport report;
  report.statistic = standing.statistic;
  report.degrees_of_freedom = standing.rank;
  double needed = 0.0;
  if (standing.rank > 0) {
    report.p_value = chi_square_tail(report.statistic, report.degrees_of_freedom);
    needed = needed_noncentrality(report.degrees_of_freedom, options.significance);
  }
  for (std::size_t c = 0; c < names.size(); ++c) {
    report.cameras.push_back(shift_alone(standing, columns_of({c}, names.size()), needed, options));
    report.cameras.back().camera = names[c];
  }
  if (report.p_value < options.significance) {
    report.outcome = MovedOutcome::kMoved;
    name_who_moved(evidence, &report);
  } else if (std::all_of(report.cameras.begin(), report.cameras.end(),
                         [](const CameraShift& c) { return c.verdict == MovedVerdict::kStands; })) {
    report.outcome = MovedOutcome::kNothingMoved;
  }
  if (standing.rank == 0 || names.size() < 2) return report;
  const std::vector<std::string> open = open_motions(standing.information, before.T_robot_camera, needed, options);
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
