// `rigproof sense`: another noise realisation of a run whose clean renders are kept.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "generating.h"
#include "json_text.h"
#include "rigproof/core/error.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/core/text.h"
#include "rigproof/generator/parameters.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// The resolved configuration of a run, or a configuration file.
fs::path config_of(const fs::path& source) {
  const RunFolder run{source};
  if (!fs::is_directory(source)) return source;
  if (fs::is_regular_file(run.config_file())) return run.config_file();
  throw Error(source.string() + ": is no run: it holds no truth/config.yaml; give a run or a configuration");
}

GenerateArguments generate_arguments(const SenseArguments& arguments) {
  GenerateArguments generate;
  generate.common = arguments.common;
  generate.config = config_of(arguments.source).string();
  generate.set = arguments.set;
  if (arguments.seed >= 0) generate.set.push_back("sensing.seed=" + std::to_string(arguments.seed));
  generate.output = arguments.output;
  generate.cache = arguments.cache;
  generate.fresh = arguments.fresh;
  return generate;
}

void refuse_render_keys(const GenerateArguments& generate, const GenerateConfig& changed) {
  GenerateArguments as_it_is = generate;
  as_it_is.set.clear();
  const std::vector<std::string> keys = changed_render_keys(configuration_of(as_it_is), changed);
  if (keys.empty()) return;
  throw Error("--set " + joined(keys) + ": " + (keys.size() == 1 ? "is a render key" : "are render keys") +
              ": what they change has to be rendered; use `rigproof generate --cache`");
}

}  // namespace

int sense_command(const SenseArguments& arguments) {
  const GenerateArguments generate = generate_arguments(arguments);
  if (generate.cache.empty())
    throw Error(
        "--cache: is missing: the folder that `rigproof generate --cache DIR` kept the clean renders in "
        "(or set RIGPROOF_CACHE)");
  const GenerateConfig config = configuration_of(generate);
  refuse_render_keys(generate, config);
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
