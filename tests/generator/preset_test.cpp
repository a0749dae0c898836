// Sensor presets: the shipped ones have sources, impossible values are told all at once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>

#include "error_text.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/files.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/generator/sensor_device.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Data of the test's own, found through RIGPROOF_DATA.
class OwnData : public TempFolder {
 public:
  OwnData() { setenv("RIGPROOF_DATA", path().c_str(), 1); }
  ~OwnData() { unsetenv("RIGPROOF_DATA"); }
};

TEST(SensorPresets, EveryNumberThatIsSimulatedSaysWhereItIsFrom) {
  for (const std::string& name : list_presets("sensors")) {
    std::istringstream in(read_text_file(find_data_file("sensors", name)));
    bool simulation = false;
    for (std::string line; std::getline(in, line);) {
      if (line.rfind("simulation:", 0) == 0) simulation = true;
      const bool number = line.rfind("    ", 0) == 0 && line.find(": ") != std::string::npos;
      if (!simulation || !number || line.find("gamma: 2.2") != std::string::npos) continue;
      EXPECT_TRUE(line.find("# source:") != std::string::npos || line.find("# assumed") != std::string::npos)
          << name << ": " << line;
    }
    EXPECT_TRUE(simulation) << name;
  }
}

// Of real devices every number has a source. The size of an image goes with its field of view, whose line has one, and
// the two numbers of the L515's law with the line above them.
TEST(SensorPresets, EveryNumberOfARealDeviceSaysWhereItIsFrom) {
  const std::vector<std::string> told_elsewhere = {"width_px: 1280",
                                                   "height_px: ", "T_color_depth: ", "constant_m: ", "proportional: "};
  for (const char* name : {"d455", "d435", "d415", "l515", "azure_kinect", "gemini_335", "zed_2i", "oak_d"}) {
    std::istringstream in(read_text_file(find_data_file("sensors", name)));
    int numbers = 0;
    for (std::string line; std::getline(in, line) && line.rfind("simulation:", 0) != 0;) {
      const std::size_t value = line.find_first_not_of(' ', line.find(": ") + 1);
      if (value == std::string::npos || std::isdigit(static_cast<unsigned char>(line[value])) == 0) continue;
      ++numbers;
      const bool elsewhere = std::any_of(told_elsewhere.begin(), told_elsewhere.end(), [&line](const std::string& key) {
        return line.find(key) != std::string::npos;
      });
      EXPECT_TRUE(elsewhere || line.find("# source:") != std::string::npos ||
                  line.find("# assumed") != std::string::npos)
          << name << ": " << line;
    }
    EXPECT_GE(numbers, load_sensor_preset(name).raw_depth ? 12 : 10) << name;
  }
}

// As the preset's file has them.
std::vector<double> imagers_x_m(const std::string& name) {
  const YamlTree tree = read_yaml_file(find_preset("sensors", name));
  Problems problems;
  return read_numbers(*tree.find("simulation")->find("depth")->find("imagers_x_m"), "imagers_x_m", 0, 2, {}, &problems)
      .value();
}

TEST(SensorPresets, TwoImagersAreABaselineApart) {
  for (const char* name : {"d455", "d435", "d415", "gemini_335", "zed_2i", "oak_d"}) {
    const SensorPreset preset = load_sensor_preset(name);
    const std::vector<double> imagers = imagers_x_m(name);
    ASSERT_EQ(imagers.size(), 2U);
    EXPECT_NEAR(imagers[1] - imagers[0], preset.stereo->baseline_m, 1e-12) << name;
  }
}

TEST(SensorPresets, ImpossibleValuesAreToldAllAtOnce) {
  const OwnData folder;
  folder.write("models/sensors/broken.yaml", R"(color:
  {width_px: 640, height_px: 480, hfov_deg: 190}
depth:
  min_m: 3
  max_m: 2
  stereo: {width_px: 640, hfov_deg: 80, baseline_m: -0.1, disparity_sigma_px: 0.08}
simulation:
  color: {full_well_electrons: -5, gama: 2.2}
  depth: {patchy_share: 0.7, ripple_share: 0.6, flying_share: 1.5}
)");
  const std::string error = error_text([] { load_sensor_device("broken"); });
  for (const char* part :
       {"broken.yaml:2: color.hfov_deg: 190", "depth.min_m: 3: must be less than max_m",
        "depth.stereo.baseline_m: -0.1", "simulation.color.full_well_electrons: -5", "simulation.color.gama", "gamma",
        "simulation.depth.patchy_share: 0.7: ", "simulation.depth.flying_share: 1.5: allowed is 0 to 1"})
    EXPECT_THAT(error, HasSubstr(part));
  EXPECT_THAT(error, Not(HasSubstr("is missing"))) << "a field of view that is refused was given";
}

TEST(SensorPresets, WhatIsWrongInOneIsToldOnceForAllCamerasOfARig) {
  const OwnData folder;
  folder.write("models/sensors/broken.yaml", "color: {width_px: 640, height_px: 480, hfov_deg: 190}\ndepth: none\n");
  const auto error_of = [](const std::string& sensor) {
    Problems problems;
    const std::string text = "cameras: {a: {sensor: " + sensor + "},\n  b: {sensor: " + sensor + "}}\n";
    std::vector<RigCamera> cameras;
    read_fields_of_block(parse_yaml(text, "rig.yaml"), "", &problems, [&cameras](FieldVisitor& visitor) {
      visit_rig_cameras(visitor, {{}, true}, cameras);
    });
    return problems.text();
  };
  const std::string error = error_of("broken"), reason = "color.hfov_deg: 190";
  EXPECT_THAT(error, HasSubstr("rig.yaml:1: cameras.a.sensor"));
  ASSERT_NE(error.find(reason), std::string::npos);
  EXPECT_EQ(error.find(reason), error.rfind(reason));
  // A name that is unknown is a mistake of each line.
  EXPECT_THAT(error_of("brocken"), AllOf(HasSubstr("rig.yaml:1: "), HasSubstr("rig.yaml:2: "), HasSubstr("broken")));
}

// A preset's own depth frame: simulated devices have it from the preset, real recordings have to tell it.
TEST(SensorPresets, RawDepthIsAPropertyOfTheDeviceThatARecordingHasToTell) {
  std::string text = read_text_file(find_preset("sensors", "d455"));
  for (const char* name : {"d455", "d435", "l515"}) {
    const SensorPreset preset = load_sensor_preset(name);
    EXPECT_FALSE(preset.delivers_raw_depth) << name;
    ASSERT_TRUE(preset.raw_depth.has_value()) << name;
    EXPECT_NEAR(preset.raw_depth->T_color_depth.translation.x(), imagers_x_m(name)[0], 1e-12) << name;
  }
  const OwnData folder;
  const std::string registered = "depth_frame: registered";
  folder.write("models/sensors/own.yaml", text.replace(text.find(registered), registered.size(), "depth_frame: raw"));
  folder.write("models/sensors/nowhere.yaml",
               "color: {width_px: 64, height_px: 48, hfov_deg: 60}\ndepth_frame: raw\ndepth: {unit_m: 0.001}\n");
  EXPECT_TRUE(load_sensor_preset("own").delivers_raw_depth);
  EXPECT_THAT(error_text([] { load_sensor_preset("nowhere"); }),
              HasSubstr("depth_frame: raw: raw needs a block depth.raw"));
  const std::string camera = "cameras:\n  a:\n    sensor: own\n";
  folder.write("rig.yaml",
               "board: {type: checkerboard, squares: [6, 5], square_mm: 100}\n" + camera +
                   "    intrinsics: {width_px: 64, height_px: 48, fx_px: 50, fy_px: 50, cx_px: 31, cy_px: 23}\n");
  EXPECT_THAT(error_text([&] { load_rig(folder / "rig.yaml"); }),
              HasSubstr("give depth.camera and depth.T_color_depth"));
  std::vector<RigCamera> cameras;
  read_fields_of_tree(parse_yaml("cameras: {a: {sensor: own}}", "simulated.yaml"), [&cameras](FieldVisitor& visitor) {
    visit_rig_cameras(visitor, {{}, true}, cameras);
  });
  const RigCamera& read = cameras.at(0);
  ASSERT_TRUE(read.depth && read.depth->own_camera);
  EXPECT_EQ(read.depth->own_camera->camera.width_px, 848);
}

}  // namespace
}  // namespace rigproof
