#include "rigproof/calib/plan/moved.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

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
  if (!(options.smallest_shift_m > 0.0))
    problems.add({"", 0, "smallest_shift_m", number_text(options.smallest_shift_m), "must be positive"});
  if (!(options.smallest_turn_rad > 0.0))
    problems.add({"", 0, "smallest_turn_rad", number_text(options.smallest_turn_rad), "must be positive"});
  problems.throw_if_any();
}

// A set of cameras, or the whole rig as one body, that may have moved.
struct Hypothesis {
  std::vector<std::size_t> cameras;
  bool rig = false;
  Eigen::MatrixXd E;
  moved::Explanation explanation;
};

class Detective {
 public:
  Detective(const moved::Match& match, const moved::KnownPoses& before, const moved::NewKnowledge& now,
            const MovedOptions& options)
      : match_(match), before_(before), now_(now), difference_(difference(before, now.held)), options_(options) {}

  MovedReport report() {
    report_.statistic = difference_.statistic;
    report_.degrees_of_freedom = difference_.rank;
    if (difference_.rank > 0) {
      report_.p_value = chi_square_tail(difference_.statistic, difference_.rank);
      needed_ = needed_noncentrality();
    }
    for (std::size_t c = 0; c < match_.names.size(); ++c) describe(c);
    if (report_.p_value < options_.significance) {
      report_.outcome = MovedOutcome::kMoved;
      difference_ = difference(before_, now_.free);
      name_who_moved();
    } else {
      const bool all = std::all_of(report_.cameras.begin(), report_.cameras.end(),
                                   [](const CameraShift& c) { return c.verdict == MovedVerdict::kStands; });
      report_.outcome = all ? MovedOutcome::kNothingMoved : MovedOutcome::kCannotTell;
    }
    const std::vector<std::string> open = difference_.rank > 0 ? open_motions() : std::vector<std::string>();
    if (!open.empty() && match_.names.size() > 1) report_.notes.push_back(Finding("moved.open_motions").along(open));
    return std::move(report_);
  }

 private:
  Eigen::MatrixXd columns_of(const std::vector<std::size_t>& cameras) const {
    Eigen::MatrixXd E =
        Eigen::MatrixXd::Zero(difference_.information.rows(), 6 * static_cast<Eigen::Index>(cameras.size()));
    for (std::size_t i = 0; i < cameras.size(); ++i)
      E.block<6, 6>(6 * static_cast<Eigen::Index>(cameras[i]), 6 * static_cast<Eigen::Index>(i)).setIdentity();
    return E;
  }

  Hypothesis cameras_moved(const std::vector<std::size_t>& cameras) const {
    Hypothesis hypothesis{cameras, false, columns_of(cameras), {}};
    hypothesis.explanation = moved::explain(difference_, hypothesis.E);
    return hypothesis;
  }

  Hypothesis rig_moved() const {
    Hypothesis hypothesis{{}, true, moved::rig_motion(before_.T_robot_camera), {}};
    for (std::size_t c = 0; c < match_.names.size(); ++c) hypothesis.cameras.push_back(c);
    hypothesis.explanation = moved::explain(difference_, hypothesis.E);
    return hypothesis;
  }

  double rest_of(const Hypothesis& hypothesis) const {
    return std::max(0.0, difference_.statistic - hypothesis.explanation.reduction);
  }

  // That noise leaves as much unexplained.
  double plausibility(const Hypothesis& hypothesis) const {
    const int dof = difference_.rank - hypothesis.explanation.rank;
    return dof > 0 ? chi_square_tail(rest_of(hypothesis), dof) : 1.0;
  }

  bool explains(const Hypothesis& hypothesis) const { return plausibility(hypothesis) >= options_.significance; }

  // Noncentrality with which the test rejects with probability kPower.
  double needed_noncentrality() const {
    const double dof = difference_.rank, threshold = chi_square_quantile(1.0 - options_.significance, dof);
    double low = 0.0, high = 10.0;
    while (noncentral_chi_square_tail(threshold, dof, high) < kPower) high *= 2.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (noncentral_chi_square_tail(threshold, dof, middle) < kPower ? low : high) = middle;
    }
    return high;
  }

  // The length of a shift along the worst combination of the three columns.
  double detectable(const Eigen::MatrixXd& E) const {
    const Eigen::MatrixXd A = E.transpose() * difference_.information * E;
    const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues()[0];
    constexpr double kNothing = 1e-6;
    return least > kNothing ? std::sqrt(needed_ / least) : std::numeric_limits<double>::infinity();
  }

  // A camera by itself, all others standing.
  void describe(std::size_t c) {
    CameraShift camera;
    camera.camera = match_.names[c];
    const Hypothesis alone = cameras_moved({c});
    camera.detectable_shift_m = detectable(alone.E.leftCols<3>());
    camera.detectable_turn_rad = detectable(alone.E.rightCols<3>());
    if (alone.explanation.rank > 0)
      camera.p_value = chi_square_tail(alone.explanation.reduction, alone.explanation.rank);
    set_shift(alone.explanation, 0, &camera);
    const bool would_show = camera.detectable_shift_m <= options_.smallest_shift_m &&
                            camera.detectable_turn_rad <= options_.smallest_turn_rad;
    camera.verdict = would_show ? MovedVerdict::kStands : MovedVerdict::kCannotTell;
    report_.cameras.push_back(std::move(camera));
  }

  static void set_shift(const moved::Explanation& explanation, Eigen::Index row, CameraShift* camera) {
    constexpr double kShare = 1e-3;  // of an undetermined direction
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      const std::size_t i = static_cast<std::size_t>(axis);
      camera->shift[i].reset();
      camera->sigma[i].reset();
      if (explanation.undetermined.cols() > 0 &&
          explanation.undetermined.row(row + axis).cwiseAbs().maxCoeff() > kShare)
        continue;
      camera->shift[i] = explanation.shift[row + axis];
      camera->sigma[i] = std::sqrt(explanation.covariance(row + axis, row + axis));
    }
  }

  // One camera, or the rig as one body; else camera after camera until the rest is noise.
  void name_who_moved() {
    std::vector<Hypothesis> single;
    for (std::size_t c = 0; c < match_.names.size(); ++c) single.push_back(cameras_moved({c}));
    if (match_.names.size() > 1) single.push_back(rig_moved());
    const auto less_left = [this](const Hypothesis& a, const Hypothesis& b) { return rest_of(a) < rest_of(b); };
    const Hypothesis best = *std::min_element(single.begin(), single.end(), less_left);
    if (explains(best)) return accuse(single, best);
    accuse(several_cameras(best.rig ? std::vector<std::size_t>() : best.cameras));
  }

  Hypothesis several_cameras(std::vector<std::size_t> cameras) const {
    Hypothesis hypothesis;
    while (cameras.size() < match_.names.size() && (hypothesis.cameras.empty() || !explains(hypothesis))) {
      std::optional<Hypothesis> best;
      for (std::size_t c = 0; c < match_.names.size(); ++c) {
        if (std::find(cameras.begin(), cameras.end(), c) != cameras.end()) continue;
        std::vector<std::size_t> more = cameras;
        more.push_back(c);
        Hypothesis trial = cameras_moved(more);
        if (!best || rest_of(trial) < rest_of(*best)) best = std::move(trial);
      }
      hypothesis = std::move(*best);
      cameras = hypothesis.cameras;
    }
    return hypothesis;
  }

  void accuse(const Hypothesis& guilty) {
    for (std::size_t i = 0; i < guilty.cameras.size(); ++i) {
      CameraShift& camera = report_.cameras[guilty.cameras[i]];
      camera.verdict = MovedVerdict::kMoved;
      if (!guilty.rig) set_shift(guilty.explanation, 6 * static_cast<Eigen::Index>(i), &camera);
    }
  }

  // All that explain it, and not a hundred times worse than the best.
  void accuse(const std::vector<Hypothesis>& hypotheses, const Hypothesis& best) {
    const double margin = 2.0 * std::log(100.0);
    std::vector<const Hypothesis*> suspects;
    for (const Hypothesis& hypothesis : hypotheses)
      if (explains(hypothesis) && rest_of(hypothesis) < rest_of(best) + margin) suspects.push_back(&hypothesis);
    if (suspects.size() <= 1) {
      report_.rig_moved = best.rig;
      if (best.rig) report_.reasons.emplace_back("moved.rig");
      return accuse(best);
    }
    Finding ambiguous("moved.ambiguous");
    for (const Hypothesis* suspect : suspects) {
      if (suspect->rig) {
        ambiguous.values.emplace_back("with_rig", 1);
        continue;
      }
      ambiguous.cameras.push_back(match_.names[suspect->cameras.front()]);
      report_.cameras[suspect->cameras.front()].verdict = MovedVerdict::kSuspect;
    }
    report_.reasons.push_back(ambiguous);
  }

  // What the rig as one body could do unnoticed.
  std::vector<std::string> open_motions() const {
    static const std::array<const char*, 6> kMotions = {"x", "y", "z", "roll", "pitch", "yaw"};
    const Eigen::MatrixXd E = moved::rig_motion(before_.T_robot_camera);
    std::vector<std::string> open;
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      const double limit = axis < 3 ? options_.smallest_shift_m : options_.smallest_turn_rad;
      if (!(detectable(E.col(axis)) <= limit)) open.emplace_back(kMotions[static_cast<std::size_t>(axis)]);
    }
    return open;
  }

  const moved::Match& match_;
  const moved::KnownPoses& before_;
  const moved::NewKnowledge& now_;
  moved::Difference difference_;
  const MovedOptions& options_;
  double needed_ = 0.0;
  MovedReport report_;
};

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
    report = Detective(match, before, now, options).report();
  }
  for (const std::string& name : match.unseen) add_unseen(name, &report);
  report.notes.insert(report.notes.begin(), notes.begin(), notes.end());
  report.reasons.insert(report.reasons.begin(), reasons.begin(), reasons.end());
  return report;
}

}  // namespace rigproof
