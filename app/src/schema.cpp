// `rigproof schema`.
#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>

#include "commands.h"
#include "rigproof/calib/accept.h"
#include "rigproof/calib/ml_settings.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/fields.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/generator/config.h"
#include "rigproof/study/external.h"
#include "rigproof/study/sweep_config.h"
#include "rigproof/validate/budget.h"

namespace rigproof {
namespace {

constexpr const char* kSuffix = ".schema.json";

// Made from the declarations of the fields, so that they cannot fall behind the program.
const std::map<std::string, std::function<std::string()>>& generated_schemas() {
  static const std::map<std::string, std::function<std::string()>> schemas = {
      {"run",
       [] {
         GenerateConfig config;
         return schema_of_fields("Rigproof run", [&config](FieldVisitor& visitor) { config.visit(visitor); });
       }},
      {"budget", budget_schema},
      {"accept", accept_criteria_schema},
      {"external", external_config_schema},
      {"ml", ml_settings_schema},
      {"sweep", sweep_config_schema}};
  return schemas;
}

std::filesystem::path schema_folder() { return data_folder() / "config" / "schema"; }

std::vector<std::string> schema_names() {
  std::vector<std::string> names;
  for (const auto& [name, make] : generated_schemas()) names.push_back(name);
  const std::string suffix = kSuffix;
  if (std::filesystem::is_directory(schema_folder())) {
    for (const auto& entry : std::filesystem::directory_iterator(schema_folder())) {
      const std::string file = entry.path().filename().string();
      if (file.size() <= suffix.size() || file.substr(file.size() - suffix.size()) != suffix) continue;
      names.push_back(file.substr(0, file.size() - suffix.size()));
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::string without_last_line_feed(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

}  // namespace

int schema_command(const std::string& name) {
  const std::vector<std::string> names = schema_names();
  if (name.empty()) {
    for (const std::string& known : names) std::puts(known.c_str());
    return 0;
  }
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw Error("schema " + for_message(name) + ": there is none; " + suggestion(name, names));
  const auto generated = generated_schemas().find(name);
  const std::string text =
      generated != generated_schemas().end() ? generated->second() : read_text_file(schema_folder() / (name + kSuffix));
  std::puts(without_last_line_feed(text).c_str());
  return 0;
}

}  // namespace rigproof
