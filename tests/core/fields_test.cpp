#include "rigproof/core/fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "error_text.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

struct Wheel {
  std::string name = "wheel";
  double radius_m = 0.165;
  void visit(FieldVisitor& v) {
    v.field("name", name, {}, "Name of the wheel.");
    v.field("radius_m", radius_m, {0.01, 2.0}, "Radius.");
  }
};

struct Odometry {
  std::string model = "per_increment";
  Distribution lambda = 1.0;
  void visit(FieldVisitor& v) {
    v.field("model", model, {{"per_pose", "per_increment"}}, "How noise is distributed.");
    v.field("lambda", lambda, {0.0, 10.0}, "Noise level.");
  }
};

struct Config {
  std::string scene = "indoor_lab";
  std::int64_t seed = 0;
  bool clouds = false;
  double near_m = 0.5;
  double far_m = 4.0;
  std::vector<double> heights_m = {0.5, 0.9};
  std::vector<std::string> tags;
  Odometry odometry;
  std::vector<Wheel> wheels;
  void visit(FieldVisitor& v) {
    v.field("scene", scene, {}, "World.");
    v.field("seed", seed, {0.0, 1e18}, "Seed of every random stream.");
    v.field("clouds", clouds, "Writes clouds.");
    v.field("near_m", near_m, {0.1, 100.0}, "Nearest distance.");
    v.field("far_m", far_m, {0.1, 100.0}, "Farthest distance.");
    v.check(near_m < far_m, "near_m", "must be less than far_m");
    v.field("heights_m", heights_m, {0.0, 3.0}, 1, 4, "Heights.");
    v.field("tags", tags, "Words.");
    v.nested("odometry", odometry, "Odometry noise.");
    v.nested_list("wheels", wheels, "Wheels.");
  }
};

VisitFields fields_of(Config& config) {
  return [&config](FieldVisitor& visitor) { config.visit(visitor); };
}

std::string problems_of(const std::string& text) {
  Config config;
  return error_text([&] { read_fields_from_text(text, "demo.yaml", fields_of(config)); });
}

TEST(Fields, EmptyFileLeavesDefaults) {
  Config config;
  read_fields_from_text("", "demo.yaml", fields_of(config));
  read_fields_from_text("# nothing but a comment\n", "demo.yaml", fields_of(config));
  EXPECT_EQ(config.scene, "indoor_lab");
  EXPECT_EQ(config.odometry.lambda.mean(), 1.0);
}

TEST(Fields, EveryProblemIsReportedAtOnceWithItsPlace) {
  const std::string text = problems_of(
      "scne: yard\n"
      "seed: -3\n"
      "clouds: maybe\n"
      "near_m: .nan\n"
      "far_m: 500\n"
      "heights_m: [1, x]\n"
      "odometry:\n"
      "  model: per_incremnt\n"
      "  lambda: {uniform: [2, 20]}\n"
      "  lamda: 3\n"
      "wheels:\n"
      "  - {name: left, radius_m: 0}\n"
      "  - {radius: 1}\n");
  EXPECT_EQ(text,
            "demo.yaml:1: scne: unknown key; did you mean \"scene\"? known: $schema, scene, seed, clouds, near_m, "
            "far_m, heights_m, tags, odometry, wheels\n"
            "demo.yaml:2: seed: -3: allowed is 0 to 1e+18\n"
            "demo.yaml:3: clouds: maybe: must be true or false\n"
            "demo.yaml:4: near_m: .nan: must be a number, 0.1 to 100\n"
            "demo.yaml:5: far_m: 500: allowed is 0.1 to 100\n"
            "demo.yaml:6: heights_m[1]: x: must be a number, 0 to 3\n"
            "demo.yaml:8: odometry.model: per_incremnt: must be one of per_pose, per_increment; did you mean "
            "\"per_increment\"?\n"
            "demo.yaml:9: odometry.lambda: a block: draws from 2 to 20, allowed is 0 to 10\n"
            "demo.yaml:10: odometry.lamda: unknown key; did you mean \"lambda\"? known: model, lambda\n"
            "demo.yaml:12: wheels[0].radius_m: 0: allowed is 0.01 to 2\n"
            "demo.yaml:13: wheels[1].radius: unknown key; did you mean \"radius_m\"? known: name, radius_m");
}

TEST(Fields, ChecksAcrossFieldsNameThePlace) {
  EXPECT_EQ(problems_of("near_m: 5\n"), "demo.yaml:1: near_m: 5: must be less than far_m");
}

TEST(Fields, EveryKindOfDistribution) {
  Config config;
  const auto read = [&](const std::string& value) {
    read_fields_from_text("odometry: {lambda: " + value + "}", "demo.yaml", fields_of(config));
    return config.odometry.lambda;
  };
  EXPECT_EQ(read("2.5").mean(), 2.5);
  EXPECT_EQ(read("{uniform: [1, 3]}").highest(), 3.0);
  EXPECT_DOUBLE_EQ(read("{normal: {mean: 5, stddev: 0.5}}").lowest(), 2.0);
  EXPECT_EQ(read("{choice: [1, 2, 9]}").mean(), 4.0);
}

TEST(Fields, WrittenConfigurationReadsBack) {
  Config config;
  config.scene = "yes";  // a word that YAML could take for a boolean
  config.seed = 987654321987654321;
  config.far_m = 0.1 + 0.2;
  config.tags = {"a b", "c: d", "#e", "\"quoted\"\n", ""};
  config.odometry.lambda = Distribution(Distribution::Normal{5.0, 0.25});
  config.near_m = 0.2;
  config.wheels.resize(2);
  const std::string text = write_fields(fields_of(config));
  Config again;
  read_fields_from_text(text, "again.yaml", fields_of(again));
  EXPECT_EQ(write_fields(fields_of(again)), text);
  EXPECT_EQ(again.seed, config.seed);
  EXPECT_EQ(again.tags, config.tags);
  EXPECT_EQ(again.scene, "yes");
  EXPECT_EQ(again.far_m, config.far_m);
}

TEST(Fields, IncludesMergeDeeplyAndLaterWins) {
  const TempFolder folder;
  folder.write("base.yaml", "scene: yard\nodometry: {model: per_pose, lambda: {uniform: [0, 1]}}\n");
  folder.write("more.yaml", "near_m: 0.7\n");
  folder.write("demo.yaml", "include: [base.yaml, more.yaml]\nodometry: {lambda: {normal: {mean: 5, stddev: 0.1}}}\n");
  Config config;
  read_fields(folder / "demo.yaml", fields_of(config));
  EXPECT_EQ(config.scene, "yard");
  EXPECT_EQ(config.near_m, 0.7);
  EXPECT_EQ(config.odometry.model, "per_pose");
  EXPECT_EQ(config.odometry.lambda.mean(), 5.0);
}

TEST(Fields, AnIncludedMistakeNamesTheIncludedFile) {
  const TempFolder folder;
  folder.write("parts/base.yaml", "\nseed: x\n");
  const auto file = folder.write("demo.yaml", "include: parts/base.yaml\n");
  Config config;
  EXPECT_THAT(error_text([&] { read_fields(file, fields_of(config)); }),
              HasSubstr((folder / "parts/base.yaml").string() + ":2: seed: x: must be a whole number"));
}

TEST(Fields, IncludesThatNeverEndAreRefused) {
  const TempFolder folder;
  const auto file = folder.write("a.yaml", "include: b.yaml\n");
  folder.write("b.yaml", "include: a.yaml\n");
  Config config;
  EXPECT_THAT(error_text([&] { read_fields(file, fields_of(config)); }), HasSubstr("include each other without end"));
}

TEST(Fields, AnIncludeThatDoesNotExistIsNamed) {
  EXPECT_THAT(problems_of("include: nowhere.yaml\n"),
              HasSubstr("demo.yaml:1: include: nowhere.yaml: there is no such file beside this one, and no preset"));
  EXPECT_THAT(problems_of("include: {a: 1}\n"), HasSubstr("include: a block: must be text"));
}

TEST(Fields, WrongShapesAreNamed) {
  EXPECT_EQ(problems_of("odometry: 5\n"), "demo.yaml:1: odometry: 5: must be a block of keys");
  EXPECT_EQ(problems_of("wheels: {name: a}\n"), "demo.yaml:1: wheels: a block: must be a list");
  EXPECT_EQ(problems_of("tags: a\n"), "demo.yaml:1: tags: a: must be a list of texts");
  EXPECT_EQ(problems_of("heights_m: [1, 1, 1, 1, 1]\n"),
            "demo.yaml:1: heights_m: a list of 5: must be a list of 1 to 4 numbers");
  EXPECT_EQ(problems_of("seed: 1.5\n"), "demo.yaml:1: seed: 1.5: must be a whole number, 0 to 1e+18");
  EXPECT_EQ(problems_of("near_m:\n"), "demo.yaml:1: near_m: nothing: must be a number, 0.1 to 100");
  EXPECT_EQ(problems_of("[1, 2]\n"), "demo.yaml:1: a list of 2: must be a block of keys");
}

TEST(Fields, WrongDistributionsAreNamed) {
  const auto lambda = [](const std::string& text) { return problems_of("odometry: {lambda: " + text + "}\n"); };
  EXPECT_EQ(lambda("{uniform: [2, 1]}"),
            "demo.yaml:1: odometry.lambda.uniform: 2, 1: must be [low, high] with low <= high");
  EXPECT_EQ(
      lambda("{gamma: 1}"),
      "demo.yaml:1: odometry.lambda: a block: must be a number, {uniform: [low, high]}, {normal: {mean: m, stddev: "
      "s}} or {choice: [..]}");
  EXPECT_EQ(lambda("{normal: {mean: 1}}"),
            "demo.yaml:1: odometry.lambda.normal.stddev: is missing; it must be a number, >= 0");
  EXPECT_EQ(lambda("{choice: []}"),
            "demo.yaml:1: odometry.lambda.choice: a list of 0: must be a list of 1 to 10000 numbers");
  EXPECT_EQ(lambda("11"), "demo.yaml:1: odometry.lambda: 11: allowed is 0 to 10");
  EXPECT_EQ(lambda("{normal: {mean: 1, stddev: 0.5}}"),
            "demo.yaml:1: odometry.lambda: a block: draws from -2 to 4, allowed is 0 to 10");
}

// ------------------------------------------------------------------------------------------------------------- schema

using Json = nlohmann::json;

Json schema_json() {
  Config config;
  return Json::parse(schema_of_fields("Demo", fields_of(config)));
}

TEST(Schema, SaysWhatTheReaderAllows) {
  const Json schema = schema_json();
  EXPECT_EQ(schema["$schema"], "http://json-schema.org/draft-07/schema#");
  EXPECT_EQ(schema["title"], "Demo");
  EXPECT_EQ(schema["additionalProperties"], false);
  const Json& properties = schema["properties"];
  EXPECT_EQ(properties["near_m"],
            Json::parse(R"({"type": "number", "minimum": 0.1, "maximum": 100.0, "description": "Nearest distance.",
                            "default": 0.5})"));
  EXPECT_EQ(properties["seed"]["type"], "integer");
  EXPECT_EQ(properties["clouds"]["default"], false);
  EXPECT_EQ(properties["heights_m"]["maxItems"], 4);
  const Json& odometry = properties["odometry"];
  EXPECT_EQ(odometry["additionalProperties"], false);
  EXPECT_EQ(odometry["properties"]["model"]["enum"], Json::parse(R"(["per_pose", "per_increment"])"));
  EXPECT_EQ(odometry["properties"]["lambda"]["anyOf"].size(), 4U);
  EXPECT_EQ(odometry["properties"]["lambda"]["anyOf"][0]["maximum"], 10.0);
  EXPECT_EQ(properties["wheels"]["items"]["properties"]["radius_m"]["default"], 0.165);
  EXPECT_TRUE(properties.contains("include"));
  EXPECT_TRUE(properties.contains("$schema"));
}

TEST(Schema, LeavesTheConfigurationAlone) {
  Config config;
  schema_of_fields("Demo", fields_of(config));
  EXPECT_TRUE(config.wheels.empty());
}

TEST(Fields, AFileMayNameItsSchema) { EXPECT_EQ(problems_of("$schema: ./config.schema.json\nseed: 1\n"), ""); }

}  // namespace
}  // namespace rigproof
