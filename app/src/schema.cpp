// `rigproof schema`.
#include <cstdio>
#include <functional>

#include "commands.h"
#include "output_schemas.h"
#include "rigproof/calib/diagnose/ml_settings.h"
#include "rigproof/calib/plan/accept.h"
#include "rigproof/core/error.h"
#include "rigproof/core/fields.h"
#include "rigproof/core/file_schemas.h"
#include "rigproof/core/text.h"
#include "rigproof/generator/config.h"
#include "rigproof/generator/sensor_device.h"
#include "rigproof/sim/model_schemas.h"
#include "rigproof/study/export/export.h"
#include "rigproof/study/sweep/config.h"
#include "rigproof/study/workflow/external.h"
#include "rigproof/truth/truth_schema.h"
#include "rigproof/validate/budget.h"
#include "rigproof/validate/proof.h"

namespace rigproof {
namespace {

std::string sensor_file_schema() {
  SensorDevice device;
  return sensor_schema([&device](FieldVisitor& visitor) { device.visit(visitor); });
}

struct FileSchema {
  std::string name;
  std::string summary;
  std::function<std::string()> make;
};

// What a person writes.
const std::vector<FileSchema> kWritten = {
    {"run", "a run: what `generate`, `sense` and `run` take", generate_config_schema},
    {"rig", "rig.yaml: cameras, board and odometry of a recording", rig_schema},
    {"accept", "limits on what `calibrate` states: --accept", accept_criteria_schema},
    {"budget", "limits on the error: `validate --budget`", budget_schema},
    {"ml", "settings of the method ml: ml:FILE.yaml", ml_settings_schema},
    {"external", "a method from outside: external:FILE.yaml", external_config_schema},
    {"sweep", "what `sweep start` takes", sweep_config_schema},
    {"board", "models/boards/NAME.yaml", board_schema},
    {"sensor", "models/sensors/NAME.yaml", sensor_file_schema},
    {"simulated_rig", "models/rigs/NAME.yaml: cameras on a robot", rig_model_schema},
    {"robot", "models/robots/NAME.yaml", robot_schema},
    {"scene", "scenes/NAME.yaml", scene_schema}};

std::vector<FileSchema> all_produced() {
  std::vector<FileSchema> schemas = {
      {"result", "results/METHOD.yaml", result_schema},     {"observations", "observations.json", observations_schema},
      {"export", "`export --to json`", export_json_schema}, {"manifest", "run.yaml of a run", manifest_schema},
      {"truth", "truth/truth.yaml of a run", truth_schema}, {"proof", "truth/proof.yaml of a run", proof_schema}};
  for (const OutputSchema& output : output_schemas())
    schemas.push_back(
        {name_of(output), "`" + output.command + " --json`" + output.note, [output] { return schema_of(output); }});
  return schemas;
}

// What the program writes.
const std::vector<FileSchema>& produced() {
  static const std::vector<FileSchema> schemas = all_produced();
  return schemas;
}

const char* const kAll = "all";
const char* const kWrittenTitle = "What you write";
const char* const kProducedTitle = "What rigproof writes";

const FileSchema& find_schema(const std::string& name) {
  for (const auto* list : {&kWritten, &produced()})
    for (const FileSchema& schema : *list)
      if (name == schema.name) return schema;
  throw Error("schema " + for_message(name) + ": there is none; " + suggestion(name, schema_names()));
}

void list_schemas() {
  for (const auto& [title, list] : {std::pair(kWrittenTitle, &kWritten), std::pair(kProducedTitle, &produced())}) {
    std::printf("%s\n", title);
    for (const FileSchema& schema : *list) std::printf("  %-29s%s\n", schema.name.c_str(), schema.summary.c_str());
  }
  std::printf("%s prints a table of every key of all of them, in Markdown\n", kAll);
}

std::string page_of(const FileSchema& schema) {
  const YamlTree tree = parse_yaml(schema.make(), schema.name);
  const YamlTree* include = tree.find("properties") == nullptr ? nullptr : tree.find("properties")->find("include");
  return "\n### " + schema.name + "\n\n" + tree.find("title")->scalar + ", version " + tree.find("version")->scalar +
         ". " + schema.summary + "." + (include == nullptr ? "" : " `include: FILE` takes another file first.") +
         "\n\n" + field_table(tree);
}

}  // namespace

std::string schema_reference_page() {
  std::string page =
      "# Files: every key\n\nMade by `rigproof schema all` from the descriptions that the program reads and "
      "writes its files by; a test keeps it current. `rigproof schema NAME` prints the JSON Schema of a file for your "
      "editor. "
      "In "
      "keys, NAME stands for a name of yours and [] for each element of a list. A distribution is a number, "
      "`{uniform: [a, b]}`, `{normal: {mean: m, stddev: s}}` or `{choice: [..]}`.\n";
  for (const auto& [title, list] : {std::pair(kWrittenTitle, &kWritten), std::pair(kProducedTitle, &produced())}) {
    page += std::string("\n## ") + title + "\n";
    for (const FileSchema& schema : *list) page += page_of(schema);
  }
  return page;
}

std::vector<std::string> schema_names() {
  std::vector<std::string> names;
  for (const auto* list : {&kWritten, &produced()})
    for (const FileSchema& schema : *list) names.push_back(schema.name);
  names.emplace_back(kAll);
  return names;
}

int schema_command(const std::string& name) {
  if (name == kAll)
    std::fputs(schema_reference_page().c_str(), stdout);
  else if (name.empty())
    list_schemas();
  else
    std::fputs(find_schema(name).make().c_str(), stdout);
  return 0;
}

}  // namespace rigproof
