// `rigproof schema`: every file that people and rigproof write has a schema, and real files keep to theirs.
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "cli_fixture.h"
#include "paths.h"
#include "rigproof/core/yaml.h"
#include "schema_check.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

json schema_of_file(const std::string& name) {
  const ProcessOutput output = rigproof_command({"schema", name});
  EXPECT_EQ(output.exit_code, 0) << name << ": " << output.err;
  return json::parse(output.out);
}

// Of a YAML or JSON file that was written without text that looks like a number.
json content_of(const fs::path& file) { return json::parse(emit_json(read_yaml_file(file, 64U << 20U))); }

std::vector<std::string> schema_names() {
  std::vector<std::string> names;
  std::istringstream lines(rigproof_command({"schema"}).out);
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("  ", 0) == 0) names.push_back(line.substr(2, line.find(' ', 2) - 2));
  return names;
}

TEST(Schema, EveryFileHasOneWithTitleAndVersion) {
  const std::vector<std::string> names = schema_names();
  for (const char* name : {"run",
                           "rig",
                           "sensor",
                           "board",
                           "scene",
                           "robot",
                           "sweep",
                           "budget",
                           "accept",
                           "external",
                           "ml",
                           "result",
                           "observations",
                           "manifest",
                           "truth",
                           "proof",
                           "calibrate_output",
                           "validate_output",
                           "observe_output",
                           "init_output",
                           "moved_output",
                           "suggest_output",
                           "doctor_output",
                           "generate_output",
                           "sense_output",
                           "sweep_start_output",
                           "paper_output",
                           "export",
                           "export_output",
                           "inspect_output",
                           "report_output",
                           "convert_output",
                           "scenes_scene_output",
                           "methods_output"})
    EXPECT_THAT(names, testing::Contains(name));
  for (const std::string& name : names) {
    const json schema = schema_of_file(name);
    EXPECT_EQ(schema["$schema"], "http://json-schema.org/draft-07/schema#") << name;
    EXPECT_GE(schema["version"], 1) << name;
    EXPECT_FALSE(schema["title"].get<std::string>().empty()) << name;
    EXPECT_TRUE(schema.contains("properties") || schema.contains("items")) << name;
  }
}

TEST(Schema, AnUnknownOneNamesTheNearest) {
  const ProcessOutput output = rigproof_command({"schema", "rigs"});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, AllOf(HasSubstr("there is none"), HasSubstr("did you mean \"rig\"?")));
}

TEST(Schema, FilesThatComeAlongKeepToTheirs) {
  const std::vector<std::pair<std::string, std::string>> folders = {
      {"models/rigs", "simulated_rig"}, {"models/sensors", "sensor"}, {"models/boards", "board"},
      {"models/robots", "robot"},       {"scenes", "scene"},          {"config/budgets", "budget"},
      {"config/accept", "accept"},      {"config/sweeps", "sweep"}};
  for (const auto& [folder, name] : folders) {
    const json schema = schema_of_file(name);
    int count = 0;
    for (const auto& entry : fs::directory_iterator(source_path(folder))) {
      if (entry.path().extension() != ".yaml") continue;
      EXPECT_EQ(schema_violations(content_of(entry.path()), schema), "") << entry.path();
      ++count;
    }
    EXPECT_GT(count, 0) << folder;
  }
}

TEST(Schema, WhatIsWrittenKeepsToTheirs) {
  const TempFolder scratch;
  const std::string run = small_run().string(), out = (scratch / "out").string();
  const std::string observations = (scratch / "observations.json").string();
  const auto expect_output = [](const std::vector<std::string>& command, const std::string& name) {
    std::vector<std::string> with_json = command;
    with_json.emplace_back("--json");
    const ProcessOutput output = rigproof_command(with_json);
    ASSERT_TRUE(json::accept(output.out)) << output.out << output.err;
    const json printed = json::parse(output.out);
    EXPECT_EQ(schema_violations(printed, schema_of_file(name)), "") << command.front();
    EXPECT_TRUE(printed.is_array() || printed.contains("version")) << command.front();
  };
  expect_output({"observe", run, "-o", observations}, "observe_output");
  expect_output({"convert", run, (scratch / "memroc").string()}, "convert_output");
  expect_output({"inspect", run, "-o", (scratch / "pictures").string()}, "inspect_output");
  expect_output({"doctor", run}, "doctor_run_output");
  expect_output({"board", "--squares", "6x5", "--square-mm", "50", "-o", (scratch / "board.pdf").string()},
                "board_output");
  expect_output({"methods"}, "methods_output");
  expect_output({"paper"}, "paper_output");
  expect_output({"calibrate", observations, "-m", "ml:focal_sigma_percent=1", "-o", out, "--accept", "default"},
                "calibrate_output");
  const std::string result = out + "/ml-focal_sigma_percent_1.yaml";
  expect_output({"validate", run, result}, "validate_output");
  const fs::path recording = copy_of_recording(scratch);
  ASSERT_EQ(rigproof_command({"calibrate", recording.string(), "-q"}).exit_code, 0);
  expect_output({"report", recording.string()}, "report_output");
  expect_output({"moved", observations, result}, "moved_output");
  expect_output({"suggest", observations, "--stops", "1"}, "suggest_output");
  expect_output({"record-check", run}, "record_check_output");
  const auto expect_file = [](const fs::path& file, const std::string& name) {
    EXPECT_EQ(schema_violations(content_of(file), schema_of_file(name)), "") << file;
  };
  expect_file(result, "result");
  expect_file(observations, "observations");
  expect_file(small_run() / "recording/rig.yaml", "rig");
  expect_file(small_run() / "run.yaml", "manifest");
  expect_file(small_run() / "truth/truth.yaml", "truth");
  expect_file(small_run() / "truth/config.yaml", "run");
}

// Copies for editors, and the page of the documentation.
TEST(Schema, ShippedCopiesAreCurrent) {
  const bool update = std::getenv("RIGPROOF_UPDATE_DOCS") != nullptr;
  const std::vector<std::pair<std::string, std::vector<std::string>>> copies = {
      {"config/schema/run.json", {"schema", "run"}},
      {"config/schema/rig.json", {"schema", "rig"}},
      {"docs/reference/configuration.md", {"schema", "all"}}};
  for (const auto& [file, command] : copies) {
    const std::string text = rigproof_command(command).out;
    if (update) write_whole_file(source_path(file), text);
    EXPECT_EQ(read_whole_file(source_path(file)), text) << file << ": write it anew: RIGPROOF_UPDATE_DOCS=1 test_app";
  }
}

}  // namespace
}  // namespace rigproof
