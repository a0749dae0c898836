#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "memroc_sample.h"
#include "rigproof/core/conventions.h"
#include "rigproof/formats/format.h"
#include "sample_data.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string problems_of(const MemrocFolder& folder) {
  return error_text([&] { open_input(folder.path()); });
}

TEST(MemrocLayout, IsReadAsARecording) {
  const MemrocFolder folder;
  ASSERT_EQ(detect_format(folder.path()).name, "memroc");
  const Recording recording = *open_input(folder.path()).recording;
  EXPECT_EQ(recording.rig.board.inner_corners_x(), 3) << "rows count along the board's x axis";
  EXPECT_EQ(recording.rig.board.inner_corners_y(), 4);
  EXPECT_EQ(recording.rig.board.square_m, 0.1);
  ASSERT_EQ(recording.rig.cameras.size(), 2U);
  const Camera& camera = recording.rig.cameras[0].camera;
  EXPECT_EQ(camera.fy_px, 801.0);
  EXPECT_EQ(camera.lens, Lens::kBrownConrady);
  EXPECT_EQ(camera.distortion, (std::array<double, 5>{0.1, -0.2, 0.001, 0.002, 0.05}));
  ASSERT_EQ(recording.frames[0].size(), 3U);
  ASSERT_EQ(recording.frames[1].size(), 2U);
  EXPECT_EQ(recording.frames[1][1].color_file, "camera2/image/0002.png");
  EXPECT_EQ(recording.frames[1][1].cloud_file, "camera2/clouds/0002.txt");
  EXPECT_EQ(recording.frames[1][1].stamp_s, recording.frames[0][2].stamp_s) << "one number, one stop";
  ASSERT_EQ(recording.odometry.size(), 3U);
  EXPECT_DOUBLE_EQ(recording.odometry[1].x_m, 0.5);
  EXPECT_DOUBLE_EQ(recording.odometry[1].y_m, 0.25);
  EXPECT_DOUBLE_EQ(recording.odometry[1].yaw_rad, 0.5 * kPi);
}

TEST(MemrocLayout, PosesMayHaveThreeRowsAndAPoseMayComeFromAnyCamera) {
  const MemrocFolder folder;
  folder.write("camera1/pose/0001.csv", "1 0 0 7\n0 1 0 8\n0 0 1 0\n");
  EXPECT_EQ(open_input(folder.path()).recording->odometry[1].x_m, 7.0);
  for (const char* name : {"image/0001.png", "clouds/0001.txt", "pose/0001.csv"}) {
    fs::create_directories((folder / "camera2" / name).parent_path());
    fs::rename(folder / "camera1" / name, folder / "camera2" / name);
  }
  EXPECT_EQ(open_input(folder.path()).recording->odometry[1].x_m, 7.0);
}

TEST(MemrocLayout, ContradictingPosesAreNamed) {
  const MemrocFolder folder;
  folder.write("camera2/pose/0002.csv", MemrocFolder::pose(1.1, 2));
  EXPECT_THAT(problems_of(folder), HasSubstr("camera2/pose/0002.csv: contradicts camera1/pose/0002.csv by 0.1"));
}

TEST(MemrocLayout, EveryProblemIsReportedAtOnce) {
  const MemrocFolder folder;
  folder.write("camera1/intrinsic_pars_file.yaml", MemrocFolder::intrinsics("x", "0.5"));
  folder.write("camera1/pose/0000.csv", "1,0,0\n");
  folder.write("camera1/pose/0001.csv", "1,0,nan,0\n");
  folder.write("camera1/pose/0002.csv", "2,0,0,0\n0,1,0,0\n0,0,1,0\n");
  folder.write("camera1/image/last.png", "png");
  fs::remove(folder / "camera2/pose/0002.csv");
  const std::string text = problems_of(folder);
  for (const char* part :
       {"intrinsic_pars_file.yaml:6: dist_k0: x: must be a number", "dist_k5: 0.5: the rational model is not supported",
        "camera1/pose/0000.csv: must be a 3x4 matrix", "camera1/pose/0001.csv:1: nan: must be a finite number",
        "camera1/pose/0002.csv: the upper left 3x3 block must be a rotation",
        "camera1/image/last.png: the name must be a number",
        "camera2/image/0002.png: has no pose of the same number in camera2/pose"})
    EXPECT_THAT(text, HasSubstr(part));
}

TEST(MemrocLayout, WhatIsNotSupportedSaysSo) {
  const MemrocFolder folder;
  const std::string info = folder.read("CalibrationInfo.yaml");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = info;
    text.replace(text.find(from), from.size(), to);
    folder.write("CalibrationInfo.yaml", text);
    return problems_of(folder);
  };
  EXPECT_THAT(with("resize_factor: 1", "resize_factor: 2"), HasSubstr("resize_factor: 2: only 1 is supported"));
  EXPECT_THAT(with("pattern_type: checkerboard", "pattern_type: charuco"), HasSubstr("must be one of checkerboard"));
  EXPECT_THAT(with("number_of_rows: 3", "number_of_rows: 4"), HasSubstr("looks the same when turned by 180 degrees"));
  EXPECT_THAT(with("number_of_cameras: 2", "number_of_cameras: 3"), HasSubstr("camera3"));
  EXPECT_THAT(with("prefix: camera", "prefix: ../camera"), HasSubstr("must be the beginning of a folder's name"));
  EXPECT_THAT(with("size: 0.1", "size: 0"), HasSubstr("size: 0: allowed is"));
  EXPECT_EQ(with("size: 0.1", "size: 0.2"), "");
}

TEST(MemrocLayout, PosesOffTheGroundAreRefused) {
  const MemrocFolder folder;
  folder.write("camera1/pose/0001.csv", "1,0,0,0\n0,0,-1,0\n0,1,0,0\n");
  EXPECT_THAT(problems_of(folder), HasSubstr("leaves the ground plane; the pose must be T_world_robot with z up"));
}

TEST(MemrocLayout, BecomesARecordingOfOurs) {
  const MemrocFolder folder;
  save_recording(*open_input(folder.path()).recording);
  const Recording again = load_recording(folder.path());
  EXPECT_EQ(again.frames[1][1].cloud_file, "camera2/clouds/0002.txt");
  EXPECT_EQ(again.odometry.size(), 3U);
}

TEST(Formats, InputsAreToldByTheirShape) {
  const TempFolder folder;
  folder.write("run/run.yaml", "");
  folder.write("bare/recording/rig.yaml", "");
  folder.write("monday/rig.yaml", "");
  folder.write("memroc/CalibrationInfo.yaml", "");
  folder.write("o/observations.json", "");
  EXPECT_EQ(detect_format(folder / "run").name, "run");
  EXPECT_EQ(detect_format(folder / "bare").name, "run") << "a run whose manifest is lost";
  EXPECT_EQ(detect_format(folder / "monday").name, "recording");
  EXPECT_EQ(detect_format(folder / "memroc").name, "memroc");
  EXPECT_EQ(detect_format(folder / "o").name, "observations");
  EXPECT_EQ(detect_format(folder / "o/observations.json").name, "observations");
}

TEST(Formats, WhatIsNoInputSaysWhatWasLookedForAndFound) {
  const TempFolder folder;
  folder.write("photos/a.png", "");
  folder.write("photos/b.png", "");
  const std::string text = error_text([&] { detect_format(folder / "photos"); });
  EXPECT_THAT(text, HasSubstr("run.yaml (a run), rig.yaml (a recording), CalibrationInfo.yaml (the MEMROC layout) and "
                              "observations.json were looked for; the folder holds a.png, b.png"));
  std::filesystem::create_directory(folder / "empty");
  EXPECT_THAT(error_text([&] { detect_format(folder / "empty"); }), HasSubstr("the folder is empty"));
  EXPECT_THAT(error_text([&] { detect_format(folder / "none"); }), HasSubstr("none: no such file or folder"));
  EXPECT_THAT(error_text([&] { detect_format(folder / "photos/a.png"); }), HasSubstr("observations (.json)"));
  folder.write("monday/rig.yaml", "");
  EXPECT_THAT(error_text([&] { detect_format(folder / "monday/rig.yaml"); }),
              HasSubstr("give the folder that holds this file"));
}

// What a command says that it takes, and what it can be asked to write, come from the registry.
TEST(Formats, ABagIsNamedAndWhatMakesARecordingOfIt) {
  const TempFolder folder;
  for (const char* name : {"a.mcap", "b/a.db3.zstd", "c/a.bag"}) {
    const fs::path file = folder.write(name, "x");
    EXPECT_THAT(error_text([&] { open_input(file); }), HasSubstr("is a bag of ROS; `rigproof init " + file.string()));
  }
  EXPECT_THAT(error_text([&] { open_input(folder / "b"); }), HasSubstr("`rigproof init " + (folder / "b").string()));
}

TEST(Formats, TellWhatTheyAre) {
  EXPECT_EQ(inputs_in_words(true), "a run, a recording, or a folder in the MEMROC layout");
  EXPECT_EQ(inputs_in_words(false), "a run, a recording, a folder in the MEMROC layout, or an observations.json");
  EXPECT_THAT(writable_formats(),
              testing::ElementsAre("recording", "memroc", "euroc", "opencv", "mrcal", "mcalib", "colmap"));
  EXPECT_THAT(error_text([] { writable_format("memrok"); }), HasSubstr("memroc"));
}

TEST(OpenInput, ReadsEveryKind) {
  const MemrocFolder memroc;
  EXPECT_EQ(open_input(memroc.path()).recording->rig.cameras.size(), 2U);
  const TempFolder folder;
  const auto write_recording = [&](const std::string& name) {
    Recording recording = sample_recording(folder / name);
    fs::create_directories(recording.folder);
    save_recording(recording);
  };
  write_recording("monday");
  write_recording("run/recording");
  save_manifest(sample_manifest(), folder / "run/run.yaml");
  save_observations(sample_observations(), folder / "o/observations.json");
  EXPECT_EQ(open_input(folder / "monday").recording->rig.name, "monday");
  const Input run = open_input(folder / "run");
  EXPECT_TRUE(run.run);
  EXPECT_EQ(run.recording->folder, folder / "run/recording");
  EXPECT_FALSE(run.observations);
  EXPECT_EQ(open_input(folder / "o").observations->stops.size(), 2U);
  EXPECT_EQ(open_input(folder / "o/observations.json").observations->stops.size(), 2U);
  EXPECT_THAT(error_text([&] { open_input(folder / "nothing"); }), HasSubstr("no such file or folder"));
}

// A partial copy of a run, without images or truth, still opens: its observations stand in for the images.
TEST(OpenInput, ObservationsMayReplaceTheRecordingOfARun) {
  const TempFolder folder;
  save_manifest(sample_manifest(), folder / "run.yaml");
  save_observations(sample_observations(), folder / "observations.json");
  const Input input = open_input(folder.path());
  EXPECT_FALSE(input.recording);
  ASSERT_TRUE(input.observations);
  EXPECT_EQ(input.format->name, "run");
}

}  // namespace
}  // namespace rigproof
