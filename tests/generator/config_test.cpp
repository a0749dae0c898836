#include "rigproof/generator/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "error_text.h"
#include "paths.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/files.h"

namespace rigproof {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string error_of(const std::string& text) {
  return error_text([&] { parse_generate_config(text); });
}

TEST(GenerateConfig, EmptyFileIsValid) {
  const GenerateConfig config = parse_generate_config("", "demo.yaml");
  EXPECT_EQ(config.name, "demo");
  EXPECT_EQ(config.poses, 100);
  EXPECT_EQ(config.seed, 0);
  EXPECT_EQ(config.odometry.model, "per_increment");
  EXPECT_EQ(config.odometry.lambda, 1.0);
  EXPECT_EQ(config.sensor_noise, "realistic");
  EXPECT_EQ(config.clouds, "none");
  parse_generate_config("{}");
}

GenerateConfig shipped(const std::string& name) { return load_generate_config(find_data_file("config", name)); }

TEST(GenerateConfig, ARunIsRealisticByDefault) {
  EXPECT_THAT(differences(shipped("realistic"), parse_generate_config("", "realistic.yaml")), IsEmpty());
}

// What the experiments that change one thing at a time stand on.
TEST(GenerateConfig, PlainHasNothingButNoise) {
  GenerateConfig plain = shipped("plain");
  EXPECT_FALSE(plain.render.lens_residual);
  for (const Distribution& defect : {plain.board.defects.bow_mm, plain.board.defects.print_error_mm}) {
    EXPECT_EQ(defect.lowest(), 0.0);
    EXPECT_EQ(defect.highest(), 0.0);
  }
  EXPECT_EQ(plain.sensing.image.jpeg_quality, 0);
  DeviceDraws draws;
  EXPECT_TRUE(plain.sensing.image.effects.resolved(&draws).empty());
  for (const char* name : {"paper/world", "stress/base", "bench-v1/clean_lab", "bench-v1/worn_devices"}) {
    GenerateConfig other = shipped(name);
    EXPECT_FALSE(other.render.lens_residual) << name;
    EXPECT_EQ(other.board.defects.print_error_mm.highest(), 0.0) << name;
    EXPECT_EQ(other.sensing.image.jpeg_quality, 0) << name;
  }
}

TEST(GenerateConfig, FurtherBoardsAreAsGoodAsTheFirst) {
  const std::string board =
      "rig: husky_1x_d455\nboard: {preset: charuco_7x5_100mm, defects: {bow_mm: 0, dirt: 0.5}}\n"
      "more_boards: [{preset: aprilgrid_6x4_130mm, x_m: 1, y_m: 2, facing_deg: 3";
  const GenerateConfig like = parse_generate_config(board + "}]\n");
  EXPECT_EQ(like.more_boards.at(0).defects.dirt.mean(), 0.5);
  EXPECT_EQ(like.more_boards.at(0).defects.bow_mm.highest(), 0.0);
  const GenerateConfig other = parse_generate_config(board + ", defects: {dirt: 0.1}}]\n");
  EXPECT_EQ(other.more_boards.at(0).defects.dirt.mean(), 0.1);
  EXPECT_EQ(other.more_boards.at(0).defects.bow_mm.highest(), 0.0);
}

TEST(GenerateConfig, ResolvedTextReadsBackToTheSame) {
  GenerateConfig config = parse_generate_config(R"(
name: other
odometry: {model: per_pose, lambda: 2.5, rate_hz: 50}
board: {squares: [6, 5], square_mm: 110, place: given, x_m: {normal: {mean: 0.1, stddev: 0.25}}}
viewpoints:
  planner: list
  distance_m: {choice: [1, 2]}
  list: [{x_m: 1, y_m: 2, yaw_deg: 3}, {x_m: -1, yaw_deg: 30.5}]
)");
  const GenerateConfig again = parse_generate_config(resolved_text(config));
  EXPECT_THAT(differences(config, again), ElementsAre());
  EXPECT_EQ(resolved_text(config), resolved_text(again));
}

TEST(GenerateConfig, DifferencesNameTheField) {
  const GenerateConfig a = parse_generate_config("poses: 100");
  const GenerateConfig b = parse_generate_config("{poses: 50, odometry: {lambda: 2}, viewpoints: {distance_m: 2}}");
  EXPECT_THAT(differences(a, b), ElementsAre("odometry.lambda: 1 there, 2 here", "poses: 100 there, 50 here",
                                             "viewpoints.distance_m: {uniform: [1.2, 3.6]} there, 2 here"));
}

TEST(GenerateConfig, WhatOnlyOnePlannerTakesChoosesIt) {
  const auto planner = [](const std::string& keys) {
    return parse_generate_config("viewpoints: {" + keys + "}").viewpoints.planner;
  };
  EXPECT_EQ(planner("distance_m: 2"), "covering");
  EXPECT_EQ(planner("heading_deg: 10"), "sampled");
  EXPECT_EQ(planner("all_cameras_share: 0.9"), "sampled") << "given, though it is the default";
  EXPECT_EQ(planner("planner: grid, heading_deg: 10"), "grid");
  EXPECT_THAT(error_of("viewpoints: {planner: covering, heading_deg: 10}"), HasSubstr("belongs to planner sampled"));
}

TEST(GenerateConfig, HeadingsMayGoAcrossTheBack) {
  const auto heading = [](const std::string& range) {
    return parse_generate_config("viewpoints: {planner: sampled, heading_deg: {uniform: " + range + "}}")
        .viewpoints.heading_deg;
  };
  for (const char* range : {"[170, 190]", "[170, -170]"}) {
    EXPECT_EQ(heading(range).lowest(), 170.0) << range;
    EXPECT_EQ(heading(range).highest(), 190.0) << range;
  }
  const auto expect_drawn = [&](const std::string& range, double low, double high) {
    EXPECT_EQ(heading(range).lowest(), low) << range;
    EXPECT_EQ(heading(range).highest(), high) << range;
  };
  expect_drawn("[350, 10]", -10.0, 10.0);
  expect_drawn("[350, -10]", 350.0, 350.0);
  expect_drawn("[350, -20]", -10.0, 340.0);
  expect_drawn("[-10, -20]", -10.0, 340.0);
  expect_drawn("[350, 360]", 350.0, 360.0);
  EXPECT_THAT(error_of("viewpoints: {planner: sampled, heading_deg: {uniform: [400, 10]}}"), HasSubstr("low <= high"));
  EXPECT_THAT(error_of("viewpoints: {planner: sampled, heading_deg: {uniform: [170, 400]}}"), HasSubstr("-360 to 360"));
  EXPECT_THAT(error_of("viewpoints: {distance_m: {uniform: [3, 2]}}"), HasSubstr("low <= high"));
}

TEST(GenerateConfig, EveryMistakeIsNamed) {
  const std::string error = error_of("{pose: 10, odometry: {lambda: -1}, sensor_noise: some, board: {squares: [5]}}");
  EXPECT_THAT(error, HasSubstr("poses"));  // the nearest key
  EXPECT_THAT(error, HasSubstr("odometry.lambda"));
  EXPECT_THAT(error, HasSubstr("realistic"));
  EXPECT_THAT(error, HasSubstr("board.squares"));
}

TEST(GenerateConfig, FieldsThatContradictEachOtherAreNamed) {
  EXPECT_THAT(error_of("viewpoints: {planner: list}"), HasSubstr("viewpoints.list"));
  EXPECT_THAT(error_of("odometry: {model: per_pose, scale: 1.02}"), HasSubstr("odometry.scale"));
  EXPECT_THAT(error_of("board: {squares: [5.5, 4]}"), HasSubstr("whole numbers"));
  const std::string moving = "motion: drive\ndrive: {capture: moving}\n";
  for (const char* delay : {"{uniform: [-1, 20]}", "-5", "{normal: {mean: 10, stddev: 2}}"})
    EXPECT_THAT(error_of(moving + "sensing: {time: {camera_delay_ms: " + delay + "}}"),
                HasSubstr("sensing.time.camera_delay_ms"))
        << delay;
  for (const char* time : {"clock_offset_ms: -20", "camera_delay_ms: {uniform: [0, 20]}"})
    EXPECT_NO_THROW(parse_generate_config(moving + "sensing: {time: {" + time + "}}", "moving"));
  EXPECT_NO_THROW(parse_generate_config("sensing: {time: {camera_delay_ms: -5}}", "standing"));
}

// What ships in config/ must stay readable.
TEST(GenerateConfig, ShippedFilesAreValid) {
  const std::filesystem::path folder = source_path("config");
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    EXPECT_NO_THROW(load_generate_config(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 1);
}

}  // namespace
}  // namespace rigproof
