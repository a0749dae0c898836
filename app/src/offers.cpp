#include "offers.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>

#include "commands.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/yaml.h"
#include "rigproof/study/report/paper.h"

namespace rigproof {
namespace {

using Names = std::vector<std::string>;

template <typename Things, typename Name>
Names names_of(const Things& things, const Name& name) {
  Names names;
  std::transform(things.begin(), things.end(), std::back_inserter(names), name);
  return names;
}

// What a file of config/ describes shows in its keys.
Names configurations(bool sweeps) {
  Names names;
  for (const std::string& name : list_presets("config")) {
    if (name.rfind("budgets/", 0) == 0 || name.rfind("accept/", 0) == 0) continue;
    const YamlTree tree = read_yaml_file(find_preset("config", name));
    const auto has = [&tree](const char* key) { return tree.find(key) != nullptr; };
    if (!has("command") && (has("axes") || has("methods")) == sweeps) names.push_back(name);
  }
  return names;
}

std::map<std::string, std::function<Names()>> all_offers() {
  const auto presets = [](const char* kind) { return [kind] { return list_presets(kind); }; };
  const auto below = [](const char* folder) { return [folder] { return list_presets("config", folder); }; };
  const auto method_names = [] {
    return names_of(all_methods(), [](const Method* method) { return method->traits().name; });
  };
  const auto experiments = [] {
    return names_of(paper_experiments(), [](const PaperExperiment& experiment) { return experiment.name; });
  };
  return {{"BOARD", presets("boards")},
          {"SENSOR", presets("sensors")},
          {"SCENE", presets("scenes")},
          {"RUN", [] { return configurations(false); }},
          {"SWEEP", [] { return configurations(true); }},
          {"CASE", [] { return bench_cases(); }},
          {"BUDGET", below("budgets")},
          {"LIMITS", below("accept")},
          {"METHOD", method_names},
          {"SCHEMA", schema_names},
          {"EXPERIMENT", experiments}};
}

}  // namespace

std::vector<std::string> offers_of(const std::string& type) {
  const auto offers = all_offers();
  const auto found = offers.find(type.substr(type.rfind(']') + 1));
  if (found == offers.end()) return {};
  try {
    return found->second();
  } catch (const Error&) {
    return {};  // a shell that starts wants no message
  }
}

bool may_be_file(const std::string& type) { return type != "SCHEMA" && type != "EXPERIMENT"; }

}  // namespace rigproof
