#include "rigproof/validate/explanation.h"

#include <algorithm>
#include <array>
#include <cmath>

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

FindingValue offset(int axis, double value) {
  static constexpr std::array<const char*, 6> kNames = {"x_cm", "y_cm", "z_cm", "roll_deg", "pitch_deg", "yaw_deg"};
  return {kNames[static_cast<std::size_t>(axis)], in_unit(value, axis)};
}

double mean_error(const Comparison& comparison, int axis) {
  double sum = 0.0;
  for (const TransformError& error : comparison.camera_to_robot) sum += error.error[axis];
  return sum / static_cast<double>(comparison.camera_to_robot.size());
}

// What odometry and ground leave open is in the bound; a shared error far beyond it is of the method's own making.
std::optional<double> deviations_beyond_bound(const Comparison& comparison, int axis) {
  constexpr double kDeviations = 4.0;
  const std::optional<double>& sigma = comparison.bound->camera_to_robot[static_cast<std::size_t>(axis)];
  const double size = std::abs(mean_error(comparison, axis));
  return sigma && size > kDeviations * *sigma ? std::optional(size / *sigma) : std::nullopt;
}

bool failed(const Failures& failures, const std::string& subject, int axis) {
  return std::any_of(failures.gate.checks.begin(), failures.gate.checks.end(), [&](const Check& check) {
    return !check.passed && check.axis == axis && (subject.empty() ? !check.between_cameras : check.subject == subject);
  });
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
      const Finding cause("errors.one_axis", {offset(axis, failures.camera(i).error[axis])});
      best = Explanation{cause.of(failures.camera(i).child), axis};
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
    return Explanation{
        Finding("errors.shared_axis", source_of_shared(failures.comparison, {axis})).with({offset(axis, value)}), axis};
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
  return Explanation{
      Finding("errors.scale", {{"off_percent", std::abs(percent)}, {"side", percent > 0.0 ? "long" : "short"}})};
}

std::optional<Explanation> one_camera(const Failures& failures) {
  if (failures.count() < 2) return std::nullopt;  // a single camera is always its own cause
  for (std::size_t i = 0; i < failures.count(); ++i) {
    Poses corrected = estimates_of(failures.comparison);
    corrected[i] = failures.camera(i).T_true;
    if (!failures.are_cured_by(corrected)) continue;
    FindingValues off;
    for (int axis = 0; axis < 6; ++axis)
      if (failed(failures, failures.camera(i).name(), axis))
        off.push_back(offset(axis, failures.camera(i).error[axis]));
    return Explanation{Finding("errors.one_camera", off).of(failures.camera(i).child)};
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
  FindingValues off;
  std::vector<int> axes;
  for (int axis = 0; axis < 6; ++axis) {
    if (!failed(failures, "", axis)) continue;
    off.push_back(offset(axis, mean_error(failures.comparison, axis)));
    axes.push_back(axis);
  }
  return Explanation{Finding("errors.shared_motion", source_of_shared(failures.comparison, axes)).with(off)};
}

}  // namespace

// What all cameras share comes from the odometry along x, y and about z, and from the ground in the other three.
FindingValues source_of_shared(const Comparison& comparison, const std::vector<int>& axes) {
  if (!comparison.bound) return {};
  bool odometry = false, ground = false;
  for (const int axis : axes) {
    if (const auto deviations = deviations_beyond_bound(comparison, axis)) return {{"deviations", *deviations}};
    (axis == 0 || axis == 1 || axis == 5 ? odometry : ground) = true;
  }
  return {{"source", odometry && ground ? "odometry and ground" : ground ? "ground" : "odometry"}};
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
