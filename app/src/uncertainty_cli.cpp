// The command line of `suggest` and `moved`.
#include "command_line.h"
#include "number_in.h"
#include "one_of.h"
#include "rigproof/formats/format.h"

namespace rigproof {
namespace {

constexpr double kFarthest_m = 1000.0;  // no robot drives farther to see a board

void add_places(CLI::App* command, SuggestArguments& arguments) {
  command
      ->add_option("--area", arguments.area_m,
                   "Free floor, metres in the frame of the robot at the first stop: X_MIN X_MAX Y_MIN Y_MAX")
      ->expected(4)
      ->check(number_in(-kFarthest_m, kFarthest_m));
  command
      ->add_option("--reach", arguments.reach_m,
                   "Without --area: how far the robot may go beyond where it has stood, metres")
      ->check(number_in(0.01, kFarthest_m))
      ->capture_default_str();
  command
      ->add_option("--clearance", arguments.clearance_m,
                   "Least distance between the robot's origin and the board, metres")
      ->check(number_in(0.0, kFarthest_m))
      ->capture_default_str();
  command
      ->add_option("--min-turn", arguments.min_turn_deg,
                   "Smallest turn to ask for, degrees; less only where the board would otherwise be missed")
      ->check(number_in(0.0, 90.0))
      ->capture_default_str();
  command->add_option("--min-cameras", arguments.min_cameras, "How many cameras must see the whole board at every stop")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command
      ->add_option("--min-gain", arguments.min_gain_percent,
                   "By how much a stop must make the sigmas that matter smaller, per cent; others are not suggested")
      ->check(number_in(0.0, 99.0))
      ->capture_default_str();
  command->add_option("--candidates", arguments.candidates, "Number of random places to choose from")
      ->check(CLI::Range(10, 100000))
      ->capture_default_str();
  command->add_option("--seed", arguments.seed, "Seed of the random places")->capture_default_str();
}

void add_suggest(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "suggest", "Suggest the next stops, those that shrink the worst uncertainty most",
                  "rigproof suggest monday/ --stops 3 --area -1 2 -1.5 1.5", suggest_command);
  command->add_option("INPUT", arguments.input, "Input: " + inputs_in_words(false))->required();
  command->add_option("-k,--stops", arguments.stops, "Number of stops to suggest")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command
      ->add_option("--criterion", arguments.criterion,
                   "What to shrink: worst, the largest standard deviation relative to its accept limit; D, the "
                   "determinant of the covariance; E, its largest eigenvalue")
      ->check(one_of({"worst", "D", "E"}))
      ->capture_default_str();
  command->add_option("-o,--output", arguments.output,
                      "Write all stops as a configuration that `rigproof generate` replays");
  command
      ->add_option(
          "-m,--method", arguments.method,
          "The method that `calibrate` will be asked for: ml, ml:KEY=VALUE,.. or ml:FILE.yaml, with its priors")
      ->type_name("METHOD")
      ->capture_default_str();
  add_places(command, arguments);
  add_common(command, arguments.common);
  add_jobs(command, arguments.common, "Threads for reading images; 0 = one for each core");
}

void add_moved(CLI::App& app, Action& action) {
  const auto [command, arguments] = add_command(
      app, action, "moved", "Has a camera shifted since an earlier calibration? One to five new stops answer",
      "rigproof moved tuesday/ monday/results/ml.yaml", moved_command,
      "Exit codes: 0 nothing moved, 1 a camera moved, 3 the images cannot tell.\n");
  command->add_option("INPUT", arguments.input, "New images: " + inputs_in_words(false))->required();
  command
      ->add_option("RESULT", arguments.previous,
                   "The earlier result, with its uncertainty; show the same board as then")
      ->required();
  command
      ->add_option("--significance", arguments.significance_percent,
                   "Probability of a false alarm when nothing moved, for all cameras together, per cent")
      ->check(number_in(1e-7, 49.0))
      ->capture_default_str();
  command
      ->add_option("--smallest-cm", arguments.smallest_cm,
                   "Report \"cannot tell\" for a camera where a shift of this size would be found with less than 90 % "
                   "probability")
      ->check(number_in(1e-4, 1e4))
      ->capture_default_str();
  command->add_option("--smallest-deg", arguments.smallest_deg, "The same for a rotation")
      ->check(number_in(1e-4, 180.0))
      ->capture_default_str();
  add_common(command, arguments.common);
  add_jobs(command, arguments.common, "Threads for reading images; 0 = one for each core");
}

}  // namespace

void add_uncertainty_commands(CLI::App& app, Action& action) {
  add_suggest(app, action);
  add_moved(app, action);
}

}  // namespace rigproof
