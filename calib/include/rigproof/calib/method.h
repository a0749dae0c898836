// A calibration method, and the registry of all of them.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/result.h"

namespace rigproof {

class FeatureSource;
class HorizonSource;
class PictureMemory;

/// What a method states about itself; `rigproof methods` prints it.
struct MethodTraits {
  std::string name;     ///< as on the command line, e.g. "joint_memroc"
  std::string summary;  ///< one sentence
  std::string needs;    ///< "board, odometry, ground plane"
  std::string gives;    ///< "camera to robot (6), camera to camera"
};

/// What a method is given: what calibration saw and, where there is one, the recording in which it was seen. A
/// recording holds what a robot could record and never the truth.
struct MethodInput {
  const Observations& observations;
  const Recording* recording = nullptr;     ///< none where the input was observations alone
  int threads = 0;                          ///< 0 = all cores; results do not depend on it
  const FeatureSource* features = nullptr;  ///< where methods that follow features get them; none: SIFT
  const HorizonSource* horizon = nullptr;   ///< a network that sees horizon and way ahead; none: geometry
  /// Called from one thread at a time with (images read, images in all) by what reads images; return false to
  /// interrupt, which throws Error with ExitCode::kTryAgain.
  std::function<bool(std::size_t, std::size_t)> progress = {};
  PictureMemory* memory = nullptr;  ///< what was found in the recording's images before; results do not depend on it
  /// Asked between pieces of work that take long, from one thread at a time; false interrupts as `progress` does.
  std::function<bool()> keep_going = {};
};

/// Throws Error with ExitCode::kTryAgain where the input's keep_going says no.
void throw_if_interrupted(const MethodInput& input);

class Method {
 public:
  virtual ~Method() = default;
  virtual MethodTraits traits() const = 0;
  /// Never throws on data: what cannot be answered is a refused or partial Result with reasons in words.
  virtual Result solve(const Observations& observations) const = 0;
  /// Why the method cannot run on this input, in a sentence ("needs images"); empty if it can. Told before anything is
  /// solved, so cheap.
  virtual std::string why_not(const MethodInput& input) const;
  /// As solve(), for methods that read images or clouds, too. The others see the observations alone.
  virtual Result solve_recording(const MethodInput& input) const;
};

/// Runs a method as every command does: one that cannot run on the input is refused with the reason why, one that can
/// is timed.
Result run_method(const Method& method, const MethodInput& input);

/// All methods, in the order in which they are listed to users.
const std::vector<const Method*>& all_methods();
/// Throws Error that names the known methods (and the nearest one) if there is none of that name.
const Method& find_method(const std::string& name);
/// The method that is used where the user names none.
const Method& default_method();

}  // namespace rigproof
