// `rigproof moved`.
#include "rigproof/calib/plan/moved.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "json_text.h"
#include "observing.h"
#include "print_result.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/figures.h"
#include "rigproof/core/text.h"
#include "rigproof/words/sentences.h"

namespace rigproof {
namespace {

std::string shift_cell(const CameraShift& camera, std::size_t axis) {
  if (!camera.shift[axis]) return "-";
  const double unit = axis < 3 ? 100.0 : rad_to_deg(1.0), sigma = unit * *camera.sigma[axis];
  const int decimals = decimals_for_sigma(sigma);
  return signed_figure(unit * *camera.shift[axis], decimals) + "+-" + figure(sigma, decimals);
}

std::string detectable_text(const CameraShift& camera) {
  if (!std::isfinite(camera.detectable_shift_m) || !std::isfinite(camera.detectable_turn_rad))
    return "some shifts would never show";
  return "would show " + short_figure(100.0 * camera.detectable_shift_m) + " cm, " +
         short_figure(rad_to_deg(camera.detectable_turn_rad)) + " deg";
}

std::string percent(double share) { return short_text(100.0 * share, 2) + " %"; }

std::string verdict_text(const MovedReport& report, double significance) {
  const std::string test = "chi-square " + short_text(report.statistic, 3) + " of " +
                           std::to_string(report.degrees_of_freedom) + ", p " + short_text(report.p_value, 2) +
                           ", significance " + percent(significance);
  switch (report.outcome) {
    case MovedOutcome::kNothingMoved:
      return "PASS     nothing moved (" + test + ")";
    case MovedOutcome::kMoved:
      return "FAIL     a camera moved (" + test + ")";
    case MovedOutcome::kCannotTell:
      break;
  }
  return "REFUSED  not every camera can be judged" + (report.degrees_of_freedom > 0 ? " (" + test + ")" : "");
}

void print(const Terminal& terminal, const MovedReport& report, double significance) {
  const Color color = report.outcome == MovedOutcome::kNothingMoved ? Color::kGood : Color::kBad;
  terminal.line(terminal.colored(verdict_text(report, significance), color));
  std::vector<std::vector<std::string>> rows = {with_axis_heads({"now less then", ""})};
  for (const CameraShift& camera : report.cameras) {
    rows.push_back({" " + camera.camera, moved_verdict_name(camera.verdict)});
    for (std::size_t axis = 0; axis < 6; ++axis) rows.back().push_back(shift_cell(camera, axis));
  }
  const std::vector<std::string> lines = aligned(rows);
  for (std::size_t i = 0; i < lines.size(); ++i)
    terminal.line(lines[i] + (i == 0 ? "" : "  " + detectable_text(report.cameras[i - 1])));
  for (const std::string& reason : words::sentences_of(report.reasons)) terminal.line("         " + reason);
  for (const std::string& note : words::sentences_of(report.notes))
    terminal.line(terminal.colored("NOTE", Color::kWarning) + "     " + note);
}

nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

std::string as_json(const MovedReport& report) {
  static const char* const kOutcomes[] = {"nothing moved", "moved", "cannot tell"};
  nlohmann::json json = {{"outcome", kOutcomes[static_cast<int>(report.outcome)]},
                         {"rig_moved", report.rig_moved},
                         {"chi_square", report.statistic},
                         {"degrees_of_freedom", report.degrees_of_freedom},
                         {"p_value", report.p_value},
                         {"reasons", json_of(report.reasons)},
                         {"notes", json_of(report.notes)},
                         {"cameras", nlohmann::json::array()}};
  for (const CameraShift& camera : report.cameras) {
    nlohmann::json entry = {{"camera", camera.camera},
                            {"verdict", moved_verdict_name(camera.verdict)},
                            {"p_value", camera.p_value},
                            {"detectable_shift_m", number_or_null(camera.detectable_shift_m)},
                            {"detectable_turn_rad", number_or_null(camera.detectable_turn_rad)}};
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const std::string key = std::string(kDegreeOfFreedomNames[axis]) + (axis < 3 ? "_m" : "_rad");
      entry["shift"][key] = camera.shift[axis] ? nlohmann::json(*camera.shift[axis]) : nlohmann::json(nullptr);
      entry["sigma"][key] = camera.sigma[axis] ? nlohmann::json(*camera.sigma[axis]) : nlohmann::json(nullptr);
    }
    json["cameras"].push_back(std::move(entry));
  }
  return json_text(json);
}

ExitCode exit_code_of(MovedOutcome outcome) {
  if (outcome == MovedOutcome::kNothingMoved) return ExitCode::kGood;
  return outcome == MovedOutcome::kMoved ? ExitCode::kGateFailed : ExitCode::kRefused;
}

}  // namespace

int moved_command(const MovedArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const Result previous = load_result(arguments.previous);
  const Input input = open_input(arguments.input);
  const Observations observations = observe_with_progress(input, arguments.common.jobs, terminal);
  MovedOptions options;
  options.significance = 0.01 * arguments.significance_percent;
  options.smallest_shift_m = 0.01 * arguments.smallest_cm;
  options.smallest_turn_rad = deg_to_rad(arguments.smallest_deg);
  const MovedReport report = detect_movement(previous, observations, options);
  if (arguments.common.json) std::puts(as_json(report).c_str());
  terminal.line(std::to_string(report.cameras.size()) + (report.cameras.size() == 1 ? " camera" : " cameras") + " x " +
                std::to_string(observations.stops.size()) + (observations.stops.size() == 1 ? " stop" : " stops") +
                " against " + arguments.previous.string());
  print(terminal, report, options.significance);
  return static_cast<int>(exit_code_of(report.outcome));
}

}  // namespace rigproof
