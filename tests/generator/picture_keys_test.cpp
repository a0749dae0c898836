// Every field of a run's configuration, one by one: a render key changes the keys of the clean renders, a sense key
// changes none. A new field has to be entered in one of the tables below.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "frame_maker.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/generator/dataset.h"
#include "rigproof/generator/parameters.h"
#include "rigproof/study/workflow/overrides.h"
#include "scenario.h"
#include "tiny_world.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::Not;

using Settings = std::vector<std::string>;  // FIELD=VALUE
using Keys = std::vector<std::string>;

// Composing worlds is what takes time: one folder and one set of basic keys for all tests of this process.
class PictureKeys : public testing::Test {
 protected:
  static void SetUpTestSuite() { world_ = new TinyWorld; }
  static void TearDownTestSuite() {
    delete world_;
    world_ = nullptr;
  }

  // Words with an @ stand for files.
  static std::string with_files(std::string text) {
    for (const auto& [mark, file] : {std::pair("@tiny", world_->scene()), std::pair("@other", world_->other_scene())})
      for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark))
        text.replace(at, std::string(mark).size(), file);
    return text;
  }

  static Keys keys_of(Settings settings, const Settings& more = {}) {
    settings.insert(settings.begin(), {"scene=@tiny", "rig=husky_1x_d455", "image_scale=0.1", "poses=1"});
    settings.insert(settings.end(), more.begin(), more.end());
    for (std::string& setting : settings) setting = with_files(setting);
    Keys keys;
    for (const GenerateConfig& run : runs_of(parse_generate_config(overrides_as_yaml(settings), "test.yaml")))
      for (const std::string& key : clean_frame_keys(resolve_scenario(run))) keys.push_back(key);
    return keys;
  }

  static const Keys& basic_keys(const Settings& context) {
    static std::map<Settings, Keys> known;
    const auto found = known.find(context);
    return found != known.end() ? found->second : known.emplace(context, keys_of(context)).first->second;
  }

  // What is refused has no pictures at all.
  static Keys keys_or_refusal(const Settings& context, const std::string& setting) {
    try {
      return keys_of(context, {setting});
    } catch (const Error& error) {
      return {error.what()};
    }
  }

  static const TinyWorld& world() { return *world_; }

 private:
  static TinyWorld* world_;
};

TinyWorld* PictureKeys::world_ = nullptr;

struct Row {
  std::string path;
  std::string value;   ///< another one than the default
  Settings context;    ///< where the field means anything
  bool alone = false;  ///< it changes the pictures themselves, not only which ones are taken
};

const Settings kGiven = {"board.place=given", "board.x_m=3", "board.facing_deg=180"};
const Settings kGrid = {"viewpoints.planner=grid", "viewpoints.margin_px=1", "viewpoints.grid.distances_m=[2.5]",
                        "viewpoints.grid.bearings_deg=[0]", "viewpoints.grid.headings_deg=[0]"};
const Settings kList = {"viewpoints.planner=list", "viewpoints.list=[{x_m: 2, y_m: 0, yaw_deg: 180}]"};
const Settings kThree = {"rig=husky_3x_d455", "poses=4", "viewpoints.planner=sampled",
                         "viewpoints.all_cameras_share=0"};
const Settings kSampled = {"poses=4", "viewpoints.planner=sampled", "board.place=scene"};
const Settings kFour = {"poses=4"};

Settings driving(const Settings& more = {}) {
  Settings settings = {"motion=drive", "viewpoints.planner=list", "drive.settle_s=0.2",
                       "viewpoints.list=[{x_m: 0, y_m: -1, yaw_deg: 0}, {x_m: 0.5, y_m: -0.8, yaw_deg: 20}]"};
  settings.insert(settings.end(), more.begin(), more.end());
  return settings;
}

const std::vector<Row>& world_rows() {
  static const std::vector<Row> rows = {
      {"seed", "1", {}, true},
      {"scene", "@other", {}, true},
      {"scenes", "[@other]", {}, true},
      {"randomize.texture_scale", "1.5", {}, true},
      {"randomize.texture_contrast", "0.5", {}, true},
      {"randomize.texture_color", "0.8", {}, true},
      {"randomize.light_brightness", "0.8", {}, true},
      {"randomize.light_turn_deg", "20", {}, true},
      {"randomize.light_warmth", "0.5", {}, true},
      {"randomize.cloud_cover", "0.2", {}, true},
      {"randomize.clutter_share", "0", {}, true},
      {"randomize.clutter_shift_m", "0.1", {}, true},
      {"randomize.clutter_turn_deg", "10", {}, true},
      {"rig", "husky_3x_d455", {}, true},
      {"image_scale", "0.2", {}, true},
      {"depth_frame", "raw", {}, true},
      {"board.preset", "checkerboard_6x5_110mm", {}, true},
      {"board.type", "charuco", {}, true},
      {"board.squares", "[6, 5]", {}, true},
      {"board.square_mm", "90", {}, true},
      {"board.dictionary", "DICT_4X4_50", {"board.preset=charuco_7x5_100mm"}, true},
      {"more_boards",
       "[{preset: aprilgrid_6x4_130mm, x_m: 3, y_m: 1, facing_deg: 180}]",
       {"board.preset=charuco_7x5_100mm"},
       true},
      {"board.place", "given", {"board.x_m=3", "board.facing_deg=180"}, true},
      {"board.x_m", "3.2", kGiven, true},
      {"board.y_m", "0.2", kGiven, true},
      {"board.z_m", "0.7", kGiven, true},
      {"board.facing_deg", "170", kGiven, true},
      {"board.lean_deg", "5", kGiven, true},
      {"board.roll_deg", "5", kGiven, true},
      {"board.defects.print_scale_x", "1.01", {}, true},
      {"board.defects.print_scale_y", "1.01", {}, true},
      {"board.defects.bow_mm", "2", {}, true},
      {"board.defects.print_error_mm", "0.1", {}, true},
      {"board.defects.border_mm", "40", {}, true},
      {"board.defects.glare", "0.5", {}, true},
      {"board.defects.covered_percent", "10", {}, true},
      {"board.defects.dirt", "0.5", {}, true},
      {"render.psf_sigma_px", "0.6000000001", {}, true},
      {"render.board_at_double", "false", {}, true},
      {"render.whole_at_double", "true", {}, true},
      {"render.lens_residual", "false", {}, true},
  };
  return rows;
}

const std::vector<Row>& viewpoint_rows() {
  static const std::vector<Row> rows = {
      {"poses", "2", {}},
      {"viewpoints.planner", "grid", {}},
      {"viewpoints.distance_m", "2", {}},
      {"viewpoints.bearing_deg", "10", {}},
      {"viewpoints.heading_deg", "3", kSampled},
      {"viewpoints.min_cameras", "3", kThree},
      {"viewpoints.all_cameras_share", "1", kThree},
      {"viewpoints.margin_px", "20", kFour},
      {"viewpoints.max_obliquity_deg", "10", kFour},
      {"viewpoints.max_candidates", "1", kSampled},
      {"viewpoints.order", "drawn", kFour},
      {"viewpoints.step_m", "0.1", kFour},
      {"viewpoints.grid.distances_m", "[2.7]", kGrid},
      {"viewpoints.grid.bearings_deg", "[5]", kGrid},
      {"viewpoints.grid.headings_deg", "[2]", kGrid},
      {"viewpoints.list", "[{x_m: 2, y_m: 0.1, yaw_deg: 180}]", kList},
      {"viewpoints.list_frame", "board", kList},
      {"straight_drive.frames", "3", {}},
  };
  return rows;
}

const std::vector<Row>& drive_rows() {
  const Settings moving = driving({"drive.capture=moving"}), load = driving({"drive.payload_kg=10"});
  // Where wheels slide, places have to be corrected.
  const Settings on_ice = driving({"drive.friction=0.1", "drive.max_speed_m_s=2", "drive.acceleration_m_s2=3",
                                   "drive.tolerance_deg=20", "drive.tolerance_cm=50"});
  const Settings near_pillar = {"motion=drive", "drive.clearance_cm=0", "drive.settle_s=0.2", "viewpoints.planner=list",
                                // The robot's side is 0.34 m from its middle, the pillar's face at y = 0.7 m.
                                "viewpoints.list=[{x_m: 0, y_m: 0.3, yaw_deg: 0}, {x_m: 0.3, y_m: 0.3, yaw_deg: 0}]"};
  const Settings blurred = driving({"drive.capture=moving", "render.exposure_ms=80"});
  const Settings leaning = driving({"drive.capture=moving", "render.readout_ms=80"});
  static const std::vector<Row> rows = {
      {"render.motion_blur", "false", blurred},
      {"render.rolling_shutter", "false", leaning},
      {"render.exposure_ms", "60", blurred},
      {"render.readout_ms", "60", leaning},
      {"render.max_parts", "1", blurred},
      {"motion", "drive", {"viewpoints.planner=list", driving()[3]}},
      {"drive.capture", "moving", driving()},
      {"drive.frame_rate_hz", "3", moving},
      {"drive.max_speed_m_s", "0.3", driving()},
      {"drive.max_turn_deg_s", "30", driving()},
      {"drive.acceleration_m_s2", "0.5", driving()},
      {"drive.settle_s", "0.5", driving()},
      {"drive.tolerance_cm", "0.2", on_ice},
      {"drive.clearance_cm", "10", near_pillar},
      {"drive.wheel_diameter_ratio", "1.01", driving()},
      {"drive.friction", "0.5", driving()},
      {"drive.payload_kg", "10", driving()},
      {"drive.payload_x_m", "0.2", load},
      {"drive.payload_y_m", "0.1", load},
      {"drive.payload_z_m", "0.6", load},
      {"drive.unevenness_mm", "3", driving()},
      {"drive.unevenness_length_m", "1", driving({"drive.unevenness_mm=3"})},
      {"drive.ramps", "[{x_m: 0.4, y_m: -1, heading_deg: 0, height_cm: 2}]", driving()},
  };
  return rows;
}

const std::vector<Row>& sense_rows() {
  const Settings thrun = {"odometry.model=thrun"}, wheels = {"odometry.model=wheels"};
  static const std::vector<Row> rows = {
      {"name", "another", {}},
      {"stop_period_s", "3", {}},
      {"odometry.seed", "5", {}},
      {"odometry.model", "per_pose", {}},
      {"odometry.lambda", "2", {}},
      {"odometry.sigma_xy_cm", "0.3", {}},
      {"odometry.sigma_yaw_rad", "0.02", {}},
      {"odometry.scale", "1.01", {}},
      {"odometry.yaw_factor", "0.99", {}},
      {"odometry.rate_hz", "10", driving()},
      {"odometry.declared", "true", {}},
      {"odometry.thrun.a1", "0.01", thrun},
      {"odometry.thrun.a2", "0.01", thrun},
      {"odometry.thrun.a3", "0.01", thrun},
      {"odometry.thrun.a4", "0.01", thrun},
      {"odometry.wheels.diameter_ratio", "1.01", wheels},
      {"odometry.wheels.track_ratio", "1.01", wheels},
      {"odometry.wheels.icr_x_m", "0.01", wheels},
      {"odometry.wheels.icr_asymmetry_m", "0.01", wheels},
      {"odometry.wheels.slip_percent", "2", wheels},
      {"sensor_noise", "none", {}},
      {"depth_scale_bias_percent", "1", {}},
      {"sensing.seed", "5", {}},
      {"sensing.told", "exact", {}},
      {"sensing.image.noise", "false", {}},
      {"sensing.image.pixel_pattern", "false", {}},
      {"sensing.image.vignetting", "false", {}},
      {"sensing.image.exposure", "0.8", {}},
      {"sensing.image.exposure_jitter_percent", "0", {}},
      {"sensing.image.defocus_sigma_px", "0.5", {}},
      {"sensing.image.demosaicing", "false", {}},
      {"sensing.image.sharpening", "false", {}},
      {"sensing.image.jpeg_quality", "0", {}},
      {"sensing.depth.noise", "false", {}},
      {"sensing.depth.disparity_steps", "false", {}},
      {"sensing.depth.coarse_noise", "false", {}},
      {"sensing.depth.bias_field", "false", {}},
      {"sensing.depth.occlusion", "false", {}},
      {"sensing.depth.edges", "false", {}},
      {"sensing.depth.texture_holes", "false", {}},
      {"sensing.depth.daylight", "false", {}},
      {"sensing.depth.misregistration_px", "2", {}},
      {"sensing.lens.focal_error_percent", "1", {}},
      {"sensing.lens.centre_error_px", "2", {}},
      {"sensing.lens.distortion_error_percent", "5", {}},
      {"sensing.time.clock_offset_ms", "10", {}},
      {"sensing.time.camera_delay_ms", "10", {}},
      {"sensing.time.stamp_jitter_ms", "2", {}},
      {"sensing.time.dropped_percent", "50", kFour},
      {"sensing.time.odometry_delay_ms", "10", {}},
      {"sensing.time.odometry_jitter_ms", "2", {}},
      {"clouds", "pcd", {}},
      {"cloud_stride_px", "3", {"clouds=pcd"}},
      {"png_level", "2", {}},
  };
  return rows;
}

// Whose effect needs a way that ends badly: on one that ends well the last turn is as exact as the least tolerance.
const std::set<std::string> kNotTried = {"drive.max_plans", "drive.tolerance_deg"};

TEST_F(PictureKeys, EveryParameterIsInATable) {
  std::map<std::string, ParameterKind> kinds;
  for (const auto* rows : {&world_rows(), &viewpoint_rows(), &drive_rows()})
    for (const Row& row : *rows) EXPECT_TRUE(kinds.emplace(row.path, ParameterKind::kRender).second) << row.path;
  for (const Row& row : sense_rows()) EXPECT_TRUE(kinds.emplace(row.path, ParameterKind::kSense).second) << row.path;
  for (const Parameter& parameter : all_parameters()) {
    if (kNotTried.count(parameter.path) != 0) {
      EXPECT_EQ(parameter.kind, ParameterKind::kRender) << parameter.path;
      continue;
    }
    const auto found = kinds.find(parameter.path);
    ASSERT_NE(found, kinds.end()) << parameter.path << ": tell by a row of this test what it does to clean renders";
    EXPECT_EQ(found->second, parameter.kind) << parameter.path;
    kinds.erase(found);
  }
  EXPECT_TRUE(kinds.empty()) << kinds.begin()->first << " is no parameter";
}

TEST_F(PictureKeys, WhatChangesTheWorldChangesEveryKey) {
  for (const Row& row : world_rows()) {
    const Keys& before = basic_keys(row.context);
    ASSERT_FALSE(before.empty());
    for (const std::string& key : keys_of(row.context, {row.path + "=" + row.value}))
      EXPECT_THAT(before, Not(Contains(key))) << row.path;
  }
}

TEST_F(PictureKeys, WhatChangesTheViewpointsChangesTheListOfKeys) {
  for (const Row& row : viewpoint_rows())
    EXPECT_NE(keys_or_refusal(row.context, row.path + "=" + row.value), basic_keys(row.context)) << row.path;
}

TEST_F(PictureKeys, WhatChangesTheDriveChangesTheListOfKeys) {
  for (const Row& row : drive_rows())
    EXPECT_NE(keys_or_refusal(row.context, row.path + "=" + row.value), basic_keys(row.context)) << row.path;
}

TEST_F(PictureKeys, SenseKeysChangeNoKey) {
  for (const Row& row : sense_rows()) {
    const Keys& before = basic_keys(row.context);
    const Keys after = keys_of(row.context, {row.path + "=" + row.value});
    if (row.path == "sensing.time.dropped_percent") {
      EXPECT_LT(after.size(), before.size());
      for (const std::string& key : after) EXPECT_THAT(before, Contains(key));
    } else {
      EXPECT_EQ(after, before) << row.path;
    }
  }
}

TEST_F(PictureKeys, ContentsOfTheWorldsFilesCountAndTheirFolderDoesNot) {
  const Keys before = keys_of({});
  const TinyWorld elsewhere;
  EXPECT_EQ(keys_of({"scene=" + elsewhere.scene()}), before) << "the same files in another folder";
  elsewhere.folder().write("tiny.yaml", "# a remark\n" + elsewhere.folder().read("tiny.yaml"));
  EXPECT_EQ(keys_of({"scene=" + elsewhere.scene()}), before) << "a remark";
  elsewhere.write_picture(91);
  const Keys other_picture = keys_of({"scene=" + elsewhere.scene()});
  EXPECT_NE(other_picture, before) << "one level of a user's texture";
  elsewhere.write_picture(90);
  elsewhere.write_mjcf("0.4");
  EXPECT_NE(keys_of({"scene=" + elsewhere.scene()}), before) << "a material of the MJCF";
}

// A rig with a camera whose description may be changed.
std::string rig_text(const std::string& camera, const std::string& robot) {
  return "robot: " + robot + "\nboard: checkerboard_5x4_100mm\ncameras:\n  front: {sensor: d455, link: front, " +
         camera + "}\n";
}

TEST_F(PictureKeys, MountingLensAndRobotCountAndTheSensorsNoiseDoesNot) {
  const std::string mount = "mount: {x_m: 0.26, y_m: 0, z_m: 0.68, pitch_deg: 15}";
  const std::string lens =
      "intrinsics: {width_px: 1280, height_px: 720, fx_px: 640, fy_px: 640, cx_px: 639.5, "
      "cy_px: 359.5, lens: brown_conrady, distortion: [-0.05, 0.01, 0, 0, 0]}";
  const TempFolder& folder = world().folder();
  const fs::path models = data_folder() / "models" / "robots";
  folder.write("robot.yaml", read_text_file(models / "husky.yaml"));
  folder.write("husky.xml", read_text_file(models / "husky.xml"));
  const std::string robot = (folder / "robot.yaml").string();
  // One place: what another lens or mounting makes of the plan does not matter.
  Settings settings = kList;
  settings.push_back("rig=" + (folder / "rig.yaml").string());
  const auto keys_with = [&](const std::string& camera) {
    folder.write("rig.yaml", rig_text(camera, robot));
    return keys_of(settings);
  };
  const Keys before = keys_with(mount + ", " + lens);
  std::string turned = mount, longer = lens, bent = lens;
  turned.replace(turned.find("15"), 2, "15.001");
  longer.replace(longer.find("640,"), 4, "640.001,");
  bent.replace(bent.find("-0.05"), 5, "-0.0501");
  EXPECT_NE(keys_with(turned + ", " + lens), before);
  EXPECT_NE(keys_with(mount + ", " + longer), before);
  EXPECT_NE(keys_with(mount + ", " + bent), before);
  EXPECT_EQ(keys_with(mount + ", " + lens + ", depth: {max_m: 5}"), before) << "the sensor's range";
  std::string mjcf = folder.read("husky.xml");
  const std::string dark = "rgba=\"0.08 ";
  const std::size_t rgba = mjcf.find(dark);
  ASSERT_NE(rgba, std::string::npos);
  mjcf.replace(rgba, dark.size(), "rgba=\"0.09 ");
  folder.write("husky.xml", mjcf);
  EXPECT_NE(keys_with(mount + ", " + lens), before) << "the robot's colour";
}

}  // namespace
}  // namespace rigproof
