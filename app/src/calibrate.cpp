// `rigproof observe` and `rigproof calibrate`.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "acceptance.h"
#include "commands.h"
#include "json_text.h"
#include "judging.h"
#include "observing.h"
#include "print_result.h"
#include "rigproof/core/error.h"
#include "rigproof/study/export/export.h"
#include "rigproof/study/workflow/chain_check.h"
#include "rigproof/study/workflow/external.h"
#include "rigproof/study/workflow/workflow.h"
#include "rigproof/words/sentences.h"
#include "terminal.h"

namespace rigproof {
namespace {

std::string count_of(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string camera_summary(const Observations& observations, int camera) {
  const auto belongs = [camera](const auto& item) { return item.camera == camera; };
  const auto views = std::count_if(observations.board_views.begin(), observations.board_views.end(), belongs);
  const auto planes = std::count_if(observations.ground_planes.begin(), observations.ground_planes.end(), belongs);
  return std::to_string(views) + " boards, " + std::to_string(planes) + " ground planes";
}

}  // namespace

int observe_command(const ObserveArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const Vision vision(arguments.vision);
  const Input input = open_input(arguments.input);
  const std::filesystem::path output = product_place(input, arguments.output, "observations.json");
  const Observations observations = observe_with_progress(input, vision, arguments.common.jobs, terminal);
  save_observations(observations, output);
  if (arguments.common.json) {
    const nlohmann::json json = {{"observations", output.string()},
                                 {"stops", observations.stops.size()},
                                 {"board_views", observations.board_views.size()},
                                 {"ground_planes", observations.ground_planes.size()},
                                 {"left_out", observations.exclusions.size()}};
    std::puts(json_text(json).c_str());
    return 0;
  }
  terminal.line(count_of(observations.cameras.size(), "camera") + " x " + count_of(observations.stops.size(), "stop"));
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < observations.cameras.size(); ++i)
    rows.push_back({" " + observations.cameras[i].name, camera_summary(observations, static_cast<int>(i))});
  for (const std::string& line : aligned(rows)) terminal.line(line);
  terminal.line("observations  " + output.string());
  return 0;
}

int calibrate_command(const CalibrateArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  methods_by_name(arguments.methods);  // an unknown method is told before anything is read
  if (!arguments.accept.empty()) accept_criteria_of(arguments.accept);
  const Vision vision(arguments.vision);
  const Input input = open_input(arguments.input);
  const std::optional<Gates> gates = gates_for(arguments.accept, accepted_by_rig(input));
  if (!gates && !arguments.junit.empty())
    throw Error("--junit: holds the gates of --accept and of the rig's accept key, and there are neither");
  const std::filesystem::path folder = product_place(input, arguments.output, "results");
  const FrameTree chain = load_chain(product_folder(input));
  const auto methods = methods_by_name(arguments.methods, {folder, [] { return !interrupted(); }});
  for (const auto& method : methods)
    check_can_be_written(folder / (result_name(method->traits().name, arguments.vision) + ".yaml"));
  if (!arguments.junit.empty()) check_can_be_written(arguments.junit);
  const Observations observations = observe_with_progress(input, vision, arguments.common.jobs, terminal);
  const MethodInput given = method_input(input, observations, vision, arguments.common.jobs);
  bool all_solved = true;
  nlohmann::json results = nlohmann::json::array();
  std::vector<ValidationRecord> judged;
  for (const auto& method : methods) {
    Result result = run_with_progress(*method, given, terminal);
    result.method = result_name(result.method, arguments.vision);
    for (Finding& finding : compare_with_chain(result, chain)) result.notes.push_back(std::move(finding));
    const WrittenFile written =
        write_with_backup(folder / (result.method + ".yaml"), result_text(result, words::sentence_of));
    all_solved = all_solved && result.status == ResultStatus::kSolved;
    results.push_back(json_of(result));
    terminal.line(count_of(observations.cameras.size(), "camera") + " x " +
                  count_of(observations.stops.size(), "stop") + ", method " + result.method);
    print_result(terminal, result);
    terminal.line(std::string(result_status_name(result.status)) + " result  " + written.file.string() +
                  (written.backup ? "  (before: " + written.backup->string() + ")" : ""));
    const auto report = gates ? judge_acceptance(terminal, *method, result, observations, *gates) : std::nullopt;
    if (report) {
      judged.push_back(acceptance_record(result, *report, gates->criteria));
      results.back()["acceptance"] = json_of(*report, gates->criteria);
    }
  }
  if (!arguments.junit.empty()) save_junit(judged, arguments.junit, words::sentence_of);
  if (arguments.common.json) std::puts(json_text({{"results", results}}).c_str());
  if (!all_solved) return static_cast<int>(ExitCode::kRefused);
  return static_cast<int>(all_passed(judged) ? ExitCode::kGood : ExitCode::kGateFailed);
}

}  // namespace rigproof
