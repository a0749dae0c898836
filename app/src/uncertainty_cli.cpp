// The command line of `suggest` and `moved`.
#include <CLI/CLI.hpp>
#include <memory>

#include "number_in.h"
#include "uncertainty_commands.h"

namespace rigproof {
namespace {

constexpr double kFarthest_m = 1000.0;  // no robot drives farther to see a board

void add_common_options(CLI::App* command, CommonArguments& common) {
  command->add_flag("-q,--quiet", common.quiet, "Print nothing but errors");
  command->add_flag("--json", common.json, "Print JSON for machines instead of text");
  command->add_option("-j,--jobs", common.jobs, "Threads for reading images; 0 = one a core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

void add_places(CLI::App* command, SuggestArguments& arguments) {
  command
      ->add_option("--area", arguments.area_m,
                   "Free floor, metres in the frame of the robot at the first stop: X_MIN X_MAX Y_MIN Y_MAX")
      ->expected(4)
      ->check(number_in(-kFarthest_m, kFarthest_m));
  command->add_option("--reach", arguments.reach_m, "Without --area: metres beyond where the robot has stood")
      ->check(number_in(0.01, kFarthest_m))
      ->capture_default_str();
  command->add_option("--clearance", arguments.clearance_m, "Metres between the robot's origin and the board")
      ->check(number_in(0.0, kFarthest_m))
      ->capture_default_str();
  command
      ->add_option("--min-turn", arguments.min_turn_deg,
                   "Smaller turns are not asked for, degrees, unless the board would be missed")
      ->check(number_in(0.0, 90.0))
      ->capture_default_str();
  command->add_option("--min-cameras", arguments.min_cameras, "Cameras that see the whole board from every stop")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--candidates", arguments.candidates, "Places among which is chosen")
      ->check(CLI::Range(10, 100000))
      ->capture_default_str();
  command->add_option("--seed", arguments.seed, "Of the places")->capture_default_str();
}

void add_suggest(CLI::App& app, std::function<int()>& action) {
  CLI::App* command = app.add_subcommand("suggest", "The next stops that shrink the worst uncertainty most, to drive");
  command->footer("Example:\n  rigproof suggest monday/ --stops 3 --area -1 2 -1.5 1.5");
  auto arguments = std::make_shared<SuggestArguments>();
  command
      ->add_option("INPUT", arguments->input,
                   "A run, a recording, an observations.json, or a folder in the MEMROC layout")
      ->required();
  command->add_option("-k,--stops", arguments->stops, "How many")->check(CLI::Range(1, 20))->capture_default_str();
  command
      ->add_option("--criterion", arguments->criterion,
                   "worst: the largest axis over what is accepted; D: the volume; E: the largest principal axis")
      ->check(CLI::IsMember({"worst", "D", "E"}))
      ->capture_default_str();
  command->add_option("-o,--output", arguments->output,
                      "Write all stops as a configuration that `rigproof generate` replays");
  command
      ->add_option("-m,--method", arguments->method,
                   "As `calibrate` is asked for it: ml, ml:KEY=VALUE,.. or ml:FILE.yaml, whose priors count")
      ->capture_default_str();
  add_places(command, *arguments);
  add_common_options(command, arguments->common);
  command->callback([arguments, &action] { action = [arguments] { return suggest_command(*arguments); }; });
}

void add_moved(CLI::App& app, std::function<int()>& action) {
  CLI::App* command =
      app.add_subcommand("moved", "Has a camera shifted since a previous calibration? One to five stops answer");
  command->footer(
      "Exit codes: 0 nothing moved, 1 a camera moved, 3 the images cannot tell.\n"
      "Example:\n  rigproof moved tuesday/ monday/results/ml.yaml");
  auto arguments = std::make_shared<MovedArguments>();
  command
      ->add_option("INPUT", arguments->input,
                   "New images: a run, a recording, an observations.json, or MEMROC's layout")
      ->required();
  command->add_option("RESULT", arguments->previous, "The previous result, with its uncertainty")->required();
  command
      ->add_option("--significance", arguments->significance_percent,
                   "Percentage of false alarms where nothing moved, of all cameras together")
      ->check(number_in(1e-7, 49.0))
      ->capture_default_str();
  command
      ->add_option("--smallest-cm", arguments->smallest_cm,
                   "A shift of one camera that must show, with 90 % probability; else it cannot be told")
      ->check(number_in(1e-4, 1e4))
      ->capture_default_str();
  command->add_option("--smallest-deg", arguments->smallest_deg, "A turn of one camera that must show")
      ->check(number_in(1e-4, 180.0))
      ->capture_default_str();
  add_common_options(command, arguments->common);
  command->callback([arguments, &action] { action = [arguments] { return moved_command(*arguments); }; });
}

}  // namespace

void add_uncertainty_commands(CLI::App& app, std::function<int()>& action) {
  add_suggest(app, action);
  add_moved(app, action);
}

}  // namespace rigproof
