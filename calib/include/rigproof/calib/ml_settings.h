// The method `ml` with settings: `ml:KEY=VALUE,..` or `ml:FILE.yaml` wherever a method is named.
#pragma once

#include <memory>
#include <string>

#include "rigproof/calib/method.h"
#include "rigproof/calib/ml.h"
#include "rigproof/core/fields.h"

namespace rigproof {

/// Priors of what `ml` otherwise believes, one sigma each; 0 = believed. docs/estimation.md tells what they do.
struct MlSettings {
  std::string name = "ml";  ///< in tables and results/NAME.yaml
  double clock_offset_sigma_ms = 0.0;
  double focal_sigma_percent = 0.0;
  double principal_point_sigma_px = 0.0;
  double rotation_centre_sigma_mm = 5.0;
  double turn_lag_sigma_ms = 20.0;
  double riding_height_sigma_mm = 0.3;

  void visit(FieldVisitor& visitor);
  MlOptions options() const;
};

/// What begins the name of a method with settings.
inline constexpr const char* kMlPrefix = "ml:";

/// Whether the text behind the prefix names a file, and no settings.
bool names_ml_file(const std::string& text);
/// Settings from "KEY=VALUE,KEY=VALUE", or from a YAML file (whose name is the method's, unless it says another).
/// Throws Error with every problem found.
MlSettings read_ml_settings(const std::string& text);
std::string ml_settings_schema();

/// The method `ml` with settings.
class MlMethod : public Method {
 public:
  explicit MlMethod(MlSettings settings = {}) : settings_(std::move(settings)) {}
  MethodTraits traits() const override;
  Result solve(const Observations& observations) const override;
  MlOptions options() const { return settings_.options(); }
  /// Every setting with its value: other ones are another method.
  std::string settings_text() const;

 private:
  MlSettings settings_;
};

}  // namespace rigproof
