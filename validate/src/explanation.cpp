#include "rigproof/validate/explanation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigproof/core/conventions.h"
#include "rigproof/validate/figures.h"

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

class Search {
 public:
  Search(const Comparison& comparison, const Budget& budget)
      : comparison_(comparison), budget_(budget), gate_(apply_budget(comparison, budget)) {}

  std::optional<Explanation> run() const {
    if (gate_.failures() == 0) return std::nullopt;
    for (const Check& check : gate_.checks)
      if (!check.passed && check.reason) return std::nullopt;
    for (const auto step :
         {&Search::one_axis, &Search::shared_axis, &Search::scale, &Search::one_camera, &Search::shared_motion})
      if (auto found = (this->*step)()) {
        found->explained = gate_.failures();
        return found;
      }
    return std::nullopt;
  }

 private:
  std::size_t count() const { return comparison_.camera_to_robot.size(); }
  const TransformError& camera(std::size_t i) const { return comparison_.camera_to_robot[i]; }
  bool cures(const Poses& corrected) const {
    return apply_budget(with_poses(comparison_, corrected), budget_).failures() == 0;
  }
  double mean_error(int axis) const;
  // Axes that matter in words: of the given camera, or of the mean over all cameras.
  std::string describe_axes(const Vector6d& error) const;
  bool failed(const std::string& subject, int axis) const;

  std::optional<Explanation> one_axis() const;
  std::optional<Explanation> shared_axis() const;
  std::optional<Explanation> scale() const;
  std::optional<Explanation> one_camera() const;
  std::optional<Explanation> shared_motion() const;

  const Comparison& comparison_;
  const Budget& budget_;
  const Gate gate_;
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
  const double shown = axis < 3 ? 100.0 * value : rad_to_deg(value);
  // A leading zero here: this is a sentence, not a table.
  std::string number = short_figure(std::abs(shown));
  if (number[0] == '.') number = "0" + number;
  return number + (axis < 3 ? " cm " : " deg ") + word;
}

// What all cameras share comes from the odometry along x, y and about z, and from the ground in the other three.
std::string shared_source(const std::vector<int>& axes) {
  bool odometry = false, ground = false;
  for (const int axis : axes) (axis == 0 || axis == 1 || axis == 5 ? odometry : ground) = true;
  return odometry && ground ? "odometry and ground" : ground ? "ground" : "odometry";
}

double Search::mean_error(int axis) const {
  double sum = 0.0;
  for (const TransformError& error : comparison_.camera_to_robot) sum += error.error[axis];
  return sum / static_cast<double>(count());
}

bool Search::failed(const std::string& subject, int axis) const {
  return std::any_of(gate_.checks.begin(), gate_.checks.end(), [&](const Check& check) {
    return !check.passed && check.axis == axis && (subject.empty() ? !check.between_cameras : check.subject == subject);
  });
}

std::string Search::describe_axes(const Vector6d& error) const {
  std::string text;
  for (int axis = 0; axis < 6; ++axis)
    if (std::isfinite(error[axis])) text += (text.empty() ? "" : ", ") + axis_in_words(axis, error[axis]);
  return text;
}

std::optional<Explanation> Search::one_axis() const {
  std::optional<Explanation> best;
  double best_size = 0.0;
  for (std::size_t i = 0; i < count(); ++i) {
    for (int axis = 0; axis < 6; ++axis) {
      Poses corrected = estimates_of(comparison_);
      Vector6d error = camera(i).error;
      error[axis] = 0.0;
      corrected[i] = apply_transform_error(camera(i).T_true, error);
      // Where two axes would do, the one that fails by more of its error is the cause.
      const double size = std::abs(camera(i).error[axis]) * (failed(camera(i).name(), axis) ? 1e3 : 1.0);
      if (size <= best_size || !cures(corrected)) continue;
      best_size = size;
      best = Explanation{Explanation::Kind::kOneAxis,
                         camera(i).child,
                         axis,
                         camera(i).error[axis],
                         0,
                         camera(i).child + " is " + axis_in_words(axis, camera(i).error[axis])};
    }
  }
  return best;
}

std::optional<Explanation> Search::shared_axis() const {
  if (count() < 2) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    const double value = mean_error(axis);
    Poses corrected = estimates_of(comparison_);
    for (Rigid3& T : corrected) T.translation[axis] -= value;
    if (!cures(corrected)) continue;
    return Explanation{
        Explanation::Kind::kSharedAxis,
        "",
        axis,
        value,
        0,
        "all cameras share this error (" + shared_source({axis}) + "): they are " + axis_in_words(axis, value)};
  }
  return std::nullopt;
}

std::optional<Explanation> Search::scale() const {
  double product = 0.0, squares = 0.0;
  for (const TransformError& error : comparison_.camera_to_robot) {
    product += error.T_estimate.translation.dot(error.T_true.translation);
    squares += error.T_true.translation.squaredNorm();
  }
  if (count() < 2 || !(product > 0.0)) return std::nullopt;
  const double factor = product / squares;
  Poses corrected = estimates_of(comparison_);
  for (Rigid3& T : corrected) T.translation /= factor;
  if (!cures(corrected)) return std::nullopt;
  const double percent = 100.0 * (factor - 1.0);
  return Explanation{Explanation::Kind::kScale,
                     "",
                     -1,
                     factor - 1.0,
                     0,
                     "all distances are " + short_figure(std::abs(percent)) + " % too " +
                         (percent > 0.0 ? "long" : "short") + " (board size, odometry scale or unit)"};
}

std::optional<Explanation> Search::one_camera() const {
  if (count() < 2) return std::nullopt;  // a single camera is always its own cause
  for (std::size_t i = 0; i < count(); ++i) {
    Poses corrected = estimates_of(comparison_);
    corrected[i] = camera(i).T_true;
    if (!cures(corrected)) continue;
    Vector6d shown = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
    for (int axis = 0; axis < 6; ++axis)
      if (failed(camera(i).name(), axis)) shown[axis] = camera(i).error[axis];
    const std::string axes = describe_axes(shown);
    return Explanation{Explanation::Kind::kOneCamera,
                       camera(i).child,
                       -1,
                       camera(i).error.head<3>().norm(),
                       0,
                       "only " + camera(i).child + " is wrong" + (axes.empty() ? "" : ": " + axes)};
  }
  return std::nullopt;
}

std::optional<Explanation> Search::shared_motion() const {
  if (count() < 2) return std::nullopt;
  Vector6d mean = Vector6d::Zero();
  for (const TransformError& error : comparison_.camera_to_robot)
    mean += se3_log(error.T_estimate * error.T_true.inverse()) / static_cast<double>(count());
  const Rigid3 undo = se3_exp(-mean);
  Poses corrected = estimates_of(comparison_);
  for (Rigid3& T : corrected) T = undo * T;
  if (!cures(corrected)) return std::nullopt;
  Vector6d shown = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  std::vector<int> axes;
  for (int axis = 0; axis < 6; ++axis) {
    if (!failed("", axis)) continue;
    shown[axis] = mean_error(axis);
    axes.push_back(axis);
  }
  return Explanation{Explanation::Kind::kSharedMotion,
                     "",
                     -1,
                     mean.head<3>().norm(),
                     0,
                     "all cameras share this error (" + shared_source(axes) + "): they are " + describe_axes(shown)};
}

}  // namespace

std::optional<Explanation> explain_failures(const Comparison& comparison, const Budget& budget) {
  return Search(comparison, budget).run();
}

}  // namespace rigproof
