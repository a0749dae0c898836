#include <algorithm>
#include <cmath>
#include <map>

#include "rigproof/core/conventions.h"
#include "rigproof/core/figures.h"
#include "rigproof/core/text.h"
#include "rigproof/validate/body_angles.h"
#include "rigproof/validate/format.h"
#include "rigproof/validate/statistics.h"
#include "rigproof/validate/validate.h"
#include "said.h"

namespace rigproof {
namespace {

std::string words_for(double nees, const Interval& interval) {
  if (nees > interval.high) return "sigmas too small";
  return nees < interval.low ? "sigmas too large" : "sigmas honest";
}

std::string interval_text(const Interval& interval) {
  return " (95 %: " + figure(interval.low, 1) + "-" + figure(interval.high, 1) + ")";
}

std::string nees_of_cameras(const Comparison& comparison) {
  std::string values;
  for (const CameraNees& camera : comparison.camera_nees)
    values += (values.empty() ? "" : ", ") + camera.camera + " " + figure(camera.nees, 1);
  return values;
}

struct JudgedNees {
  double value = 0.0;
  Interval interval;
};

// Of all cameras together; or else of the camera that is too high, or of the lowest.
std::optional<JudgedNees> judged_nees(const Comparison& comparison) {
  if (comparison.nees) return JudgedNees{*comparison.nees, chi_square_interval(comparison.nees_degrees_of_freedom)};
  if (comparison.camera_nees.empty()) return std::nullopt;
  const auto less = [](const CameraNees& a, const CameraNees& b) { return a.nees < b.nees; };
  const auto [lowest, highest] =
      std::minmax_element(comparison.camera_nees.begin(), comparison.camera_nees.end(), less);
  const Interval interval = chi_square_interval(6.0);
  return JudgedNees{highest->nees > interval.high ? highest->nees : lowest->nees, interval};
}

struct FailedSubject {
  std::string name;
  bool between_cameras = false;
  std::vector<int> axes;
  bool suspected = false;
};

std::vector<FailedSubject> failed_subjects(const Gate& gate) {
  std::vector<FailedSubject> subjects;
  for (const Check& check : gate.checks) {
    if (check.passed) continue;
    const auto same = [&check](const FailedSubject& subject) { return subject.name == check.subject; };
    auto subject = std::find_if(subjects.begin(), subjects.end(), same);
    if (subject == subjects.end())
      subject = subjects.insert(subjects.end(), FailedSubject{check.subject, false, {}, false});
    subject->between_cameras = check.between_cameras;
    subject->suspected |= check.reason && check.reason->severity == Severity::kSuspect;
    if (check.axis >= 0 && std::find(subject->axes.begin(), subject->axes.end(), check.axis) == subject->axes.end())
      subject->axes.push_back(check.axis);
  }
  return subjects;
}

std::string short_name(const std::string& subject) {
  const std::string suffix = " in robot";
  const bool ends =
      subject.size() > suffix.size() && subject.compare(subject.size() - suffix.size(), suffix.size(), suffix) == 0;
  return ends ? subject.substr(0, subject.size() - suffix.size()) : subject;
}

std::string axis_names(const std::vector<int>& axes) {
  std::vector<std::string> names;
  for (const int axis : axes) names.push_back(kDegreeOfFreedomNames[static_cast<std::size_t>(axis)]);
  return joined(names, " ");
}

// "tx tz, suspected".
std::string what_of(const FailedSubject& failed) {
  if (failed.axes.empty()) return failed.suspected ? "suspected" : "not answered";
  return axis_names(failed.axes) + (failed.suspected ? ", suspected" : "");
}

// The axes of a pair are those of a camera, which nobody has in mind: translations that point along one axis of the
// robot to within 25 degrees are told as that.
std::string direction_word(const Comparison& comparison, const FailedSubject& failed) {
  const auto pair = std::find_if(comparison.camera_to_camera.begin(), comparison.camera_to_camera.end(),
                                 [&](const TransformError& error) { return error.name() == failed.name; });
  const auto parent = std::find_if(comparison.camera_to_robot.begin(), comparison.camera_to_robot.end(),
                                   [&](const TransformError& error) { return error.child == pair->parent; });
  const bool translations = std::all_of(failed.axes.begin(), failed.axes.end(), [](int axis) { return axis < 3; });
  if (!translations || parent == comparison.camera_to_robot.end()) return axis_names(failed.axes);
  const Eigen::Vector3d in_robot = parent->T_true.rotation * pair->error.head<3>();
  static constexpr const char* kWords[3] = {"lengthwise", "sideways", "vertical"};
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(in_robot[axis]) > 0.9 * in_robot.norm()) return kWords[axis];
  return axis_names(failed.axes);
}

// What failed, camera by camera, then pair by pair: "right tz; left-right, center-right vertical".
std::string what_failed(const Comparison& comparison, const Gate& gate) {
  std::map<std::string, std::vector<std::string>> pairs_by_word;
  std::vector<std::string> words, parts;
  for (const FailedSubject& failed : failed_subjects(gate)) {
    if (!failed.between_cameras) {
      parts.push_back(short_name(failed.name) + " " + what_of(failed));
      continue;
    }
    const std::string word = direction_word(comparison, failed);
    if (pairs_by_word[word].empty()) words.push_back(word);
    pairs_by_word[word].push_back(failed.name);
  }
  for (const std::string& word : words) parts.push_back(joined(pairs_by_word[word]) + " " + word);
  return joined(parts, "; ");
}

std::string explanation_line(const Comparison& comparison, const Budget& budget, const Wording& wording) {
  const std::optional<Explanation> explanation = explain_failures(comparison, budget);
  if (!explanation) return "";
  const std::string count = explanation->explained > 1 ? " explains " + all_of_them(explanation->explained) : "";
  return "  One cause" + count + ": " + said(explanation->cause, wording) + ".\n";
}

std::string notes_of(const Gate& gate, const Wording& wording) {
  std::string text;
  for (const Finding& note : gate.notes) text += "  " + said(note, wording) + "\n";
  return text;
}

}  // namespace

std::string format_nees(const Comparison& comparison) {
  const std::optional<JudgedNees> judged = judged_nees(comparison);
  if (!judged) return "";
  return words_for(judged->value, judged->interval) + ": NEES " +
         (comparison.nees ? figure(judged->value, 1) : "of each camera " + nees_of_cameras(comparison)) +
         interval_text(judged->interval);
}

bool are_sigmas_too_small(const Comparison& comparison) {
  const std::optional<JudgedNees> judged = judged_nees(comparison);
  return judged && judged->value > judged->interval.high;
}

std::string format_verdict(const Comparison& comparison, const Gate& gate, const Budget& budget,
                           const Wording& wording) {
  const std::string nees = format_nees(comparison);
  const std::string honesty = nees.empty() ? "" : "; " + nees;
  const std::size_t count = gate.checks.size(), failures = gate.failures();
  if (count == 0)
    return "NOT JUDGED  nothing could be checked against the budget (" + describe(budget) + ")\n" +
           notes_of(gate, wording);
  if (failures == 0)
    return "PASS  " + std::to_string(count) + "/" + std::to_string(count) + " within " + describe(budget) + honesty +
           "\n";
  return "FAIL  " + std::to_string(failures) + "/" + std::to_string(count) +
         " checks: " + what_failed(comparison, gate) + "\n" + explanation_line(comparison, budget, wording) +
         (nees.empty() ? "" : "  " + nees + "\n");
}

std::string format_same_run(const Comparison& comparison, const Budget& budget,
                            const std::vector<Comparison>& same_run) {
  const std::optional<Explanation> found = explain_failures(comparison, budget);
  if (!found || !found->cause.is("errors.one_axis")) return "";
  const double factor = found->axis < 3 ? 100.0 : rad_to_deg(1.0);
  const std::string unit = found->axis < 3 ? " cm" : " deg";
  std::vector<std::string> others;
  std::optional<std::pair<double, std::string>> least_sigma;
  for (const Comparison& other : same_run) {
    if (other.method == comparison.method) continue;
    for (const TransformError& error : other.camera_to_robot) {
      if (error.child != found->cause.cameras.front() || !error.observable[static_cast<std::size_t>(found->axis)])
        continue;
      const double value = factor * error.error[found->axis];
      others.push_back(other.method + " " + signed_figure(value, decimals_for(value, 2)));
      if (!error.z(found->axis)) continue;
      const double sigma = factor * (*error.sigma)[found->axis];
      if (!least_sigma || sigma < least_sigma->first) least_sigma = {sigma, other.method};
    }
  }
  if (others.empty()) return "";
  const std::string allowed = least_sigma ? "The data allow " + short_figure(least_sigma->first) + unit +
                                                " (1 sigma of " + least_sigma->second + "). "
                                          : "";
  return "  " + allowed + "Same run: " + joined(others) + unit + ".\n";
}

std::string format_suspicion(const Comparison& comparison, const Wording& wording) {
  if (!comparison.suspicion) return "";
  const ConventionSuspicion& s = *comparison.suspicion;
  const auto amount = [](double metres, double radians) {
    return short_figure(100.0 * metres) + " cm, " + short_figure(rad_to_deg(radians)) + " deg";
  };
  return "CONVENTION  " + said(s.convention, wording) +
         ".\n  Worst camera as given: " + amount(s.error_now_m, s.error_now_rad) +
         "; corrected: " + amount(s.error_if_corrected_m, s.error_if_corrected_rad) + ".\n";
}

std::string format_validation(const Comparison& comparison, const Gate& gate, const Budget& budget,
                              const std::string& subject, const Wording& wording) {
  const std::string named = budget.name.empty() ? "" : ", budget " + budget.name + " (" + describe(budget) + ")";
  const std::string head = subject.empty() ? "" : subject + " against truth" + named + "\n";
  const bool mark_rows = !budget.name.empty() || gate.failures() > 0;
  const std::string verdict = format_verdict(comparison, gate, budget, wording);
  const std::string errors = format_errors(comparison, mark_rows ? &gate : nullptr, wording);
  // The verdict first; where there is nothing to judge, the reason for that.
  return head + (gate.checks.empty() ? errors + format_suspicion(comparison, wording) + verdict
                                     : verdict + format_suspicion(comparison, wording) + errors);
}

}  // namespace rigproof
