// A calibration method, and the registry of all of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rigproof/calib/estimate/ml_options.h"
#include "rigproof/calib/input/method_input.h"
#include "rigproof/core/result.h"

namespace rigproof {

/// What a method looks at.
enum class MethodReads {
  kObservations,  ///< the observations alone
  kFiles,         ///< images, depth images or clouds of the recording, too
  kFeatures,      ///< features in the images, which take long to match
};

/// What a method states about itself; `rigproof methods` prints it.
struct MethodTraits {
  std::string name;     ///< as on the command line, e.g. "joint_memroc"
  std::string summary;  ///< one sentence
  std::string needs;    ///< "board, odometry, ground plane"
  std::string gives;    ///< "camera to robot (6), camera to camera"
  MethodReads reads = MethodReads::kObservations;
  double seconds_a_view = 3e-4;  ///< one core's time to solve, for forecasts: a median over runs of 40 to 300 views
  bool several_boards = false;   ///< takes recordings of more than one
};

class Method {
 public:
  virtual ~Method() = default;
  virtual MethodTraits traits() const = 0;
  /// All settings with their values, if the method has any: other values make another method.
  virtual std::string settings_text() const { return {}; }
  /// The options of `ml`, the only method that predicts images it was not given; absent for others.
  virtual std::optional<MlOptions> prediction_options() const { return std::nullopt; }
  /// Never throws on data: an unanswerable question gives a refused or partial Result with reasons.
  virtual Result solve(const Observations& observations) const = 0;
  /// Why the method cannot run on this input; absent if it can. Cheap: checked before anything is solved.
  virtual std::optional<Finding> why_not(const MethodInput& input) const;
  /// As solve(), for methods that also read images or clouds. Others only see the observations.
  virtual Result solve_recording(const MethodInput& input) const;
};

/// Why a method cannot run on an input, as why_not() says or because of what all methods have in common; absent if it
/// can.
std::optional<Finding> refusal_of(const Method& method, const MethodInput& input);

/// Runs a method as every command does: one that cannot run on the input is refused with the reason why, one that can
/// is timed.
Result run_method(const Method& method, const MethodInput& input);

}  // namespace rigproof
