// Budgets: limits on the error that gate a run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/validate/validate.h"

namespace rigproof {

/// Limits on |error|, camera to robot and camera to camera. On disk in centimetres and degrees:
///   camera_to_robot: {tx_cm: 1, ty_cm: 1, tz_cm: 0.2, angle_deg: 0.1}
///   camera_to_camera: {distance_cm: 0.5, angle_deg: 0.1}
///   max_z: 4
/// distance_cm stands for all three translations, angle_deg for all three rotations; a key that names one axis
/// (tx_cm, rz_deg) takes precedence. What is not named is not limited.
struct Budget {
  std::optional<Vector6d> camera_to_robot;  ///< metres and radians, infinity = not limited
  std::optional<Vector6d> camera_to_camera;
  std::optional<double> max_z;     ///< on |error / sigma|
  bool nothing_suspected = false;  ///< a finding that throws doubt on the result fails, too: add_suspicions()
  std::string name;                ///< "ci.yaml"; empty for the default one
};

/// Throws Error with every problem found; a budget without any limit is one. Whoever writes a budget asks for a gate:
/// nothing may be suspected then.
Budget load_budget(const std::filesystem::path& file);
/// Where the user gives none: 4 sigma of what the method states.
Budget default_budget();
/// "4 sigma", "1 cm, 1 cm, .2 cm, .1 deg".
std::string describe(const Budget& budget);
/// The JSON Schema of budget files.
std::string budget_schema();

/// One limit against one error.
struct Check {
  std::string name;     ///< "left in robot: tz"
  std::string subject;  ///< "left in robot", "left-right"
  int axis = -1;        ///< 0 to 5 = tx .. rz; -1 where the whole pose is concerned
  bool between_cameras = false;
  bool passed = false;
  double value = 0.0;  ///< |error| in `unit`
  double limit = 0.0;
  std::string unit;               ///< "cm", "deg", "sigma"; empty where there is no value
  std::optional<Finding> reason;  ///< why it failed without a value: gate.no_pose, ..

  /// "0.63 cm, allowed 0.2 cm", or the reason: its code unless somebody words it.
  std::string message(const Wording& wording = {}) const;
};

struct Gate {
  std::vector<Check> checks;
  std::vector<Finding> notes;  ///< what could not be checked
  /// At least one check, and none failed: a gate that checked nothing has not been passed.
  bool passed() const;
  std::size_t failures() const;
};

/// A camera without a pose fails (but for a solved result that is camera to camera throughout, under a budget that does
/// not limit camera_to_robot); so does a degree of freedom that the budget limits in metres or radians and the
/// result does not answer. A limit in sigmas concerns only what states a sigma.
Gate apply_budget(const Comparison& comparison, const Budget& budget);
/// A failed check for each of a result's notes that throws doubt on it.
void add_suspicions(const std::vector<Finding>& notes, Gate* gate);

}  // namespace rigproof
