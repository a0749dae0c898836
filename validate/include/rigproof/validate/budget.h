// Budgets: limits on the error that gate a run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/validate/validate.h"

namespace rigproof {

/// Limits on |error|, camera to robot and camera to camera. On disk in centimetres and degrees:
///   camera_to_robot: {tx_cm: 1, ty_cm: 1, tz_cm: 0.2, angle_deg: 0.1}, camera_to_camera: {...}, max_z: 4
struct Budget {
  std::optional<Vector6d> camera_to_robot;
  std::optional<Vector6d> camera_to_camera;
  std::optional<double> max_z;  ///< on |error / sigma|
};

Budget load_budget(const std::filesystem::path& file);
/// Where the user gives none: 4 sigma of what the method states.
Budget default_budget();

struct Check {
  std::string name;  ///< "left in robot: tz"
  bool passed = false;
  double value = 0.0;  ///< in `unit`
  double limit = 0.0;
  std::string unit;  ///< "cm", "deg", "sigma"
};

struct Gate {
  std::vector<Check> checks;
  bool passed() const;
  std::size_t failures() const;
};

Gate apply_budget(const Comparison& comparison, const Budget& budget);

}  // namespace rigproof
