// Every parameter is listed, once, as a render key or a sense key.
#include "rigproof/generator/parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "effects_of.h"

namespace rigproof {
namespace {

// Dotted paths of all leaves of a JSON Schema; a list is one.
void collect(const nlohmann::json& schema, const std::string& path, std::set<std::string>* leaves) {
  const auto properties = schema.find("properties");
  if (properties == schema.end()) {
    leaves->insert(path);
    return;
  }
  for (const auto& [key, value] : properties->items()) collect(value, path.empty() ? key : path + "." + key, leaves);
}

TEST(Parameters, AreThoseOfTheSchema) {
  std::set<std::string> expected, found;
  collect(nlohmann::json::parse(generate_config_schema()), "", &expected);
  expected.erase("include");
  expected.erase("$schema");
  for (const Parameter& parameter : all_parameters())
    EXPECT_TRUE(found.insert(parameter.path).second) << parameter.path;
  EXPECT_EQ(found, expected);
}

TEST(Parameters, KindsAreAsTheyShould) {
  const auto kind_of = [](const std::string& path) {
    for (const Parameter& parameter : all_parameters())
      if (parameter.path == path) return parameter.kind;
    ADD_FAILURE() << path << " is no parameter";
    return ParameterKind::kRender;
  };
  for (const char* path :
       {"seed", "scene", "rig", "image_scale", "poses", "board.x_m", "viewpoints.planner", "render.psf_sigma_px"})
    EXPECT_EQ(kind_of(path), ParameterKind::kRender) << path;
  for (const char* path : {"sensing.seed", "sensing.depth.edges", "sensor_noise", "odometry.lambda", "png_level"})
    EXPECT_EQ(kind_of(path), ParameterKind::kSense) << path;
}

TEST(Parameters, ChangedRenderKeysAreNamed) {
  GenerateConfig there, here;
  change(&here, "sensing: {depth: {edges: false}}");
  here.odometry.lambda = 3.0;
  EXPECT_TRUE(changed_render_keys(there, here).empty());
  here.poses = 7;
  here.board.x_m = 1.5;
  EXPECT_THAT(changed_render_keys(there, here), testing::UnorderedElementsAre("board.x_m", "poses"));
}

// Images of a robot that stands do not tell when they were taken.
TEST(Parameters, TheDelayOfCamerasIsARenderKeyWhileTheRobotMoves) {
  GenerateConfig there, here;
  here.sensing.time.camera_delay_ms = 20.0;
  EXPECT_TRUE(changed_render_keys(there, here).empty());
  EXPECT_THAT(differences(without_sense_keys(there), without_sense_keys(here)), testing::IsEmpty());
  for (GenerateConfig* config : {&there, &here}) {
    config->motion = "drive";
    config->drive.capture = "moving";
  }
  EXPECT_THAT(changed_render_keys(there, here), testing::ElementsAre("sensing.time.camera_delay_ms"));
  EXPECT_THAT(differences(without_sense_keys(there), without_sense_keys(here)),
              testing::ElementsAre(testing::StartsWith("sensing.time.camera_delay_ms")));
  here.sensing.time.camera_delay_ms = 0.0;
  here.sensing.time.clock_offset_ms = 5.0;
  EXPECT_TRUE(changed_render_keys(there, here).empty());
}

TEST(Parameters, WithoutSenseKeysNoneIsLeft) {
  GenerateConfig changed;
  changed.name = "other";
  changed.stop_period_s += 1.0;
  changed.odometry.lambda += 3.0;
  changed.sensor_noise = "none";
  changed.depth_scale_bias_percent = 1.0;
  change(&changed, "sensing: {depth: {edges: false}}");
  changed.clouds = "pcd";
  changed.cloud_stride_px += 1;
  changed.png_level += 1;
  std::set<std::string> expected, tried;
  const auto first_word = [](const std::string& path) { return path.substr(0, path.find_first_of(".:")); };
  for (const Parameter& parameter : all_parameters())
    if (parameter.kind == ParameterKind::kSense) expected.insert(first_word(parameter.path));
  for (const std::string& difference : differences(GenerateConfig(), changed)) tried.insert(first_word(difference));
  EXPECT_EQ(tried, expected);
  changed.poses += 1;
  EXPECT_THAT(differences(GenerateConfig(), without_sense_keys(changed)),
              testing::ElementsAre(testing::StartsWith("poses:")));
}

}  // namespace
}  // namespace rigproof
