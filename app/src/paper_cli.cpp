// The command line of `paper`.
#include <CLI/CLI.hpp>
#include <memory>

#include "paper_commands.h"
#include "rigproof/study/paper.h"

namespace rigproof {

void add_paper_command(CLI::App& app, std::function<int()>& action) {
  CLI::App* command =
      app.add_subcommand("paper", "The MEMROC paper's experiments anew: tables beside its own, figures");
  command->footer("Example:\n  rigproof paper table1 -o paper -j 2");
  auto arguments = std::make_shared<PaperArguments>();
  std::string names;
  for (const PaperExperiment& experiment : paper_experiments()) names += (names.empty() ? "" : ", ") + experiment.name;
  command->add_option("EXPERIMENT", arguments->experiment, names + "; without it they are listed");
  command->add_option("-o,--output", arguments->output,
                      "Folder: sweeps, tables and figures of all experiments; default paper. What is finished is kept");
  command->add_option("--config", arguments->config,
                      "A sweep of your own with the same axes in place of the shipped one, e.g. with fewer poses");
  command->add_option("--cache", arguments->cache, "Folder of pictures and answers; default cache in the output")
      ->envname("RIGPROOF_CACHE");
  command
      ->add_option("--set", arguments->set,
                   "Override a field of the sweep, e.g. --set run.poses=20 --set run.image_scale=0.5; may be repeated")
      ->type_name("FIELD=VALUE");
  command->add_flag("--dry-run", arguments->dry_run, "Only say what would be done and how long it takes");
  command->add_option("-j,--jobs", arguments->common.jobs, "Processes; 0 = one a core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_option("--device", arguments->device, "EGL device to render on, as `rigproof doctor` numbers them")
      ->check(CLI::Range(-2, 1024))
      ->capture_default_str();
  command->add_flag("-q,--quiet", arguments->common.quiet, "Print nothing but errors");
  command->add_flag("--json", arguments->common.json, "Print JSON for machines instead of text");
  command->callback([arguments, &action] { action = [arguments] { return paper_command(*arguments); }; });
}

}  // namespace rigproof
