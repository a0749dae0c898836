#include "rigproof/validate/explanation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigproof/core/figures.h"

namespace rigproof {
namespace {

using Poses = std::vector<Rigid3>;

Poses estimates_of(const Comparison& comparison) {
  Poses poses;
  for (const TransformError& error : comparison.camera_to_robot) poses.push_back(error.T_estimate);
  return poses;
}

void set_estimate(const Rigid3& T, TransformError* error) {
  error->T_estimate = T;
  error->error = transform_error(T, error->T_true);
}

// The comparison if the cameras stood at `corrected`; statements between cameras follow their cameras.
Comparison with_poses(const Comparison& comparison, const Poses& corrected) {
  Comparison changed = comparison;
  const Poses before = estimates_of(comparison);
  const auto index_of = [&](const std::string& camera) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < before.size(); ++i)
      if (comparison.camera_to_robot[i].child == camera) return i;
    return std::nullopt;
  };
  for (std::size_t i = 0; i < corrected.size(); ++i) set_estimate(corrected[i], &changed.camera_to_robot[i]);
  for (TransformError& pair : changed.camera_to_camera) {
    Rigid3 T = pair.T_estimate;
    if (const auto j = index_of(pair.parent)) T = corrected[*j].inverse() * before[*j] * T;
    if (const auto k = index_of(pair.child)) T = T * before[*k].inverse() * corrected[*k];
    set_estimate(T, &pair);
  }
  return changed;
}

struct Failures {
  const Comparison& comparison;
  const Budget& budget;
  Gate gate;

  std::size_t count() const { return comparison.camera_to_robot.size(); }
  const TransformError& camera(std::size_t i) const { return comparison.camera_to_robot[i]; }
  bool are_cured_by(const Poses& corrected) const {
    return apply_budget(with_poses(comparison, corrected), budget).failures() == 0;
  }
};

// "0.62 cm too high".
std::string axis_in_words(int axis, double value) {
  static constexpr const char* kWords[6][2] = {{"too far back", "too far forward"},
                                               {"too far right", "too far left"},
                                               {"too low", "too high"},
                                               {"rolled too far left", "rolled too far right"},
                                               {"pitched too far up", "pitched too far down"},
                                               {"turned too far right", "turned too far left"}};
  const std::string word = kWords[axis][value > 0.0 ? 1 : 0];
  // A leading zero here: this is a sentence, not a table.
  std::string number = short_figure(std::abs(in_unit(value, axis)));
  if (number[0] == '.') number = "0" + number;
  return number + (axis < 3 ? " cm " : " deg ") + word;
}

double mean_error(const Comparison& comparison, int axis) {
  double sum = 0.0;
  for (const TransformError& error : comparison.camera_to_robot) sum += error.error[axis];
  return sum / static_cast<double>(comparison.camera_to_robot.size());
}

// What odometry and ground leave open is in the bound; a shared error far beyond it is of the method's own making.
bool is_beyond_bound(const Comparison& comparison, int axis) {
  constexpr double kDeviations = 4.0;
  const std::optional<double>& sigma = comparison.bound->camera_to_robot[static_cast<std::size_t>(axis)];
  return sigma && std::abs(mean_error(comparison, axis)) > kDeviations * *sigma;
}

bool failed(const Failures& failures, const std::string& subject, int axis) {
  return std::any_of(failures.gate.checks.begin(), failures.gate.checks.end(), [&](const Check& check) {
    return !check.passed && check.axis == axis && (subject.empty() ? !check.between_cameras : check.subject == subject);
  });
}

// Those that are finite.
std::string describe_axes(const Vector6d& error) {
  std::string text;
  for (int axis = 0; axis < 6; ++axis)
    if (std::isfinite(error[axis])) text += (text.empty() ? "" : ", ") + axis_in_words(axis, error[axis]);
  return text;
}

std::optional<Explanation> one_axis(const Failures& failures) {
  std::optional<Explanation> best;
  double best_size = 0.0;
  for (std::size_t i = 0; i < failures.count(); ++i) {
    for (int axis = 0; axis < 6; ++axis) {
      Poses corrected = estimates_of(failures.comparison);
      Vector6d error = failures.camera(i).error;
      error[axis] = 0.0;
      corrected[i] = apply_transform_error(failures.camera(i).T_true, error);
      // Where two axes would do, the one that fails by more of its error is the cause.
      const double size =
          std::abs(failures.camera(i).error[axis]) * (failed(failures, failures.camera(i).name(), axis) ? 1e3 : 1.0);
      if (size <= best_size || !failures.are_cured_by(corrected)) continue;
      best_size = size;
      best = Explanation{Explanation::Kind::kOneAxis, failures.camera(i).child, axis, failures.camera(i).error[axis],
                         failures.camera(i).child + " is " + axis_in_words(axis, failures.camera(i).error[axis])};
    }
  }
  return best;
}

std::optional<Explanation> shared_axis(const Failures& failures) {
  if (failures.count() < 2) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    const double value = mean_error(failures.comparison, axis);
    Poses corrected = estimates_of(failures.comparison);
    for (Rigid3& T : corrected) T.translation[axis] -= value;
    if (!failures.are_cured_by(corrected)) continue;
    return Explanation{Explanation::Kind::kSharedAxis, "", axis, value,
                       "all cameras share this error" + source_of_shared(failures.comparison, {axis}) + ": they are " +
                           axis_in_words(axis, value)};
  }
  return std::nullopt;
}

std::optional<Explanation> scale(const Failures& failures) {
  double product = 0.0, squares = 0.0;
  for (const TransformError& error : failures.comparison.camera_to_robot) {
    product += error.T_estimate.translation.dot(error.T_true.translation);
    squares += error.T_true.translation.squaredNorm();
  }
  if (failures.count() < 2 || !(product > 0.0)) return std::nullopt;
  const double factor = product / squares;
  Poses corrected = estimates_of(failures.comparison);
  for (Rigid3& T : corrected) T.translation /= factor;
  if (!failures.are_cured_by(corrected)) return std::nullopt;
  const double percent = 100.0 * (factor - 1.0);
  return Explanation{Explanation::Kind::kScale, "", -1, factor - 1.0,
                     "all distances are " + short_figure(std::abs(percent)) + " % too " +
                         (percent > 0.0 ? "long" : "short") + " (board size, odometry scale or unit)"};
}

std::optional<Explanation> one_camera(const Failures& failures) {
  if (failures.count() < 2) return std::nullopt;  // a single camera is always its own cause
  for (std::size_t i = 0; i < failures.count(); ++i) {
    Poses corrected = estimates_of(failures.comparison);
    corrected[i] = failures.camera(i).T_true;
    if (!failures.are_cured_by(corrected)) continue;
    Vector6d shown = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
    for (int axis = 0; axis < 6; ++axis)
      if (failed(failures, failures.camera(i).name(), axis)) shown[axis] = failures.camera(i).error[axis];
    const std::string axes = describe_axes(shown);
    return Explanation{Explanation::Kind::kOneCamera, failures.camera(i).child, -1,
                       failures.camera(i).error.head<3>().norm(),
                       "only " + failures.camera(i).child + " is wrong" + (axes.empty() ? "" : ": " + axes)};
  }
  return std::nullopt;
}

std::optional<Explanation> shared_motion(const Failures& failures) {
  if (failures.count() < 2) return std::nullopt;
  Vector6d mean = Vector6d::Zero();
  for (const TransformError& error : failures.comparison.camera_to_robot)
    mean += se3_log(error.T_estimate * error.T_true.inverse()) / static_cast<double>(failures.count());
  const Rigid3 undo = se3_exp(-mean);
  Poses corrected = estimates_of(failures.comparison);
  for (Rigid3& T : corrected) T = undo * T;
  if (!failures.are_cured_by(corrected)) return std::nullopt;
  Vector6d shown = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  std::vector<int> axes;
  for (int axis = 0; axis < 6; ++axis) {
    if (!failed(failures, "", axis)) continue;
    shown[axis] = mean_error(failures.comparison, axis);
    axes.push_back(axis);
  }
  return Explanation{Explanation::Kind::kSharedMotion, "", -1, mean.head<3>().norm(),
                     "all cameras share this error" + source_of_shared(failures.comparison, axes) + ": they are " +
                         describe_axes(shown)};
}

}  // namespace

// What all cameras share comes from the odometry along x, y and about z, and from the ground in the other three.
std::string source_of_shared(const Comparison& comparison, const std::vector<int>& axes) {
  if (!comparison.bound) return "";
  bool odometry = false, ground = false;
  for (const int axis : axes) {
    if (is_beyond_bound(comparison, axis)) return ", far more than the data allow";
    (axis == 0 || axis == 1 || axis == 5 ? odometry : ground) = true;
  }
  return odometry && ground ? " (odometry and ground)" : ground ? " (ground)" : " (odometry)";
}

std::optional<Explanation> explain_failures(const Comparison& comparison, const Budget& budget) {
  const Failures failures{comparison, budget, apply_budget(comparison, budget)};
  if (failures.gate.failures() == 0) return std::nullopt;
  for (const Check& check : failures.gate.checks)
    if (!check.passed && check.reason) return std::nullopt;
  for (const auto& cause : {one_axis, shared_axis, scale, one_camera, shared_motion})
    if (std::optional<Explanation> found = cause(failures)) {
      found->explained = failures.gate.failures();
      return found;
    }
  return std::nullopt;
}

}  // namespace rigproof
