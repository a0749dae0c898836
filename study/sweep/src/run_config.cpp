#include "rigproof/study/sweep/run_config.h"

#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/includes.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/core/text.h"
#include "rigproof/generator/parameters.h"
#include "rigproof/study/workflow/overrides.h"
#include "unused_overrides.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOverridesName = "--set";

// The resolved configuration of a run, or a configuration file.
fs::path config_of(const fs::path& source) {
  const RunFolder run{source};
  if (!fs::is_directory(source)) return source;
  if (fs::is_regular_file(run.config_file())) return run.config_file();
  throw Error(source.string() + ": is no run: it holds no truth/config.yaml; give a run or a configuration");
}

}  // namespace

GenerateConfig run_config(const std::string& config_file, const std::vector<std::string>& set) {
  const bool has_file = !config_file.empty();
  const fs::path file = has_file ? fs::absolute(find_data_file("config", config_file)) : fs::path();
  GenerateConfig config = has_file ? load_generate_config(file) : parse_generate_config("", "default");
  if (set.empty()) return config;
  YamlTree tree = has_file ? resolve_includes(read_yaml_file(file)) : YamlTree::map();
  merge_into(&tree, parse_yaml(overrides_as_yaml(set), kOverridesName));
  GenerateConfig changed;
  read_fields_of_tree(tree, [&changed](FieldVisitor& visitor) { changed.visit(visitor); });
  refuse_unused(set, changed);
  if (changed.name.empty()) changed.name = config.name;
  return changed;
}

GenerateConfig sense_config(const fs::path& source, const std::vector<std::string>& set) {
  const std::string file = config_of(source).string();
  const GenerateConfig changed = run_config(file, set);
  const std::vector<std::string> keys = changed_render_keys(run_config(file, {}), changed);
  if (keys.empty()) return changed;
  throw Error("--set " + joined(keys) + ": " + (keys.size() == 1 ? "is a render key" : "are render keys") +
              ": what they change has to be rendered; use `rigproof generate --cache`");
}

}  // namespace rigproof
