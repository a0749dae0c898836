// A calibration method, and the registry of all of them.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof {

/// What a method states about itself; `rigproof methods` prints it.
struct MethodTraits {
  std::string name;     ///< as on the command line, e.g. "joint_memroc"
  std::string summary;  ///< one sentence
  std::string needs;    ///< "board, odometry, ground plane"
  std::string gives;    ///< "camera to robot (6), camera to camera"
};

class Method {
 public:
  virtual ~Method() = default;
  virtual MethodTraits traits() const = 0;
  /// Never throws on data: what cannot be answered is a refused or partial Result with reasons in words.
  virtual Result solve(const Observations& observations) const = 0;
};

/// All methods, in the order in which they are listed to users.
const std::vector<const Method*>& all_methods();
/// Throws Error that names the known methods (and the nearest one) if there is none of that name.
const Method& find_method(const std::string& name);
/// The method that is used where the user names none.
const Method& default_method();

}  // namespace rigproof
