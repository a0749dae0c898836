// The command line of `paper`.
#include "command_line.h"
#include "rigproof/study/report/paper.h"

namespace rigproof {

void add_paper_command(CLI::App& app, Action& action) {
  const auto [command, arguments] =
      add_command(app, action, "paper", "Make the MEMROC paper's tables and figures anew, beside its own numbers",
                  "rigproof paper table1 -o paper -j 2", paper_command);
  std::string names;
  for (const PaperExperiment& experiment : paper_experiments()) names += (names.empty() ? "" : ", ") + experiment.name;
  command->add_option("EXPERIMENT", arguments.experiment, names + "; without it they are listed");
  command->add_option("-o,--output", arguments.output,
                      "Folder: sweeps, tables and figures of all experiments; default paper. What is finished is kept");
  command->add_option("--config", arguments.config,
                      "A sweep of your own with the same axes, instead of the shipped one");
  add_cache(command, arguments.cache, "Folder of pictures and answers; default cache in the output");
  add_overrides(command, arguments.set,
                "Override a field of the sweep, e.g. --set run.poses=20 --set run.image_scale=0.5; may be repeated");
  command->add_flag("--dry-run", arguments.dry_run, "Only say what would be done and how long it takes");
  add_jobs(command, arguments.common, "Processes; 0 = one for each core");
  add_device(command, arguments.device);
  add_common(command, arguments.common);
}

}  // namespace rigproof
