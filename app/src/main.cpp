// The `rigproof` command: parses the command line and calls one function of commands.h. The only place that includes
// CLI11, and the only one that turns exceptions into messages and exit codes.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <functional>
#include <new>
#include <string>
#include <vector>

#include "commands.h"
#include "number_in.h"
#include "paper_commands.h"
#include "rigproof/calib/ground_source.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/core/version.h"
#include "rigproof/sim/board_pattern.h"
#include "rigproof/sim/board_pdf.h"
#include "sweep_commands.h"
#include "terminal.h"
#include "uncertainty_commands.h"

namespace rigproof {
namespace {

constexpr const char* kExitCodes =
    "Exit codes: 0 good, 1 a gate failed, 2 bad input or environment, 3 refused (the data cannot answer),\n"
    "75 try again (interrupted; the same command resumes).";

constexpr const char* kMethodHelp =
    "As `rigproof methods` lists them; ml:KEY=VALUE,.. or ml:FILE.yaml (`rigproof schema ml`: priors of focal length, "
    "principal point, clock offset); external:FILE.yaml; may be repeated";

using Action = std::function<int()>;

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      const std::string& example) {
  CLI::App* command = app.add_subcommand(name, description);
  command->footer("Example:\n  " + example);
  return command;
}

void add_common(CLI::App* command, CommonArguments& common) {
  command->add_flag("-q,--quiet", common.quiet, "Print nothing but errors");
  command->add_flag("--json", common.json, "Print JSON for machines instead of text");
}

void add_jobs(CLI::App* command, CommonArguments& common) {
  command->add_option("-j,--jobs", common.jobs, "Processes or threads; 0 = one a core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

void add_device(CLI::App* command, int& device) {
  command
      ->add_option("--device", device,
                   "EGL device to render on, as `rigproof doctor` numbers them; -1 = Mesa in software, -2 = best")
      ->check(CLI::Range(-2, 1024))
      ->capture_default_str();
}

void add_cache(CLI::App* command, std::filesystem::path& cache) {
  command->add_option("--cache", cache, "Folder of clean renders: what it holds is not rendered again")
      ->envname("RIGPROOF_CACHE");
}

void add_generate_options(CLI::App* command, GenerateArguments& arguments) {
  command->add_option("CONFIG", arguments.config,
                      "Configuration file, or the name of a shipped one; without it every default applies");
  command->add_option("-o,--output", arguments.output, "Folder of the run; default runs/<name of the config>");
  command
      ->add_option("--set", arguments.set,
                   "Override a field, e.g. --set poses=20 --set odometry.lambda=5; may be repeated")
      ->type_name("FIELD=VALUE");
  command->add_flag("--fresh", arguments.fresh, "Delete what is in the output and start over; default is to resume");
  add_cache(command, arguments.cache);
  command->add_flag("--dry-run", arguments.dry_run,
                    "Only say how many images, of how many pictures, MB and minutes it would take");
  add_jobs(command, arguments.common);
  add_device(command, arguments.device);
  add_common(command, arguments.common);
}

void add_generate(CLI::App& app, Action& action) {
  CLI::App* command = add_command(app, "generate", "Render a run: images, depth, odometry, and the truth apart",
                                  "rigproof generate demo.yaml -o runs/demo");
  auto arguments = std::make_shared<GenerateArguments>();
  add_generate_options(command, *arguments);
  command->callback([arguments, &action] { action = [arguments] { return generate_command(*arguments); }; });
}

void add_sense(CLI::App& app, Action& action) {
  CLI::App* command = add_command(app, "sense", "Make another noise realisation of a run from its clean renders",
                                  "rigproof sense runs/demo --cache cache --seed 7 -o runs/demo_7");
  auto arguments = std::make_shared<SenseArguments>();
  command->add_option("SOURCE", arguments->source, "A run that was generated with --cache, or its configuration")
      ->required();
  command->add_option("-o,--output", arguments->output, "Folder of the new run")->required();
  add_cache(command, arguments->cache);
  command->add_option("--seed", arguments->seed, "Seed of noise, devices and odometry; default as in the source")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{9007199254740992}));
  command
      ->add_option("--set", arguments->set,
                   "Override a sense key, e.g. --set sensing.depth.edges=true; may be repeated")
      ->type_name("FIELD=VALUE");
  command->add_flag("--fresh", arguments->fresh, "Delete what is in the output and start over; default is to resume");
  add_jobs(command, arguments->common);
  add_common(command, arguments->common);
  command->callback([arguments, &action] { action = [arguments] { return sense_command(*arguments); }; });
}

void add_features(CLI::App* command, VisionArguments& vision) {
  command
      ->add_option("--ground", vision.ground,
                   "Where the ground comes from: depth; images: triangulated features; auto: images for cameras whose "
                   "depth shows too little of it")
      ->check(CLI::IsMember(ground_source_names()))
      ->capture_default_str();
  command
      ->add_option("--features", vision.features, "Of images: sift, or onnx:FILE, a keypoint network like SuperPoint")
      ->capture_default_str();
}

void add_vision(CLI::App* command, VisionArguments& vision) {
  add_features(command, vision);
  command->add_option("--horizon", vision.horizon,
                      "For sensorx2car: onnx:FILE, a network that sees horizon and vanishing point; default geometry");
}

void add_observe(CLI::App& app, Action& action) {
  CLI::App* command =
      add_command(app, "observe", "Detect corners and planes in a recording; write observations.json (kilobytes)",
                  "rigproof observe monday/ -o monday.json");
  auto arguments = std::make_shared<ObserveArguments>();
  command->add_option("INPUT", arguments->input, "A run, a recording, or a folder in the MEMROC layout")->required();
  command->add_option("-o,--output", arguments->output, "File; default observations.json in the input's folder");
  add_features(command, arguments->vision);
  add_jobs(command, arguments->common);
  add_common(command, arguments->common);
  command->callback([arguments, &action] { action = [arguments] { return observe_command(*arguments); }; });
}

void add_accept(CLI::App* command, std::string& accept) {
  command->add_option(
      "--accept", accept,
      "Gates that need no truth (uncertainty, halves, prediction): a file, or default. The rig's accept limits "
      "the uncertainty by itself, and instead of the file");
}

void add_calibrate(CLI::App& app, Action& action) {
  CLI::App* command = add_command(app, "calibrate", "Solve for the pose of every camera; write results/METHOD.yaml",
                                  "rigproof calibrate monday/ --method joint_memroc");
  auto arguments = std::make_shared<CalibrateArguments>();
  command
      ->add_option("INPUT", arguments->input,
                   "A run, a recording, an observations.json, or a folder in the MEMROC layout")
      ->required();
  command->add_option("-m,--method", arguments->methods, kMethodHelp);
  command->add_option("-o,--output", arguments->output, "Folder for the results; default results/ beside the input");
  add_vision(command, arguments->vision);
  add_accept(command, arguments->accept);
  command->add_option("--junit", arguments->junit,
                      "Also write the gates of --accept and of the rig's accept key as JUnit XML");
  add_jobs(command, arguments->common);
  add_common(command, arguments->common);
  command->callback([arguments, &action] { action = [arguments] { return calibrate_command(*arguments); }; });
}

void add_validate(CLI::App& app, Action& action) {
  CLI::App* command = add_command(app, "validate", "Compare results with the truth of a run; gate on a budget",
                                  "rigproof validate runs/demo theirs.yaml --budget ci.yaml --junit out.xml");
  auto arguments = std::make_shared<ValidateArguments>();
  command->add_option("RUN", arguments->run, "Folder of a generated run, with its truth/")->required();
  command->add_option("RESULT", arguments->results, "Result files; default every one in the run's results/");
  command->add_option("--budget", arguments->budget,
                      "Limits on the error: a file, or ci, paper, honest; default 4 of the stated sigmas");
  command->add_option("--junit", arguments->junit, "Also write the checks as JUnit XML");
  command->add_flag("--paper", arguments->paper, "Print the numbers published for the paper's methods beside");
  add_common(command, arguments->common);
  command->callback([arguments, &action] { action = [arguments] { return validate_command(*arguments); }; });
}

void add_run(CLI::App& app, Action& action) {
  CLI::App* command =
      add_command(app, "run", "Generate, calibrate and validate, then draw the pictures", "rigproof run demo.yaml");
  auto arguments = std::make_shared<RunArguments>();
  add_generate_options(command, arguments->generate);
  command->add_option("-m,--method", arguments->methods, kMethodHelp);
  command->add_option("--budget", arguments->budget,
                      "Limits on the error: a file, or ci, paper, honest; default 4 of the stated sigmas");
  add_vision(command, arguments->vision);
  add_accept(command, arguments->accept);
  command->add_option("--junit", arguments->junit, "Also write the checks as JUnit XML");
  command->callback([arguments, &action] { action = [arguments] { return run_command(*arguments); }; });
}

void add_inspect(CLI::App& app, Action& action) {
  CLI::App* command = add_command(app, "inspect", "Draw PNG pictures: mosaics, corners, reprojections, the drive",
                                  "rigproof inspect runs/demo -o pictures");
  auto arguments = std::make_shared<InspectArguments>();
  command->add_option("INPUT", arguments->input, "A run, a recording, or a folder in the MEMROC layout")->required();
  command->add_option("RESULT", arguments->results, "Result files to draw; default every one in results/");
  command->add_option("-o,--output", arguments->output, "Folder; default pictures/ beside the input");
  add_jobs(command, arguments->common);
  add_common(command, arguments->common);
  command->callback([arguments, &action] { action = [arguments] { return inspect_command(*arguments); }; });
}

void add_convert(CLI::App& app, Action& action) {
  CLI::App* command =
      add_command(app, "convert", "Turn a recording into the layout of the MEMROC authors' program, or back",
                  "rigproof convert runs/demo for_memroc/");
  auto arguments = std::make_shared<ConvertArguments>();
  command->add_option("INPUT", arguments->input, "A run, a recording, or a folder in the MEMROC layout")->required();
  command->add_option("OUTPUT", arguments->output, "A new folder")->required();
  command->add_option("--to", arguments->to, "memroc or recording; default the one that the input is not")
      ->check(CLI::IsMember({"memroc", "recording"}));
  command->add_option("--cloud-points", arguments->cloud_points, "Most points of a cloud that a depth image becomes")
      ->check(CLI::Range(100, 10000000))
      ->capture_default_str();
  add_common(command, arguments->common);
  command->callback([arguments, &action] { action = [arguments] { return convert_command(*arguments); }; });
}

void add_doctor(CLI::App& app, Action& action) {
  CLI::App* command = add_command(app, "doctor", "Check this machine (EGL, driver, versions), or the files of a run",
                                  "rigproof doctor runs/demo");
  auto arguments = std::make_shared<DoctorArguments>();
  command->add_option("RUN", arguments->run, "Folder of a run: integrity of its files and proof of its conventions");
  add_device(command, arguments->device);
  add_common(command, arguments->common);
  command->callback([arguments, &action] { action = [arguments] { return doctor_command(*arguments); }; });
}

void add_board(CLI::App& app, Action& action) {
  CLI::App* command = add_command(app, "board", "Write a board to print, as PDF at true size with a ruler",
                                  "rigproof board --squares 6x5 --square-mm 110 --paper a1 -o board.pdf");
  auto arguments = std::make_shared<BoardArguments>();
  command->add_option("PRESET", arguments->preset, "As `rigproof boards` lists them; or give the options below");
  command->add_option("--type", arguments->type, "checkerboard, charuco or aprilgrid")
      ->check(CLI::IsMember(board_types()));
  command->add_option("--squares", arguments->squares, "Columns x rows of squares, e.g. 6x5");
  command->add_option("--square-mm", arguments->square_mm, "Side of a square")->check(number_in(1.0, 1000.0));
  command->add_option("--paper", arguments->paper, "fit: as large as the board needs")
      ->check(CLI::IsMember(paper_names()))
      ->capture_default_str();
  command->add_option("--border-mm", arguments->border_mm, "White around the squares")
      ->check(number_in(0.0, 200.0))
      ->capture_default_str();
  command->add_option("-o,--output", arguments->output, "File; default board.pdf");
  add_common(command, arguments->common);
  command->callback([arguments, &action] { action = [arguments] { return board_command(*arguments); }; });
}

void add_list(CLI::App& app, const std::string& kind, const std::string& description, Action& action) {
  CLI::App* command = add_command(app, kind, description, "rigproof " + kind);
  auto common = std::make_shared<CommonArguments>();
  add_common(command, *common);
  command->callback([common, kind, &action] { action = [common, kind] { return list_command(*common, kind); }; });
}

void add_sensors(CLI::App& app, Action& action) {
  CLI::App* command = add_command(app, "sensors", "The sensor presets; --plot draws the noise of one over distance",
                                  "rigproof sensors --plot d455 -o d455.png");
  auto arguments = std::make_shared<PlotSensorArguments>();
  command->add_option("--plot", arguments->name, "Preset whose depth noise is simulated and drawn");
  command->add_option("-o,--output", arguments->output, "PNG file of --plot; default NAME_noise.png");
  add_common(command, arguments->common);
  command->callback([arguments, &action] {
    action = [arguments] {
      return arguments->name.empty() ? list_command(arguments->common, "sensors") : plot_sensor_command(*arguments);
    };
  });
}

void add_scenes(CLI::App& app, Action& action) {
  CLI::App* command = add_command(app, "scenes", "The worlds that a run can be set in; with names: try them out",
                                  "rigproof scenes my_hall.yaml -o my_hall.jpg");
  auto arguments = std::make_shared<ScenesArguments>();
  command->add_option("SCENE", arguments->scenes,
                      "Render some stops and say whether board and ground are found; names or YAML files");
  command->add_option("-o,--output", arguments->output, "Picture of them (.jpg or .png); of all worlds without names");
  command->add_option("--poses", arguments->poses, "Stops to render in each")
      ->check(CLI::Range(4, 1000))
      ->capture_default_str();
  add_jobs(command, arguments->common);
  add_device(command, arguments->device);
  add_common(command, arguments->common);
  command->callback([arguments, &action] { action = [arguments] { return scenes_command(*arguments); }; });
}

void add_schema(CLI::App& app, Action& action) {
  CLI::App* command = add_command(app, "schema", "Print the JSON Schema of a file that you write, for your editor",
                                  "rigproof schema run > run.schema.json");
  auto name = std::make_shared<std::string>();
  command->add_option("NAME", *name, "Which file; without it the names are listed");
  command->callback([name, &action] { action = [name] { return schema_command(*name); }; });
}

// CLI11 would only say that a command is missing.
void check_command_name(const CLI::App& app, const std::string& name) {
  if (name.empty() || name[0] == '-') return;
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands(nullptr)) known.push_back(command->get_name());
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  throw Error("\"" + for_message(name) + "\": there is no such command; " + suggestion(name, known));
}

// The command whose help answers the mistake: `rigproof calibrate` or `rigproof`.
std::string help_command(const CLI::App& app) {
  const std::vector<CLI::App*> given = app.get_subcommands();
  return "rigproof " + (given.empty() ? "" : given.front()->get_name() + " ") + "--help";
}

int run_main(int argc, char** argv) {
  CLI::App app{"Where is each camera on your robot, how sure are you, and prove it.", "rigproof"};
  app.set_version_flag("--version", std::string("rigproof ") + version());
  app.require_subcommand(1);
  app.footer(kExitCodes);
  app.get_formatter()->column_width(34);
  Action action;
  add_run(app, action);
  add_generate(app, action);
  add_sense(app, action);
  add_observe(app, action);
  add_calibrate(app, action);
  add_validate(app, action);
  add_sweep_command(app, action);
  add_paper_command(app, action);
  add_uncertainty_commands(app, action);
  add_inspect(app, action);
  add_convert(app, action);
  add_doctor(app, action);
  add_board(app, action);
  add_list(app, "methods", "The calibration methods: what each needs and gives", action);
  add_scenes(app, action);
  add_list(app, "rigs", "The camera rigs", action);
  add_sensors(app, action);
  add_list(app, "boards", "The board presets", action);
  add_schema(app, action);
  if (argc < 2) {
    std::fputs(app.help().c_str(), stderr);
    return static_cast<int>(ExitCode::kBadInput);
  }
  check_command_name(app, argv[1]);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help or version
    throw Error(std::string(error.what()) + "\n`" + help_command(app) + "` shows what is allowed.");
  }
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
    std::fprintf(stderr, "rigproof: %s\n", error.what());
    return static_cast<int>(error.exit_code());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "rigproof: out of memory\n");
    return static_cast<int>(ExitCode::kBadInput);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rigproof: %s\n", error.what());
    return static_cast<int>(ExitCode::kBadInput);
  }
}
