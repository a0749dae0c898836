// The command line of `bench`.
#include "command_line.h"
#include "one_of.h"
#include "rigproof/core/text.h"

namespace rigproof {

void add_bench_command(CLI::App& app, Action& action) {
  CLI::App* bench = app.add_subcommand("bench", "Hand the frozen cases of bench-v1 to other calibrators");
  bench->require_subcommand(1);
  bench->footer("Example:\n  rigproof bench export clean_lab --to mrcal");
  const auto [command, arguments] = add_command(
      *bench, action, "export", "Write a case in another program's layout, with what to run on it; the truth apart",
      "rigproof bench export clean_lab --to colmap --set seed=2 -o clean_lab_2", bench_export_command,
      "OUTPUT/LAYOUT has data/, README.md (commands by the program's manual) and SHA256SUMS; OUTPUT/truth.yaml is for\n"
      "`validate` and score.py, OUTPUT/run the run that it was made of. config/bench-v1/README.md\n");
  command->add_option("CASE", arguments.name, "A case of bench-v1, which is generated; or the folder of a run")
      ->required();
  command->add_option("--to", arguments.to, joined(bench_layouts(), ", "))->check(one_of(bench_layouts()))->required();
  command->add_option("-o,--output", arguments.output, "Folder for all layouts of the case; default bench/CASE");
  add_overrides(command, arguments.set, "Override a field of the case, e.g. --set seed=2; may be repeated");
  add_cache(command, arguments.cache, "Folder that keeps clean renders; what it holds is not rendered again");
  add_jobs(command, arguments.common);
  add_device(command, arguments.device);
  add_common(command, arguments.common);
}

}  // namespace rigproof
