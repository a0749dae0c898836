// The method `ml` with settings: `ml:KEY=VALUE,..` or `ml:FILE.yaml` wherever a method is named.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/core/fields.h"

namespace rigproof {

/// Priors in place of those that the rig states, one sigma each; 0 = believed. See docs/guides/lenses-and-clocks.md.
struct MlSettings {
  std::string name = "ml";     ///< in tables and results/NAME.yaml
  bool believe_told = false;   ///< PriorSigmas
  std::vector<double> sigmas;  ///< in the order and the units of prior_settings()
  std::vector<bool> asked;     ///< which of them were given: the others are as the rig states them, or the usual ones

  MlSettings();
  void visit(FieldVisitor& visitor);
  MlOptions options() const;
};

/// Prefix of the name of a method with settings.
inline constexpr const char* kMlPrefix = "ml:";

/// Whether the text after the prefix names a file rather than settings.
bool names_ml_file(const std::string& text);
/// Settings from "KEY=VALUE,KEY=VALUE", or from a YAML file. Unless `name` is set, the method is named by what is set
/// ("ml-told_exact"), or as the file.
/// Throws Error with every problem found.
MlSettings read_ml_settings(const std::string& text);
std::string ml_settings_schema();

/// The method `ml` with settings.
class MlMethod : public Method {
 public:
  explicit MlMethod(MlSettings settings = {}) : settings_(std::move(settings)) {}
  MethodTraits traits() const override;
  Result solve(const Observations& observations) const override;
  std::string settings_text() const override;
  std::optional<MlOptions> prediction_options() const override { return settings_.options(); }

 private:
  MlSettings settings_;
};

}  // namespace rigproof
