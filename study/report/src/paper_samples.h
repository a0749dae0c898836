// Errors of a method from a sweep's rows, success before any error.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/study/sweep/rows.h"
#include "rigproof/validate/published.h"

namespace rigproof::paper {

/// tx ty tz [cm], roll pitch yaw [deg], as the paper reads rotations.
AxisFigures paper_error(const SweepRow& row);
/// Names of these.
inline constexpr std::array<const char*, 6> kPaperAxes = {"tx", "ty", "tz", "roll", "pitch", "yaw"};

/// "within 1 m and 20 deg".
std::string limits_in_words();

/// "camera to robot" or "camera to camera".
const char* subject_title(SweepSubject subject);

/// Throws Error where the paper has none.
const PublishedTable& published_table(SweepSubject subject, bool synthetic);
/// The row that a method of ours stands beside; null if there is none.
const PublishedRow* published_row(const PublishedTable& table, const std::string& method);

/// Which rows: labels by axis number.
using Condition = std::map<std::size_t, std::string>;
bool meets(const SweepRow& row, const Condition& condition);

/// Number of the axis of that name; absent if the sweep has none.
std::optional<std::size_t> axis_of(const SweepRows& rows, const std::string& name);

/// One condition for each level of the axis of that name, with the level's label; a single empty one if there is none.
struct NamedCondition {
  std::string label;
  Condition condition;
};
std::vector<NamedCondition> conditions_along(const SweepRows& rows, const std::string& name);

/// What a method answered under a condition. Errors are those of answers that are not far.
struct Sample {
  std::array<std::vector<double>, 6> values;   ///< signed, tasks and cameras in the rows' order
  std::vector<double> lengths_cm, angles_deg;  ///< norms of errors in all three axes
  int success = 0;  ///< tasks in which it stated for every camera all that it ever states, and none of it far
  int tasks = 0;
  int answers = 0, far = 0;        ///< cameras (pairs) of which it stated anything; those of them that are far off
  std::array<int, 6> stated = {};  ///< how many of all these state an axis

  /// Mean of the absolute value; absent without any.
  std::optional<double> mean_absolute(std::size_t axis) const;
};
Sample sample_of(const SweepRows& rows, const Condition& condition, const std::string& method, SweepSubject subject);

std::optional<double> mean(const std::vector<double>& values);
/// With n - 1; absent for fewer than two.
std::optional<double> deviation(const std::vector<double>& values);
std::vector<double> absolute(std::vector<double> values);

/// The same sweep with every pair's error relative to that of one method in the same task, as if there were no truth.
/// Pairs without an answer of that method are left out, and so is the method itself.
SweepRows against_method(const SweepRows& rows, const std::string& method);

}  // namespace rigproof::paper
