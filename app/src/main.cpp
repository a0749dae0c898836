// The `rigproof` command: parses the command line and calls one function of commands.h. The only place that includes
// CLI11, and the only one that turns exceptions into messages and exit codes.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "command_line.h"
#include "command_texts.h"
#include "export_command.h"
#include "number_in.h"
#include "one_of.h"
#include "rigproof/calib/vision/ground_source.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/core/version.h"
#include "rigproof/formats/format.h"
#include "rigproof/sim/board_pattern.h"
#include "rigproof/sim/board_print.h"
#include "rigproof/study/record/bag_of_recording.h"
#include "rigproof/study/workflow/archive.h"
#include "rigproof/words/sentences.h"
#include "terminal.h"

namespace rigproof {
namespace {

constexpr const char* kExitCodes =
    "Exit codes: 0 good, 1 a gate failed, 2 bad input or environment, 3 refused (the data cannot answer),\n"
    "75 try again (interrupted; the same command resumes).";

constexpr const char* kMethodHelp =
    "One of `rigproof methods`; ml:KEY=VALUE,.. or ml:FILE.yaml with priors of lenses and clocks (`rigproof schema "
    "ml`); "
    "external:FILE.yaml, a program of your own; may be repeated";

constexpr const char* kCacheHelp = "Folder that keeps clean renders; what it holds is not rendered again";

CLI::Option* add_shards(CLI::App* command, int& shard_mib) {
  return command
      ->add_option("--shard-mib", shard_mib, "Limit on the files in a shard of an archive, before packing, MiB")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
}

void add_generate_options(CLI::App* command, GenerateArguments& arguments) {
  command
      ->add_option("CONFIG", arguments.config,
                   "Configuration file, or the name of a shipped one; without it every default applies")
      ->type_name("RUN");
  command->add_option("-o,--output", arguments.output, "Folder of the run; default runs/<name of the config>");
  add_overrides(command, arguments.set,
                "Override a field, e.g. --set poses=20 --set odometry.lambda=5; may be repeated");
  command->add_flag("--fresh", arguments.fresh, "Delete what is in the output and start over; default is to resume");
  add_cache(command, arguments.cache, kCacheHelp);
  command->add_flag(
      "--dry-run", arguments.dry_run,
      "Only say how many images, megabytes and minutes it would take, and where in its images each camera "
      "would see the board");
  add_jobs(command, arguments.common);
  add_device(command, arguments.device);
  add_common(command, arguments.common);
}

void add_generate(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "generate", "Render a run: images, depth, odometry, and the truth apart",
                  "rigproof generate demo.yaml -o runs/demo", generate_command);
  add_generate_options(command, arguments);
  command->add_flag("--observations", arguments.observations,
                    "Keep observations.json, the truth and the hashes of all pictures, but no picture: they are looked "
                    "at in memory");
  CLI::Option* const archive = command->add_option(
      "--archive", arguments.archive, "New folder for the run as a few large files, too: tar.zst with an index");
  add_shards(command, arguments.shard_mib)->needs(archive);
}

void add_sense(CLI::App& app, Action& action) {
  const auto [command, arguments] = add_command(
      app, action, "sense", "Make another noise realisation of a run from its clean renders, without rendering",
      "rigproof sense runs/demo --cache cache --seed 7 -o runs/demo_7", sense_command);
  command->add_option("SOURCE", arguments.source, "A run that was generated with --cache, or its configuration")
      ->required();
  command->add_option("-o,--output", arguments.output, "Folder of the new run")->required();
  add_cache(command, arguments.cache, kCacheHelp);
  command->add_option("--seed", arguments.seed, "Seed of noise, devices and odometry; default as in the source")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{9007199254740992}));
  add_overrides(command, arguments.set, "Override a sense key, e.g. --set sensing.depth.edges=true; may be repeated");
  command->add_flag("--fresh", arguments.fresh, "Delete what is in the output and start over; default is to resume");
  add_jobs(command, arguments.common);
  add_common(command, arguments.common);
}

void add_features(CLI::App* command, VisionArguments& vision) {
  command
      ->add_option(
          "--ground", vision.ground,
          "Where the ground plane comes from: depth, images (triangulated features), or auto (images for the cameras "
          "whose depth shows too little ground)")
      ->check(one_of(ground_source_names()))
      ->capture_default_str();
  command
      ->add_option("--features", vision.features,
                   "Image features: sift, or onnx:FILE, a keypoint network laid out as SuperPoint")
      ->capture_default_str();
}

void add_vision(CLI::App* command, VisionArguments& vision) {
  add_features(command, vision);
  command->add_option(
      "--horizon", vision.horizon,
      "For sensorx2car: onnx:FILE, a network that gives horizon and vanishing point; default: geometry");
}

void add_observe(CLI::App& app, Action& action) {
  const auto [command, arguments] = add_command(
      app, action, "observe", "Detect corners and planes in a recording; write observations.json (kilobytes)",
      "rigproof observe monday/ -o monday.json", observe_command);
  command->add_option("INPUT", arguments.input, "Input: " + inputs_in_words(true))->required();
  command->add_option("-o,--output", arguments.output, "File; default observations.json in the input's folder");
  add_features(command, arguments.vision);
  add_jobs(command, arguments.common);
  add_common(command, arguments.common);
}

void add_accept(CLI::App* command, std::string& accept) {
  command
      ->add_option(
          "--accept", accept,
          "Check results without truth (stated uncertainty, two halves, held-out stops) against the limits in a file; "
          "`default` is the shipped one. The accept limits of rig.yaml are always checked, and replace the limits on "
          "uncertainty in the file")
      ->type_name("LIMITS");
}

void add_calibrate(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "calibrate", "Solve for the pose of every camera; write results/METHOD.yaml",
                  "rigproof calibrate monday/ --method joint_memroc", calibrate_command);
  command->add_option("INPUT", arguments.input, "Input: " + inputs_in_words(false))->required();
  command->add_option("-m,--method", arguments.methods, kMethodHelp)->type_name("METHOD");
  command->add_option("-o,--output", arguments.output, "Folder for the results; default results/ beside the input");
  add_vision(command, arguments.vision);
  add_accept(command, arguments.accept);
  command->add_option("--junit", arguments.junit,
                      "Also write the checks of --accept and of accept in rig.yaml as JUnit XML");
  add_jobs(command, arguments.common);
  add_common(command, arguments.common);
}

constexpr const char* kBudgetHelp =
    "Limits on the error: a file, or ci, paper, honest; default: 4 stated standard deviations. With a budget, a result "
    "that its own findings throw doubt on (SUSPECT) fails, too";
constexpr const char* kJunitHelp =
    "Also write the checks as JUnit XML; a result that its own findings throw doubt on (SUSPECT) fails";

void add_validate(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "validate", "Compare results with the truth of a run; gate on a budget",
                  "rigproof validate runs/demo theirs.yaml --budget ci.yaml --junit out.xml", validate_command);
  command->add_option("RUN", arguments.run, "Folder of a generated run, with its truth/")->required();
  command->add_option("RESULT", arguments.results, "Result files; default every one in the run's results/");
  command->add_option("--budget", arguments.budget, kBudgetHelp)->type_name("BUDGET");
  command->add_option("--junit", arguments.junit, kJunitHelp);
  command->add_flag("--paper", arguments.paper, "Also print the errors that the MEMROC paper published");
  add_common(command, arguments.common);
}

void add_run(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "run", "Generate, calibrate and validate, then draw the pictures and the report",
                  "rigproof run demo.yaml", run_command);
  add_generate_options(command, arguments.generate);
  command->add_option("-m,--method", arguments.methods, kMethodHelp)->type_name("METHOD");
  command->add_option("--budget", arguments.budget, kBudgetHelp)->type_name("BUDGET");
  add_vision(command, arguments.vision);
  add_accept(command, arguments.accept);
  command->add_option("--junit", arguments.junit, kJunitHelp);
}

void add_inspect(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "inspect", "Draw PNG pictures: mosaics, corners, reprojections, the drive, the rig",
                  "rigproof inspect runs/demo -o pictures", inspect_command);
  command->add_option("INPUT", arguments.input, "Input: " + inputs_in_words(true))->required();
  command->add_option("RESULT", arguments.results, "Result files to draw; default every one in results/");
  command->add_option("-o,--output", arguments.output, "Folder; default pictures/ beside the input");
  add_jobs(command, arguments.common);
  add_common(command, arguments.common);
}

void add_report(CLI::App& app, Action& action) {
  const auto [command, arguments] = add_command(
      app, action, "report", "Write one HTML file to look at: verdict, poses, uncertainty, the rig in 3-D, images",
      "rigproof report monday/ -o monday.html", report_command);
  command
      ->add_option("INPUT", arguments.inputs,
                   "With results: " + inputs_in_words(true) +
                       "; or the folder of a sweep; or several recordings of one rig, for its history")
      ->required();
  command->add_option("-o,--output", arguments.output,
                      "File; default report.html beside the input, history.html beside the last of several");
  command
      ->add_option("-m,--method", arguments.method,
                   "Result to show first, or whose history; default ml. All of results/ are in a report of one")
      ->type_name("METHOD");
  command
      ->add_option("--budget", arguments.budget,
                   "Limits on the error: a file, or ci, paper, honest; default: 4 stated standard deviations")
      ->type_name("BUDGET");
  add_jobs(command, arguments.common);
  add_common(command, arguments.common);
}

void add_convert(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "convert", "Turn a recording into a ROS 2 bag or the layout of another program, or back",
                  "rigproof convert runs/demo demo.mcap", convert_command);
  std::vector<std::string> layouts = writable_formats();
  layouts.emplace_back(kBagLayout);
  layouts.emplace_back(kArchiveLayout);
  command->add_option("INPUT", arguments.input, "Input: " + inputs_in_words(true))->required();
  command->add_option("OUTPUT", arguments.output, "A new folder, or a new file FILE.mcap")->required();
  command
      ->add_option("--to", arguments.to,
                   joined(layouts, ", ") + "; default mcap for FILE.mcap, else memroc, of other layouts recording")
      ->check(one_of(layouts));
  command
      ->add_option("--cloud-points", arguments.cloud_points,
                   "Limit on the points of a cloud that is made from a depth image")
      ->check(CLI::Range(100, 10000000))
      ->capture_default_str();
  add_shards(command, arguments.shard_mib);
  command->add_flag("--compressed", arguments.compressed,
                    "Pictures in a bag stay PNG or JPEG (CompressedImage); default: unpacked (Image)");
  command->add_option("--packing", arguments.packing, "Of a bag's chunks: " + joined(bag_packings(), ", "))
      ->check(one_of(bag_packings()))
      ->capture_default_str();
  add_common(command, arguments.common);
}

void add_doctor(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "doctor", "Check this machine (EGL, driver, versions), or the files of a run",
                  "rigproof doctor runs/demo", doctor_command);
  command->add_option("RUN", arguments.run, "Folder of a run: integrity of its files and proof of its conventions");
  add_device(command, arguments.device);
  add_common(command, arguments.common);
}

void add_board(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "board", "Write a board to print, at true size with rulers: PDF, SVG or DXF",
                  "rigproof board --squares 6x5 --square-mm 110 --paper a0 -o board.pdf", board_command);
  command
      ->add_option("PRESET", arguments.preset,
                   "As `rigproof boards` lists them; without it give --squares and --square-mm")
      ->type_name("BOARD");
  command->add_option("--type", arguments.type, "checkerboard, charuco or aprilgrid")->check(one_of(board_types()));
  command->add_option("--squares", arguments.squares, "Columns x rows of squares, e.g. 6x5");
  command->add_option("--square-mm", arguments.square_mm, "Side of a square")->check(number_in(1.0, 1000.0));
  command->add_option("--paper", arguments.paper, "Size of the page; fit: as large as the board needs")
      ->check(one_of(paper_names()))
      ->capture_default_str();
  command->add_option("--border-mm", arguments.border_mm, "White around the squares")
      ->check(number_in(0.0, 200.0))
      ->capture_default_str();
  command
      ->add_option("--printer-margin-mm", arguments.printer_margin_mm,
                   "What the printer leaves blank along each edge of a page")
      ->check(number_in(0.0, 50.0))
      ->capture_default_str();
  command->add_flag("--tiles", arguments.tiles,
                    "Spread a board that is larger than the paper over several pages to glue together");
  command->add_option("--overlap-mm", arguments.overlap_mm, "How far each tile reaches below the next one (10)")
      ->check(number_in(2.0, 50.0));
  command->add_option("-o,--output", arguments.output,
                      "File, .pdf, .svg or .dxf (both of one page); default board.pdf");
  add_common(command, arguments.common);
}

struct ListArguments {
  CommonArguments common;
  std::string kind;
};

void add_list(CLI::App& app, const std::string& kind, const std::string& description, Action& action) {
  const auto [command, arguments] =
      add_command<ListArguments>(app, action, kind, description, "rigproof " + kind,
                                 [](const ListArguments& list) { return list_command(list.common, list.kind); });
  arguments.kind = kind;
  add_common(command, arguments.common);
}

int sensors_command(const PlotSensorArguments& arguments) {
  return arguments.name.empty() ? list_command(arguments.common, "sensors") : plot_sensor_command(arguments);
}

void add_sensors(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "sensors", "The sensor presets; --plot draws the noise of one over distance",
                  "rigproof sensors --plot d455 -o d455.png", sensors_command);
  command->add_option("--plot", arguments.name, "Name of a preset: simulate its depth noise and draw it over distance")
      ->type_name("SENSOR");
  command->add_option("-o,--output", arguments.output,
                      "File of --plot: PNG, PDF or SVG; a CSV is written beside it. Default NAME_noise.png");
  add_common(command, arguments.common);
}

void add_scenes(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "scenes", "The worlds that a run can be set in; with names: try them out",
                  "rigproof scenes my_hall.yaml -o my_hall.jpg", scenes_command);
  command->add_option("SCENE", arguments.scenes,
                      "Render some stops and say whether board and ground are found; names or YAML files");
  command->add_option("-o,--output", arguments.output, "Picture of them (.jpg or .png); of all worlds without names");
  command->add_option("--poses", arguments.poses, "Stops to render in each")
      ->check(CLI::Range(4, 1000))
      ->capture_default_str();
  add_jobs(command, arguments.common);
  add_device(command, arguments.device);
  add_common(command, arguments.common);
}

void add_schema(CLI::App& app, Action& action) {
  const auto [command, name] =
      add_command(app, action, "schema", "Print the JSON Schema of a file that you write, for your editor",
                  "rigproof schema run > run.schema.json", schema_command);
  command->add_option("NAME", name, "Which file; without it the names are listed")->type_name("SCHEMA");
}

int print_text(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  return 0;
}

void add_completion(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("completion", "Print a script that completes the command line in bash, zsh or fish");
  command->footer("Example:\n  source <(rigproof completion bash)");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "For which shell")->required()->check(one_of(completion_shells()));
  command->callback([&app, &action, shell] {
    action = [&app, shell] { return print_text(completion_script(facts_of(app), *shell)); };
  });
}

void add_manual(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("manual", "Print the manual page, for man");
  command->footer("Example:\n  rigproof manual > rigproof.1; man ./rigproof.1");
  command->callback([&app, &action] { action = [&app] { return print_text(manual_page(facts_of(app))); }; });
}

// The command whose help answers the mistake: `rigproof calibrate` or `rigproof`.
std::string help_command(const CLI::App& app) {
  const std::vector<CLI::App*> given = app.get_subcommands();
  return "rigproof " + (given.empty() ? "" : given.front()->get_name() + " ") + "--help";
}

// Help lists them so.
void add_all_commands(CLI::App& app, Action& action) {
  auto group = [&app, first = std::size_t{0}](const char* name) mutable {
    const std::vector<CLI::App*> commands = app.get_subcommands(nullptr);
    for (; first < commands.size(); ++first) commands[first]->group(name);
  };
  add_board(app, action);
  add_record_check_command(app, action);
  add_init_command(app, action);
  add_observe(app, action);
  add_calibrate(app, action);
  add_inspect(app, action);
  add_report(app, action);
  add_uncertainty_commands(app, action);
  add_export_command(app, action);
  group("From a robot to its frames");
  add_run(app, action);
  add_generate(app, action);
  add_sense(app, action);
  add_validate(app, action);
  add_convert(app, action);
  group("Data whose truth is known");
  add_sweep_command(app, action);
  add_paper_command(app, action);
  add_bench_command(app, action);
  group("Experiments");
  add_list(app, "methods", "The calibration methods: what each needs and gives", action);
  add_scenes(app, action);
  add_list(app, "rigs", "The camera rigs", action);
  add_list(app, "robots", "The robots that rigs are mounted on", action);
  add_sensors(app, action);
  add_list(app, "boards", "The board presets", action);
  group("What there is to choose from");
  add_doctor(app, action);
  add_schema(app, action);
  add_completion(app, action);
  add_manual(app, action);
  group("The tool itself");
}

int run_main(int argc, char** argv) {
  CLI::App app{"Where is each camera on your robot, how sure are you, and prove it.", "rigproof"};
  app.set_version_flag("--version", std::string("rigproof ") + version());
  app.require_subcommand(1);
  app.footer(kExitCodes);
  app.get_formatter()->column_width(34);
  Action action;
  add_all_commands(app, action);
  if (argc < 2) {
    std::fputs(app.help().c_str(), stderr);
    return static_cast<int>(ExitCode::kBadInput);
  }
  check_names(app, {argv + 1, argv + argc});
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help or version
    throw Error(std::string(error.what()) + "\n`" + help_command(app) + "` shows what is allowed.");
  }
  if (std::getenv("RIGPROOF_PARSE_ONLY") != nullptr) return 0;  // tests of the documentation's commands
  install_interrupt_handler();
  const int exit_code = action();
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw Error("standard output: cannot be written");
  return exit_code;
}

}  // namespace
}  // namespace rigproof

int main(int argc, char** argv) {
  using rigproof::ExitCode;
  try {
    return rigproof::run_main(argc, argv);
  } catch (const rigproof::Error& error) {
    std::fprintf(stderr, "rigproof: %s\n", rigproof::words::message_of(error).c_str());
    return static_cast<int>(error.exit_code());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "rigproof: out of memory\n");
    return static_cast<int>(ExitCode::kBadInput);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rigproof: %s\n", error.what());
    return static_cast<int>(ExitCode::kBadInput);
  }
}
