// `rigproof export` as a user types it.
#include <nlohmann/json.hpp>

#include "cli_fixture.h"
#include "schema_check.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kUrdf =
    "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n  <link name=\"base_footprint\"/>\n  <link name=\"left_link\"/>\n"
    "  <joint name=\"left_joint\" type=\"fixed\">\n    <parent link=\"base_footprint\"/>\n    <child "
    "link=\"left_link\"/>\n    <origin xyz=\"0.1 0 0.5\" rpy=\"0 0 0\"/>\n  </joint>\n</robot>\n";

// A folder as `calibrate` leaves it, with a result for left and right.
struct Monday : TempFolder {
  Monday() {
    write("rig.yaml", "board: {type: checkerboard, squares: [6, 5], square_mm: 110}\ncameras:\n" + camera("left") +
                          camera("right"));
    write("results/ml.yaml", result("solved"));
    write("robot.urdf", kUrdf);
  }
  static std::string camera(const std::string& name) {
    return "  " + name + ":\n    link: " + name +
           "_link\n    intrinsics: {width_px: 640, height_px: 480, fx_px: 500, fy_px: 500, cx_px: 320, cy_px: 240}\n";
  }
  static std::string result(const std::string& status) {
    const auto pose = [](const std::string& name) {
      return "  - {parent: base_footprint, child: " + name +
             ", translation_m: [0.11, 0, 0.52], quaternion_xyzw: [-0.5, 0.5, -0.5, 0.5], "
             "stddev: {tx_cm: 0.5, ty_cm: 0.4, tz_cm: 0.01, rx_deg: 0.001, ry_deg: 0.002, rz_deg: 0.1}}\n";
    };
    return "format: rigproof-result\nversion: 2\nmethod: ml\nstatus: " + status + "\ncamera_to_robot:\n" +
           pose("left") + pose("right") +
           "lenses:\n  - {camera: left, intrinsics: {width_px: 640, height_px: 480, fx_px: 502, fy_px: 502, cx_px: "
           "320, "
           "cy_px: 240}}\n";
  }
  ProcessOutput run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"export", (path() / "results/ml.yaml").string()});
    return rigproof_command(arguments);
  }
  std::string file(const std::string& name) const { return (path() / name).string(); }
};

TEST(Export, IntoAUrdfSaysWhatMovedAndKeepsWhatWas) {
  const Monday monday;
  const ProcessOutput output = monday.run({"--into", monday.file("robot.urdf"), "--camera", "left"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_THAT(output.out, AllOf(HasSubstr("joint left_joint (line 5)  left_link in base_footprint, for left"),
                                HasSubstr(" before  xyz 0.1 0 0.5  rpy 0 0 0"),
                                HasSubstr(" after   xyz 0.11 0 0.52  rpy 0 0 0"), HasSubstr(" moved   2.24 cm, 0 deg"),
                                HasSubstr("one sigma x 0.5, y 0.4, z 0.01 cm"), HasSubstr("up to 1.6 px from those of"),
                                HasSubstr("-m ml:told=exact"), HasSubstr("robot.urdf.bak")));
  EXPECT_EQ(monday.read("robot.urdf.bak"), kUrdf);
  std::string expected = kUrdf;
  expected.replace(expected.find("0.1 0 0.5"), 9, "0.11 0 0.52");
  EXPECT_EQ(monday.read("robot.urdf"), expected);
  EXPECT_THAT(monday.run({"--into", monday.file("robot.urdf"), "--camera", "left"}).out, HasSubstr("(as it was)"));
  EXPECT_EQ(monday.read("robot.urdf.bak"), kUrdf);
}

TEST(Export, HeightsCountFromTheParentThatIsGiven) {
  const Monday monday;
  const std::vector<std::string> base = {"--to", "static-tf", "--camera", "left", "--parent", "base_link"};
  EXPECT_THAT(monday.run(base).out, AllOf(HasSubstr("base_link is taken to be what the result calls base_footprint"),
                                          HasSubstr("--z 0.52 "), HasSubstr("--frame-id base_link")));
  std::vector<std::string> told = base;
  told.insert(told.end(), {"--parent-height-mm", "132"});
  EXPECT_THAT(monday.run(told).out, AllOf(HasSubstr("base_link, 13.2 cm above the ground"), HasSubstr("--z 0.388 ")));
  monday.write("tf_static.json",
               R"({"transforms": [{"parent": "base_footprint", "child": "base_link", "translation_m": [0, 0, 0.132], )"
               R"("quaternion_xyzw": [0, 0, 0, 1]}]})");
  EXPECT_THAT(monday.run(base).out, AllOf(HasSubstr("at 0, 0, 13.2 cm in base_footprint"), HasSubstr("--z 0.388 ")));
  const ProcessOutput nameless = monday.run({"--to", "static-tf", "--parent-height-mm", "132"});
  EXPECT_EQ(nameless.exit_code, 2);
  EXPECT_THAT(nameless.err, HasSubstr("--parent-height-mm: of which frame? Give --parent LINK"));
}

TEST(Export, WithoutAFileItGoesToStandardOutput) {
  const Monday monday;
  const ProcessOutput output = monday.run({"--to", "static-tf"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_THAT(output.out, AllOf(HasSubstr("#!/bin/sh\n# rigproof"), HasSubstr("--frame-id base_footprint"),
                                HasSubstr("--child-frame-id right_optical_frame"), HasSubstr("\nwait\n")));
  EXPECT_EQ(output.err, "");
}

TEST(Export, ACameraNeedsNoNameWhereItIsTheOnlyOne) {
  const Monday monday;
  const std::string optical = "0,0.1,0,-0.5,0.5,-0.5,0.5";
  const ProcessOutput output =
      monday.run({"--to", "static-tf", "--camera", "left", "--link", "device", "--optical", optical});
  EXPECT_THAT(output.out, AllOf(HasSubstr("--x 0.11 --y -0.1 --z 0.52"), HasSubstr("--child-frame-id device\n")));
  EXPECT_THAT(monday.run({"--to", "static-tf", "--link", "device"}).err, HasSubstr("CAMERA=device"));
}

TEST(Export, FilesKeepToTheirSchemas) {
  const Monday monday;
  const auto schema = [](const std::string& name) { return json::parse(rigproof_command({"schema", name}).out); };
  const json exported = json::parse(monday.run({"--to", "json"}).out);
  EXPECT_EQ(schema_violations(exported, schema("export")), "");
  EXPECT_EQ(exported["cameras"][0]["intrinsics"]["fx_px"], 502);
  const std::vector<std::vector<std::string>> commands = {
      {"--to", "urdf", "--json"},
      {"--to", "kalibr", "-o", monday.file("camchain.yaml"), "--json"},
      {"--into", monday.file("robot.urdf"), "--camera", "left", "--json"}};
  for (const auto& command : commands)
    EXPECT_EQ(schema_violations(json::parse(monday.run(command).out), schema("export_output")), "") << command[1];
  EXPECT_EQ(json::parse(monday.run(commands[2]).out)["files"][0]["changed"], false);
}

TEST(Export, AFileForEachCameraGoesIntoAFolder) {
  const Monday monday;
  EXPECT_THAT(monday.run({"--to", "camera_info"}).err, HasSubstr("name a folder"));
  EXPECT_EQ(monday.run({"--to", "camera_info", "-o", monday.file("infos")}).exit_code, 0);
  EXPECT_THAT(monday.read("infos/left.yaml"), HasSubstr("camera_name: left"));
  EXPECT_EQ(monday.run({"--to", "camera_info", "--camera", "right", "-o", monday.file("right.yaml")}).exit_code, 0);
  EXPECT_THAT(monday.read("right.yaml"), HasSubstr("camera_name: right"));
}

TEST(Export, MistakesAreNamedBeforeAnythingIsWritten) {
  const Monday monday;
  const std::string urdf = monday.file("robot.urdf");
  const std::vector<std::pair<std::vector<std::string>, std::string>> mistakes = {
      {{"--to", "urfd"}, "did you mean \"urdf\"?"},
      {{}, "--to: is missing"},
      {{"--to", "kalibr", "--into", urdf}, "leave out --to kalibr"},
      {{"--to", "urdf", "--camera", "rihgt"}, "did you mean \"right\"?"},
      {{"--camera", "rihgt"}, "did you mean \"right\"?"},  // beside the format that is missing
      {{"--into", urdf}, "right: " + urdf + ": has no link right_link"},
      {{"--into", urdf, "--camera", "left", "--joint", "left_jiont"}, "did you mean \"left_joint\"?"},
      {{"--to", "urdf", "--camera", "left", "--optical", "1,2,3"}, "seven numbers"},
      {{"--to", "urdf", "--camera", "left", "--optical", "1,2,3,0,0,0,2"}, "norm 1"},
      {{"--to", "json", "-o", monday.file("results/ml.yaml")}, "is what is read"},
      {{"--into", monday.file("none.urdf")}, "none.urdf: cannot read"},
      {{"--into", monday.file("rig.yaml")}, "is no XML"},
      {{"--to", "kalibr", "--rig", monday.file("results/ml.yaml")}, "ml.yaml"}};
  const auto before = tree_content(monday.path());
  for (const auto& [arguments, message] : mistakes) {
    const ProcessOutput output = monday.run(arguments);
    EXPECT_EQ(output.exit_code, 2) << message;
    EXPECT_THAT(output.err, HasSubstr(message));
    EXPECT_EQ(output.out, "");
  }
  EXPECT_EQ(tree_content(monday.path()), before);
}

TEST(Export, PartialResultsAreRefusedWithTheirExitCode) {
  const Monday monday;
  monday.write("results/ml.yaml", Monday::result("partial"));
  const ProcessOutput refused = monday.run({"--to", "urdf"});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("--partial"));
  EXPECT_EQ(monday.run({"--to", "urdf", "--partial"}).exit_code, 0);
}

// What calibrate writes, from the folder alone.
TEST(Export, AFolderWithOneResultIsEnough) {
  const Monday monday;
  EXPECT_THAT(rigproof_command({"export", monday.path().string(), "--to", "matrix"}).out,
              HasSubstr("pose of left in base_footprint"));
  monday.write("results/memroc.yaml", Monday::result("solved"));
  EXPECT_THAT(rigproof_command({"export", monday.path().string(), "--to", "matrix"}).err,
              HasSubstr("name one of memroc.yaml, ml.yaml"));
}

TEST(Export, ARenderedRunIsExportedFromEndToEnd) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  ASSERT_EQ(rigproof_command({"calibrate", recording.string(), "-q"}).exit_code, 0);
  const ProcessOutput output = rigproof_command({"export", recording.string(), "--to", "json"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  const json exported = json::parse(output.out);
  EXPECT_EQ(exported["cameras"].size(), 3U);
  EXPECT_EQ(exported["cameras"][0]["link"], "left_camera_link");
  EXPECT_EQ(exported["tree"].size(), 6U);
}

}  // namespace
}  // namespace rigproof
