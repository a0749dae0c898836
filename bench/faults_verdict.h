// What `rigproof calibrate` says of a recording, against the truth.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rigproof/calib/vision/picture_memory.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/result.h"
#include "rigproof/truth/truth.h"

namespace rigproof::bench {

/// What was found in pictures, by their content: what a fault does not change is not searched again. Many threads.
class SharedFindings {
 public:
  std::optional<std::string> recall(const std::string& key);
  void keep(const std::string& key, const std::string& bytes);
  /// SHA-256. Links to one file are read once.
  std::string content_of(const std::filesystem::path& file);

 private:
  std::mutex mutex_;
  std::map<std::string, std::string> found_, contents_;
};

/// What `rigproof calibrate` does with its defaults, with a rig.yaml that states no sigma of lenses, board and depth.
/// Throws what it would print as an error.
Result calibrate_as_the_command(const std::filesystem::path& recording, SharedFindings* findings);

enum class Outcome {
  kGood,      ///< solved, every value within five sigmas of the truth
  kWarned,    ///< solved, one beyond, and a warning names the part that is broken
  kNamed,     ///< refused, at least in part, and the first reason is the cause
  kMisnamed,  ///< refused for another reason
  kSilent,    ///< a value stands that is beyond five sigmas, and nothing says so
};
inline constexpr std::size_t kOutcomes = 5;
const char* outcome_name(Outcome outcome);

struct Verdict {
  Outcome outcome = Outcome::kGood;
  std::string status;     ///< solved, partial, refused, error
  std::string first;      ///< code of the first reason or warning, "error" for one that is no finding; or empty
  std::string sentence;   ///< of that
  bool is_alarm = false;  ///< it says that something is wrong, rather than too little
  double worst_z = 0.0;   ///< largest |error / sigma| of what stands
  std::string worst;      ///< whose it is: "left in robot, tz"
};

/// How a fault is named: by one of these codes, about one of these cameras or none. No cameras: whichever.
struct Naming {
  std::vector<std::string> codes;
  std::set<std::string> cameras;

  bool holds(const Finding& finding) const;
};

Verdict judge(const Result& result, const Truth& truth, const Naming& right);
/// Calibrates and judges.
Verdict judge_recording(const std::filesystem::path& recording, const Truth& truth, const Naming& right,
                        SharedFindings* findings);

}  // namespace rigproof::bench
