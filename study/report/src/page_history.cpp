// A rig over time: what `moved` says of each recording.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "page_parts.h"
#include "rigproof/calib/plan/moved.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/core/version.h"

namespace rigproof::page_detail {
namespace {

constexpr double kYear2000S = 946684800.0;

/// A recording with its verdicts; against the first and against the one before, where there is one.
struct Day {
  HistoryEntry entry;
  std::optional<MovedReport> since_first, since_last;
};

/// Of its first image; nothing where the stamps do not count from 1970.
std::optional<double> date_of(const HistoryEntry& entry) {
  if (entry.observations.stops.empty() || entry.observations.stops.front().stamp_s < kYear2000S) return std::nullopt;
  return entry.observations.stops.front().stamp_s;
}

bool are_dated(const std::vector<HistoryEntry>& entries) {
  return std::all_of(entries.begin(), entries.end(), [](const HistoryEntry& e) { return date_of(e).has_value(); });
}

MovedReport compared(const HistoryEntry& before, const HistoryEntry& now) {
  try {
    return detect_movement(before.result, now.observations);
  } catch (const Error& error) {
    throw Error(now.name + " against " + before.name + ": " + error.what(), error.exit_code());
  }
}

bool states_poses(const Result& result) {
  return std::any_of(result.camera_to_robot.begin(), result.camera_to_robot.end(),
                     [](const EstimatedTransform& transform) { return transform.covariance.has_value(); });
}

// What tells the recordings apart: their folders' names, but where two have the same.
void shorten_names(std::vector<HistoryEntry>* entries) {
  std::set<std::string> names;
  for (const HistoryEntry& entry : *entries) names.insert(std::filesystem::path(entry.name).filename().string());
  if (names.size() < entries->size() || names.count("") > 0) return;
  for (HistoryEntry& entry : *entries) entry.name = std::filesystem::path(entry.name).filename().string();
}

std::vector<Day> days_of(std::vector<HistoryEntry> entries) {
  std::vector<Day> days;
  for (HistoryEntry& entry : entries) {
    Day day{std::move(entry), {}, {}};
    if (!days.empty()) {
      day.since_first = compared(days.front().entry, day.entry);
      if (states_poses(days.back().entry.result)) day.since_last = compared(days.back().entry, day.entry);
    }
    days.push_back(std::move(day));
  }
  return days;
}

const CameraShift* shift_of(const std::optional<MovedReport>& report, const std::string& camera) {
  if (!report) return nullptr;
  for (const CameraShift& shift : report->cameras)
    if (shift.camera == camera) return &shift;
  return nullptr;
}

bool is(const std::optional<MovedReport>& report, const std::string& camera, MovedVerdict verdict) {
  const CameraShift* shift = shift_of(report, camera);
  return shift != nullptr && shift->verdict == verdict;
}

// Length of the three from `first`, of those that are known.
double length_of(const std::array<std::optional<double>, 6>& values, std::size_t first) {
  double sum = 0.0;
  for (std::size_t axis = first; axis < first + 3; ++axis) sum += std::pow(values[axis].value_or(0.0), 2);
  return std::sqrt(sum);
}

// Below a thousandth of a unit nobody asks.
std::string size_text(double size) { return size < 1e-3 ? "0" : short_text(size, 2); }

// "left moved between monday and friday: 2.3 cm, 0.4 deg against monday", where it first shows.
std::optional<std::string> first_shift(const std::vector<Day>& days, const std::string& camera, MovedVerdict verdict) {
  for (std::size_t i = 1; i < days.size(); ++i) {
    if (!is(days[i].since_first, camera, verdict)) continue;
    const CameraShift& shift = *shift_of(days[i].since_first, camera);
    const bool is_since_last = is(days[i].since_last, camera, verdict);
    const std::string& from = days[is_since_last ? i - 1 : 0].entry.name;
    return camera + (verdict == MovedVerdict::kMoved ? " moved between " : " may have moved between ") + from +
           " and " + days[i].entry.name + ": " + size_text(100.0 * length_of(shift.shift, 0)) + " cm, " +
           size_text(rad_to_deg(length_of(shift.shift, 3))) + " deg against " + days.front().entry.name;
  }
  return std::nullopt;
}

PageVerdict verdict_of(const std::vector<Day>& days, const std::vector<std::string>& cameras) {
  const std::string all = std::to_string(days.size()) + " recordings";
  PageVerdict verdict{"good", "STANDS", "No camera has shifted in " + all + ".", {}};
  std::vector<std::string> unknown;
  const auto worse = [&](const char* level, const char* word, const std::string& sentence) {
    if (verdict.level == "good") verdict = {level, word, sentence, {}};
  };
  for (const MovedVerdict which : {MovedVerdict::kMoved, MovedVerdict::kSuspect}) {
    const bool moved = which == MovedVerdict::kMoved;
    for (const std::string& camera : cameras) {
      const std::optional<std::string> line = first_shift(days, camera, which);
      if (!line) continue;
      worse(moved ? "bad" : "suspect", moved ? "MOVED" : "SUSPECT",
            moved ? "A camera has moved: calibrate the rig anew from then on."
                  : "Something has moved, and the images do not tell which camera.");
      verdict.why.push_back(*line);
    }
  }
  for (const std::string& camera : cameras)
    if (is(days.back().since_first, camera, MovedVerdict::kCannotTell)) unknown.push_back(camera);
  if (unknown.empty()) return verdict;
  worse("suspect", "CANNOT TELL", "The images of " + days.back().entry.name + " cannot tell of every camera.");
  verdict.why.push_back("A shift worth knowing would not show in the last recording: " + joined(unknown, ", "));
  return verdict;
}

Json optional_list(const std::array<std::optional<double>, 6>& values) {
  Json list = Json::array();
  for (const std::optional<double>& value : values) list.push_back(value ? figure_of(*value) : Json());
  return list;
}

Json moved_json(const std::optional<MovedReport>& report) {
  if (!report) return nullptr;
  Json json = {{"chi_square", figure_of(report->statistic)},
               {"degrees_of_freedom", report->degrees_of_freedom},
               {"p_value", figure_of(report->p_value)},
               {"rig_moved", report->rig_moved},
               {"cameras", Json::array()}};
  for (const CameraShift& camera : report->cameras)
    json["cameras"].push_back({{"camera", camera.camera},
                               {"verdict", moved_verdict_name(camera.verdict)},
                               {"shift", optional_list(camera.shift)},
                               {"sigma", optional_list(camera.sigma)},
                               {"detectable_m", figure_of(camera.detectable_shift_m)},
                               {"detectable_rad", figure_of(camera.detectable_turn_rad)}});
  return json;
}

std::vector<Finding> findings_of(const Day& day) {
  std::vector<Finding> findings;
  if (day.since_first) {
    findings = day.since_first->reasons;
    findings.insert(findings.end(), day.since_first->notes.begin(), day.since_first->notes.end());
  }
  findings.insert(findings.end(), day.entry.result.reasons.begin(), day.entry.result.reasons.end());
  return findings;
}

Json day_json(const Day& day) {
  const std::optional<double> date_s = date_of(day.entry);
  Json json = {{"name", day.entry.name},
               {"date_s", date_s ? Json(std::round(*date_s)) : Json()},
               {"status", result_status_name(day.entry.result.status)},
               {"stops", day.entry.observations.stops.size()},
               {"poses", Json::array()}};
  for (const EstimatedTransform& transform : day.entry.result.camera_to_robot)
    json["poses"].push_back(pose_json(transform));
  json["since_first"] = moved_json(day.since_first);
  json["since_last"] = moved_json(day.since_last);
  json["findings"] = findings_list(findings_of(day));
  return json;
}

std::vector<std::string> cameras_of(const Result& result) {
  std::vector<std::string> names;
  for (const EstimatedTransform& transform : result.camera_to_robot) names.push_back(transform.child);
  return names;
}

}  // namespace
}  // namespace rigproof::page_detail

namespace rigproof {

PageContent history_page_content(std::vector<HistoryEntry> entries) {
  using namespace page_detail;
  if (entries.size() < 2) throw Error("a history needs at least two recordings");
  shorten_names(&entries);
  const bool dated = are_dated(entries);
  if (dated)
    std::stable_sort(entries.begin(), entries.end(),
                     [](const HistoryEntry& a, const HistoryEntry& b) { return *date_of(a) < *date_of(b); });
  const std::vector<Day> days = days_of(std::move(entries));
  const HistoryEntry& first = days.front().entry;
  const std::vector<std::string> cameras = cameras_of(first.result);
  const PageVerdict verdict = verdict_of(days, cameras);
  const std::string title = first.name + " to " + days.back().entry.name;
  Json data = {
      {"kind", "history"},       {"version", version()},          {"title", title},
      {"is_dated", dated},       {"method", first.result.method}, {"robot_frame", first.observations.robot_frame},
      {"cameras", Json::array()}};
  for (const std::string& camera : cameras) data["cameras"].push_back({{"name", camera}});
  data["verdict"] = {
      {"level", verdict.level}, {"word", verdict.word}, {"sentence", verdict.sentence}, {"why", verdict.why}};
  data["recordings"] = Json::array();
  for (const Day& day : days) data["recordings"].push_back(day_json(day));
  return {title, text_of(data), "[]"};
}

}  // namespace rigproof
