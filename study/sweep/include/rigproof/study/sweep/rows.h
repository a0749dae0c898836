// What a sweep measured: one row for each (task, method, camera), and the summary of them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "rigproof/core/finding.h"

namespace rigproof {

/// tx ty tz in centimetres, rx ry rz in degrees; absent where there is no figure.
using AxisFigures = std::array<std::optional<double>, 6>;
/// Length of three of them, from `first` on; absent where one is.
std::optional<double> length_of(const AxisFigures& figures, std::size_t first);

enum class SweepStatus {
  kSolved,       ///< all six degrees of freedom
  kPartial,      ///< some of them
  kNotGiven,     ///< the method answered, but says nothing about this camera or pair
  kRefused,      ///< the method ran and says that the data cannot answer
  kCouldNotRun,  ///< told before running: the method needs what this recording has not
  kFailed,       ///< it crashed, ran too long, wrote garbage, or there was nothing to calibrate from
};
const char* sweep_status_name(SweepStatus status);

/// What a row is about. Count tasks by rows of the rig: each (task, method) has exactly one, whatever its outcome.
enum class SweepSubject { kRig, kCamera, kPair };
const char* sweep_subject_name(SweepSubject subject);

/// Of the first finding (docs/reference/findings.md); empty where there is none. Of what an older folder has in words
/// alone, the code that stands beside them.
std::string code_of(const std::vector<Finding>& reasons);

/// One row of rows.csv. Depends on the configuration and the program alone: no times.
struct SweepRow {
  std::string task;                 ///< key of the task, 16 hexadecimal digits
  std::vector<std::string> levels;  ///< label of the task's point on every axis
  std::int64_t seed = 0;
  std::string method;
  SweepSubject subject = SweepSubject::kRig;
  std::string camera;  ///< "left", "left-center" (parent-child); "all" for the rig
  SweepStatus status = SweepStatus::kFailed;
  std::vector<Finding> reasons;  ///< why it is not solved
  AxisFigures error;             ///< chart of transform_error(): estimate minus truth, along the parent's axes
  AxisFigures sigma;             ///< stated standard deviation
  AxisFigures bound;             ///< Cramer-Rao bound of these data at the truth, one standard deviation
  /// Difference of roll, pitch and yaw of the camera's body axes in degrees, as the paper reads rotations.
  std::array<std::optional<double>, 3> roll_pitch_yaw;
  std::optional<double> nees;  ///< of this camera alone; of all cameras together for the rig
  int nees_degrees_of_freedom = 0;
  /// How often the camera saw the board at two stops in a row; of a pair the smaller number. Absent for the rig.
  std::optional<int> motions;

  /// error / sigma.
  std::optional<double> z(std::size_t axis) const;
};

/// An answer farther off than this is none, for any method: it counts against success, and no mean has it. A mean over
/// answers that are metres off says how far the worst one is, and nothing of the others.
inline constexpr double kFarCm = 100.0, kFarDeg = 20.0;
/// Whether what the row states, as far as it states it, is that far off in translation or rotation.
bool is_far(const SweepRow& row);
/// "1 m or 20 deg".
std::string far_limits_in_words();

/// Where an answer was made.
struct SweepMachine {
  std::string host, cpu;
  std::string gl_renderer;  ///< that drew its pictures; empty without pictures

  bool operator<(const SweepMachine& other) const {
    return std::tie(host, cpu, gl_renderer) < std::tie(other.host, other.cpu, other.gl_renderer);
  }
};

struct SweepMachineCount {
  SweepMachine machine;
  std::size_t answers = 0;
};
/// How many answers each GL driver drew the pictures of, by its name; none for those without pictures.
std::map<std::string, std::size_t> answers_by_renderer(const std::vector<SweepMachineCount>& machines);
/// Whether pictures were drawn by more than one GL driver: their answers differ in more than the last digits.
bool has_mixed_renderers(const std::vector<SweepMachineCount>& machines);

/// One point of the axes with one seed.
struct SweepTask {
  std::string key;                  ///< 16 hexadecimal digits: hash of all that its observations depend on
  std::vector<std::size_t> levels;  ///< one an axis
  std::int64_t seed = 0;            ///< as SweepConfig::seeds has it
  std::string pictures;             ///< key of its PictureSet; empty in geometric mode
};

/// All rows of a sweep, in the order of tasks, methods and cameras.
struct SweepRows {
  std::string name;
  std::vector<std::string> axes;                 ///< names, in the order of SweepRow::levels
  std::vector<std::string> axis_titles;          ///< for people and figures: "odometry noise lambda"
  std::vector<bool> pooled;                      ///< one an axis: the summary takes its levels as repetitions
  std::vector<std::vector<std::string>> levels;  ///< labels of each axis, in the configuration's order
  /// Number of each level where it is one (for the x axis of a figure), else its place 0, 1, ..
  std::vector<std::vector<double>> level_values;
  std::vector<std::string> methods;
  std::string reference;                         ///< method that the others are tested against
  std::vector<SweepTask> tasks;                  ///< done or not
  std::vector<SweepRow> rows;                    ///< of what is done
  std::vector<SweepMachineCount> machines = {};  ///< that did it
};

/// Reads what stands in a sweep's folder (finished or not). Throws Error.
SweepRows load_sweep_rows(const std::filesystem::path& folder);

/// Figures of one sample of errors. Cells that hold no value are absent.
struct SampleFigures {
  int count = 0;  ///< values: (task, camera) pairs
  std::optional<double> mean;
  std::optional<double> mean_absolute;
  std::optional<double> deviation;           ///< standard deviation of the signed error, with n - 1
  std::optional<double> deviation_absolute;  ///< of its absolute value
  /// Of the absolute error, at probabilities .05 .25 .5 .75 .95, interpolated between order statistics.
  std::array<std::optional<double>, 5> quantiles;
  std::optional<double> largest;  ///< absolute
  std::optional<double> rmse;
  std::optional<double> rmse_over_bound;  ///< root of sum e^2 over sum of squared bounds
};

/// A method against the reference on the tasks that both solved; a task counts once, by its cameras' mean |error|.
struct PairedTest {
  int count = 0;                       ///< tasks
  std::optional<double> difference;    ///< mean of |error| minus that of the reference; negative = better than it
  std::optional<double> interval_low;  ///< 95 % of a paired bootstrap over tasks, percentile
  std::optional<double> interval_high;
  std::optional<double> p;       ///< Wilcoxon's signed-rank test, two-sided; exact up to 50 tasks
  std::optional<double> p_holm;  ///< Holm's correction over tx .. rz of a point, method and subject; else absent
};

enum class SummaryAxis { kTx, kTy, kTz, kRx, kRy, kRz, kRoll, kPitch, kYaw, kTranslation, kRotation };
const char* summary_axis_name(SummaryAxis axis);
/// "cm" or "deg".
const char* summary_axis_unit(SummaryAxis axis);

/// One line of summary.csv: a point of the axes that are not pooled, a method, cameras or pairs, and one axis.
struct SummaryRow {
  std::vector<std::string> levels;  ///< of every axis; "all" for one that is pooled
  std::string method;
  SweepSubject subject = SweepSubject::kCamera;  ///< kCamera or kPair
  SummaryAxis axis = SummaryAxis::kTx;
  int tasks = 0;  ///< that were to be done; the following five are of these
  int solved = 0, partial = 0, refused = 0, could_not_run = 0, failed = 0;
  int missing = 0;            ///< not done yet
  int answered = 0;           ///< tasks in which this axis was given for every camera (or pair), none of them far off
  int far = 0;                ///< cameras (or pairs) with this axis that are far off: is_far()
  double success_rate = 0.0;  ///< answered / tasks
  SampleFigures all;          ///< over everything this method answered that is not far off
  SampleFigures common;       ///< over the tasks that were answered by every method that answers this axis here at all
  PairedTest against_reference;
};

/// Why a method did not solve tasks, and how many. Tasks whose first finding is the same are counted together.
struct FailureCount {
  std::string method;
  SweepStatus status = SweepStatus::kFailed;
  std::vector<Finding> reasons;  ///< of the first such task
  int tasks = 0;
};

/// Counts what is not solved by (method, status, code).
class FailureCounter {
 public:
  void add(const std::string& method, SweepStatus status, const std::vector<Finding>& reasons);
  /// The most frequent first.
  std::vector<FailureCount> counts() const;

 private:
  std::map<std::tuple<std::string, SweepStatus, std::string>, FailureCount> counts_;
};
std::vector<FailureCount> count_failures(const std::vector<SweepRow>& rows);

struct SweepSummary {
  std::string name;
  std::vector<std::string> axes;
  std::vector<std::string> methods;
  std::string reference;
  std::vector<SummaryRow> rows;
  std::vector<FailureCount> failures;  ///< the most frequent first
};

SweepSummary summarise(const SweepRows& rows);
/// The same with the rows of a task and method read when they are needed, those of one point at a time; without
/// failures.
SweepSummary summarise(const SweepRows& table,
                       const std::function<std::vector<SweepRow>(std::size_t task, std::size_t method)>& rows_of);

/// The table of a terminal: success rate first, then mean |error| per axis.
std::string format_summary(const SweepSummary& summary);
/// The same for summary.md.
std::string summary_as_markdown(const SweepSummary& summary);
std::string summary_as_csv(const SweepSummary& summary);
std::string summary_as_json(const SweepSummary& summary);

}  // namespace rigproof
