#include <algorithm>
#include <array>
#include <cmath>

#include "inspect_pictures.h"
#include "page_parts.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/figures.h"
#include "rigproof/core/text.h"
#include "rigproof/validate/explanation.h"
#include "rigproof/validate/format.h"
#include "rigproof/words/sentences.h"

namespace rigproof::page_detail {
namespace {

std::vector<std::string> names_of(const Result& result) {
  std::vector<std::string> names;
  for (const CameraUse& use : result.use) names.push_back(use.camera);
  return names;
}

std::vector<Finding> suspicions_of(const Result& result) {
  std::vector<Finding> found;
  std::copy_if(result.notes.begin(), result.notes.end(), std::back_inserter(found),
               [](const Finding& note) { return note.severity == Severity::kSuspect; });
  return found;
}

// "PASS  36/36 within .." without its first word, line by line.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::size_t first = text.find_first_not_of(' ', begin);
    if (first < end) lines.push_back(text.substr(first, end - first));
    begin = end + 1;
  }
  return lines;
}

std::string without_first_word(const std::string& line) {
  const std::size_t end = line.find("  ");
  return end == std::string::npos ? line : line.substr(end + 2);
}

// A standard deviation of one camera's pose in the robot.
struct StatedSigma {
  const EstimatedTransform* camera = nullptr;
  int axis = 0;
  double value = 0.0;
  double limit = 0.0;

  std::string name() const {
    return std::string(kSpokenAxisNames[static_cast<std::size_t>(axis)]) + " of " + camera->child;
  }
  std::string amount(double of) const { return short_text(in_unit(of, axis), 2) + (axis < 3 ? " cm" : " deg"); }
};

double limit_of(const AcceptLimits& limits, int axis) {
  if (axis >= 3) return limits.angle_rad;
  return axis == 2 ? limits.z_m : limits.xy_m;
}

std::vector<StatedSigma> stated_sigmas(const Result& result, const std::optional<AcceptLimits>& accept) {
  std::vector<StatedSigma> sigmas;
  for (const EstimatedTransform& camera : result.camera_to_robot)
    for (int axis = 0; axis < 6; ++axis)
      if (camera.covariance && camera.observable[static_cast<std::size_t>(axis)])
        sigmas.push_back({&camera, axis, std::sqrt(std::max(0.0, (*camera.covariance)(axis, axis))),
                          accept ? limit_of(*accept, axis) : 0.0});
  return sigmas;
}

// "least certain are tx of left (0.5 cm) and yaw of right (0.02 deg)".
std::string how_sure(const std::vector<StatedSigma>& sigmas) {
  std::vector<std::string> worst;
  for (const bool angle : {false, true}) {
    const StatedSigma* most = nullptr;
    for (const StatedSigma& sigma : sigmas)
      if ((sigma.axis >= 3) == angle && (most == nullptr || sigma.value > most->value)) most = &sigma;
    if (most != nullptr) worst.push_back(most->name() + " (" + most->amount(most->value) + ")");
  }
  return worst.empty() ? "the method states no uncertainty" : "least certain are " + joined(worst, " and ");
}

std::vector<std::string> without_pose(const Result& result, const Observations& observations) {
  std::vector<std::string> names;
  for (const RigCamera& camera : observations.cameras)
    if (inspect_detail::pose_of_camera(result, camera.name) == nullptr) names.push_back(camera.name);
  return names;
}

// Corners that lie far from where the other cameras of the stop put the board: a wrong rig, or wrong lenses. What
// detectors and lens models leave unsaid is a fraction of a pixel.
std::optional<std::string> contradiction(const CornerFit& fit) {
  constexpr double kTimes = 5.0, kLeast_px = 0.5;
  if (fit.rms_px <= std::max(kLeast_px, kTimes * fit.stated_px)) return std::nullopt;
  return "through this rig the images of a stop contradict each other: corners are " + short_text(fit.rms_px, 2) +
         " px (rms) from where the board fits best, " + short_text(fit.stated_px, 2) + " px are stated";
}

std::vector<std::string> beyond_limits(const std::vector<StatedSigma>& sigmas) {
  std::vector<std::string> lines;
  for (const StatedSigma& sigma : sigmas)
    if (sigma.limit > 0.0 && sigma.value > sigma.limit)
      lines.push_back(sigma.name() + ": " + sigma.amount(sigma.value) + ", accepted up to " +
                      sigma.amount(sigma.limit));
  return lines;
}

PageVerdict verdict_without_truth(const Result& result, const Observations& observations, const CornerFit& fit) {
  const std::vector<StatedSigma> sigmas = stated_sigmas(result, observations.accept);
  const std::vector<std::string> missing = without_pose(result, observations);
  if (std::vector<std::string> beyond = beyond_limits(sigmas); !beyond.empty())
    return {"bad", "BAD", "The result is less certain than the rig's accept limits ask for.", std::move(beyond)};
  if (const auto found = contradiction(fit))
    return {"suspect", "SUSPECT", "The result does not fit the images.", {*found}};
  if (!missing.empty())
    return {
        "suspect", "PARTIAL", "Without a pose: " + joined(missing) + "; of the others, " + how_sure(sigmas) + ".", {}};
  if (sigmas.empty()) return {"suspect", "NOT JUDGED", "There is no truth, and the method states no uncertainty.", {}};
  const std::size_t count = result.camera_to_robot.size();
  const std::string answered =
      count == 1 ? "The pose is answered" : "All " + std::to_string(count) + " poses are answered";
  return {"good", "GOOD", answered + "; " + how_sure(sigmas) + ", one sigma.", {}};
}

// Why a result within the budget is not to be trusted all the same.
std::vector<std::string> doubts_beside_checks(const Comparison& comparison, const CornerFit& fit) {
  std::vector<std::string> doubts;
  if (are_sigmas_too_small(comparison))
    doubts.emplace_back(
        "errors are larger than the stated sigmas explain: NEES lies above the interval of 95 % of honest results");
  if (const auto found = contradiction(fit)) doubts.push_back(*found);
  return doubts;
}

PageVerdict verdict_with_truth(const Comparison& comparison, const Budget& budget, const CornerFit& fit) {
  const Gate gate = apply_budget(comparison, budget);
  std::vector<std::string> lines = lines_of(format_verdict(comparison, gate, budget, words::sentence_of));
  std::string first = without_first_word(lines.front());
  lines.erase(lines.begin());
  if (comparison.suspicion) lines.insert(lines.begin(), words::sentence_of(comparison.suspicion->convention) + ".");
  const std::size_t count = gate.checks.size(), failures = gate.failures();
  if (count == 0) return {"suspect", "NOT JUDGED", first, lines};
  const std::string of_all = std::to_string(failures) + "/" + std::to_string(count) + " checks: ";
  if (failures > 0 && first.rfind(of_all, 0) == 0)
    first = std::to_string(failures) + " of " + std::to_string(count) + " checks against the truth fail (" +
            describe(budget) + "): " + first.substr(of_all.size());
  if (failures > 0) return {"bad", "BAD", first, lines};
  const std::string nees = format_nees(comparison);
  const std::string held = "All " + std::to_string(count) + " checks against the truth hold (" + describe(budget) +
                           ")" + (nees.empty() ? "" : "; " + nees) + ".";
  const std::vector<std::string> doubts = doubts_beside_checks(comparison, fit);
  lines.insert(lines.begin(), doubts.begin(), doubts.end());
  if (!doubts.empty()) return {"suspect", "SUSPECT", held, lines};
  return {"good", "GOOD", held, lines};
}

}  // namespace

PageVerdict verdict_of(const Result& result, const std::optional<Comparison>& comparison, const Budget& budget,
                       const Observations& observations, const CornerFit& fit) {
  const std::vector<std::string> cameras = names_of(result);
  std::vector<std::string> reasons = words::sentences_of(result.reasons, cameras);
  if (result.status == ResultStatus::kRefused)
    return {"bad", "REFUSED", "The data cannot answer what was asked, and nothing is guessed.", std::move(reasons)};
  PageVerdict verdict =
      comparison ? verdict_with_truth(*comparison, budget, fit) : verdict_without_truth(result, observations, fit);
  const std::vector<Finding> suspicions = suspicions_of(result);
  if (result.status == ResultStatus::kPartial) {
    const bool holds = verdict.level != "bad";
    reasons.insert(reasons.end(), verdict.why.begin(), verdict.why.end());
    return {holds ? "suspect" : "bad", "PARTIAL",
            "Part of what was asked is refused" + std::string(comparison ? "; of the rest: " + verdict.sentence : "."),
            std::move(reasons)};
  }
  if (suspicions.empty()) return verdict;
  if (verdict.level == "good") {
    verdict.level = "suspect";
    verdict.word = "SUSPECT";
  }
  const std::vector<std::string> doubts = words::sentences_of(suspicions, cameras);
  verdict.why.insert(verdict.why.begin(), doubts.begin(), doubts.end());
  return verdict;
}

}  // namespace rigproof::page_detail
