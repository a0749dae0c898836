#include "faults_verdict.h"

#include <sys/stat.h>

#include <algorithm>
#include <cmath>

#include "faults/recording_faults.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/formats/format.h"
#include "rigproof/validate/validate.h"
#include "rigproof/words/sentences.h"

namespace rigproof::bench {
namespace {

constexpr double kSigmas = 5.0;

// The memory of one recording.
class RecordingMemory : public PictureMemory {
 public:
  RecordingMemory(std::filesystem::path folder, SharedFindings* findings)
      : folder_(std::move(folder)), findings_(findings) {}
  std::string content_of(const std::string& file) const override {
    return std::filesystem::exists(folder_ / file) ? findings_->content_of(folder_ / file) : "";
  }
  std::optional<std::string> recall(Finding finding, const std::string& key) override {
    return findings_->recall(full(finding, key));
  }
  void keep(Finding finding, const std::string& key, const std::string& bytes) override {
    findings_->keep(full(finding, key), bytes);
  }

 private:
  static std::string full(Finding finding, const std::string& key) {
    return std::to_string(static_cast<int>(finding)) + key;
  }
  std::filesystem::path folder_;
  SharedFindings* findings_;
};

void look(const TransformError& error, Verdict* verdict) {
  for (int axis = 0; axis < 6; ++axis) {
    const std::optional<double> z = error.z(axis);
    if (!z || std::abs(*z) <= verdict->worst_z) continue;
    verdict->worst_z = std::abs(*z);
    verdict->worst = error.name() + ", " + kDegreeOfFreedomNames[static_cast<std::size_t>(axis)];
  }
}

// Whether a finding doubts what it is about, rather than telling something.
bool is_warning(const Finding& finding) {
  return finding.severity != Severity::kNote && finding.severity != Severity::kLeftOut &&
         finding.severity != Severity::kRefusal;
}

std::vector<Finding> warnings_of(const Result& result) {
  std::vector<Finding> warnings;
  for (const std::vector<Finding>* findings : {&result.reasons, &result.notes})
    std::copy_if(findings->begin(), findings->end(), std::back_inserter(warnings), is_warning);
  return warnings;
}

Outcome outcome_of(const Result& result, double worst_z, const Naming& right) {
  const bool named = !result.reasons.empty() && right.holds(result.reasons.front());
  const bool is_solved = result.status == ResultStatus::kSolved;
  if (worst_z <= kSigmas) return is_solved ? Outcome::kGood : named ? Outcome::kNamed : Outcome::kMisnamed;
  if (named) return is_solved ? Outcome::kWarned : Outcome::kNamed;
  const std::vector<Finding> warnings = warnings_of(result);
  const bool warned = std::any_of(warnings.begin(), warnings.end(), [&](const Finding& f) { return right.holds(f); });
  return warned ? Outcome::kWarned : Outcome::kSilent;
}

Verdict judge_error(const Finding& said, const std::string& sentence, const Naming& right) {
  Verdict verdict;
  verdict.outcome = right.holds(said) ? Outcome::kNamed : Outcome::kMisnamed;
  verdict.status = "error";
  verdict.first = said.code;
  verdict.sentence = sentence;
  verdict.is_alarm = true;
  return verdict;
}

}  // namespace

std::optional<std::string> SharedFindings::recall(const std::string& key) {
  const std::lock_guard<std::mutex> guard(mutex_);
  const auto found = found_.find(key);
  return found == found_.end() ? std::nullopt : std::optional(found->second);
}

void SharedFindings::keep(const std::string& key, const std::string& bytes) {
  const std::lock_guard<std::mutex> guard(mutex_);
  found_[key] = bytes;
}

std::string SharedFindings::content_of(const std::filesystem::path& file) {
  struct stat status {};
  // A file that nothing else links to is a fault's own: its number is given to the next one when it goes.
  const bool is_shared = ::stat(file.c_str(), &status) == 0 && status.st_nlink > 1;
  if (!is_shared) return sha256_hex_of_file(file);
  const std::string number = std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
  {
    const std::lock_guard<std::mutex> guard(mutex_);
    if (const auto known = contents_.find(number); known != contents_.end()) return known->second;
  }
  const std::string hash = sha256_hex_of_file(file);
  const std::lock_guard<std::mutex> guard(mutex_);
  return contents_[number] = hash;
}

// A simulator knows its rig exactly and says so; a robot's owner does not.
static void as_strangers_are(Rig* rig) {
  rig->board.doubt();
  for (RigCamera& camera : rig->cameras) {
    camera.intrinsics_sigma = IntrinsicsSigma();
    if (camera.depth) camera.depth->noise.doubt_place_and_common_scale();
  }
}

Result calibrate_as_the_command(const std::filesystem::path& recording, SharedFindings* findings) {
  Input input = open_input(recording);
  as_strangers_are(&input.recording.value().rig);
  RecordingMemory memory(recording, findings);
  ObserveOptions options;
  options.threads = 1;
  const Observations observations = observe(input.recording.value(), options, &memory);
  return run_method(default_method(), {observations, &*input.recording, options.threads});
}

const char* outcome_name(Outcome outcome) {
  const char* const names[] = {"good", "warned", "named", "misnamed", "SILENT"};
  return names[static_cast<std::size_t>(outcome)];
}

bool Naming::holds(const Finding& finding) const {
  if (std::find(codes.begin(), codes.end(), finding.code) == codes.end()) return false;
  return cameras.empty() || finding.cameras.empty() ||
         std::any_of(finding.cameras.begin(), finding.cameras.end(),
                     [this](const std::string& camera) { return cameras.count(camera) > 0; });
}

Verdict judge(const Result& result, const Truth& truth, const Naming& right) {
  Verdict verdict;
  const Comparison comparison = compare(result, truth);
  for (const auto* errors : {&comparison.camera_to_robot, &comparison.camera_to_camera})
    for (const TransformError& error : *errors) look(error, &verdict);
  verdict.status = result_status_name(result.status);
  verdict.outcome = outcome_of(result, verdict.worst_z, right);
  const std::vector<Finding> warnings = warnings_of(result);
  verdict.is_alarm = !warnings.empty();
  const std::vector<Finding>& told = result.reasons.empty() ? warnings : result.reasons;
  if (!told.empty()) {
    verdict.first = told.front().code;
    verdict.sentence = words::sentence_of(told.front());
  }
  return verdict;
}

Verdict judge_recording(const std::filesystem::path& recording, const Truth& truth, const Naming& right,
                        SharedFindings* findings) {
  try {
    return judge(calibrate_as_the_command(recording, findings), truth, right);
  } catch (const FindingError& error) {
    return judge_error(error.finding(), words::message_of(error), right);
  } catch (const Error& error) {
    Finding said;
    said.code = faults::kError;
    return judge_error(said, error.what(), right);
  }
}

}  // namespace rigproof::bench
