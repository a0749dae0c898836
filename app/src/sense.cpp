// `rigproof sense`: another noise realisation of a run whose clean renders are kept.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "generating.h"
#include "json_text.h"
#include "rigproof/core/error.h"
#include "rigproof/study/sweep/run_config.h"

namespace rigproof {
namespace {

GenerateArguments generate_arguments(const SenseArguments& arguments) {
  GenerateArguments generate;
  generate.common = arguments.common;
  generate.set = arguments.set;
  if (arguments.seed >= 0) generate.set.push_back("sensing.seed=" + std::to_string(arguments.seed));
  generate.output = arguments.output;
  generate.cache = arguments.cache;
  generate.fresh = arguments.fresh;
  return generate;
}

}  // namespace

int sense_command(const SenseArguments& arguments) {
  const GenerateArguments generate = generate_arguments(arguments);
  if (generate.cache.empty())
    throw Error(
        "--cache: is missing: the folder that `rigproof generate --cache DIR` kept the clean renders in "
        "(or set RIGPROOF_CACHE)");
  const GenerateConfig config = sense_config(arguments.source, generate.set);
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  GenerateArguments from_cache = generate;
  from_cache.render = false;
  RunsAhead ahead({{from_cache, config}});
  const GenerateReport report = generate_with_progress(&ahead, 0, terminal);
  if (arguments.common.json) {
    const nlohmann::json json = {{"run", arguments.output.string()},
                                 {"images", report.images},
                                 {"bytes", report.bytes},
                                 {"seconds", report.seconds},
                                 {"seed", config.sensing.seed}};
    std::puts(json_text(json).c_str());
  }
  terminal.line("run        " + arguments.output.string());
  return 0;
}

}  // namespace rigproof
