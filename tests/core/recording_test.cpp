#include "rigproof/core/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "error_text.h"
#include "paths.h"
#include "pose_near.h"
#include "rigproof/core/file_schemas.h"
#include "rigproof/core/files.h"
#include "rigproof/core/odometry_csv.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/yaml.h"
#include "sample_data.h"
#include "schema_check.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const char* const kIntrinsics = "{width_px: 640, height_px: 480, fx_px: 500, fy_px: 500, cx_px: 319.5, cy_px: 239.5}";

std::string rig_text(const std::string& cameras, const std::string& more = "") {
  return "board: {type: checkerboard, squares: [6, 5], square_mm: 110}\ncameras:\n" + cameras + more;
}

std::string one_camera() { return rig_text("  left: {intrinsics: " + std::string(kIntrinsics) + "}\n"); }

/// A folder with rig.yaml, three rows of odometry and three images of one camera.
struct SmallRecording : TempFolder {
  SmallRecording() {
    write("rig.yaml", one_camera());
    write("odometry.csv", "stamp_s,x_m,y_m,yaw_rad\n10,0,0,0\n11,0.5,0,0.1\n12,1,0,0.2\n");
    for (const char* name : {"2.png", "10.png", "1.png"}) write(std::string("left/color/") + name, "png");
  }
  std::string problems() const {
    return error_text([this] { load_recording(path()); });
  }
};

TEST(Recording, SegmentsTellWhichFramesAreNoStops) {
  SmallRecording folder;
  EXPECT_TRUE(load_recording(folder.path()).segments.empty());
  folder.write("segments.csv", "kind,begin_s,end_s\nstraight,10.5,12.5\n");
  const Recording recording = load_recording(folder.path());
  ASSERT_EQ(recording.segments.size(), 1U);
  EXPECT_EQ(recording.segments[0].kind, kStraightSegment);
  ASSERT_EQ(recording.frames[0].size(), 3U);
  EXPECT_FALSE(recording.in_segment(recording.frames[0][0]));
  EXPECT_TRUE(recording.in_segment(recording.frames[0][1]));
  EXPECT_EQ(recording.frames_of(recording.segments[0], 0).size(), 2U);
  save_recording(recording);
  EXPECT_EQ(folder.read("segments.csv"), "kind,begin_s,end_s\nstraight,10.5,12.5\n");
}

TEST(Recording, MistakesInSegmentsAreNamed) {
  SmallRecording folder;
  folder.write("segments.csv", "kind,begin_s,end_s\nstrait,10,11\nstraight,12,x\nstraight,12,11\n");
  EXPECT_THAT(folder.problems(), testing::AllOf(HasSubstr("segments.csv:2: kind"), HasSubstr("allowed is straight"),
                                                HasSubstr("segments.csv:3: end_s"), HasSubstr("before begin_s")));
  folder.write("segments.csv", "10,12\n");
  EXPECT_THAT(folder.problems(), HasSubstr("kind,begin_s,end_s"));
}

TEST(Recording, RoundTripKeepsEveryValueAndEveryByte) {
  const TempFolder folder;
  const Recording recording = sample_recording(folder / "a");
  for (const auto& frames : recording.frames)
    for (const CameraFrame& frame : frames) {
      folder.write("a/" + frame.color_file, "png");
      if (!frame.depth_file.empty()) folder.write("a/" + frame.depth_file, "png");
    }
  save_recording(recording);
  Recording again = load_recording(folder / "a");
  ASSERT_EQ(again.rig.cameras.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const RigCamera &a = recording.rig.cameras[i], &b = again.rig.cameras[i];
    EXPECT_EQ(a.name, b.name) << "cameras keep the order of the file";
    EXPECT_EQ(a.sensor, b.sensor);
    EXPECT_EQ(a.link, b.link);
    EXPECT_EQ(a.camera.fx_px, b.camera.fx_px);
    EXPECT_EQ(a.camera.distortion, b.camera.distortion);
    EXPECT_EQ(a.camera.lens, b.camera.lens);
    ASSERT_EQ(a.depth.has_value(), b.depth.has_value());
    ASSERT_EQ(again.frames[i].size(), 3U);
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_EQ(recording.frames[i][j].color_file, again.frames[i][j].color_file);
      EXPECT_EQ(recording.frames[i][j].depth_file, again.frames[i][j].depth_file);
      EXPECT_EQ(recording.frames[i][j].stamp_s, again.frames[i][j].stamp_s);
      EXPECT_EQ(recording.frames[i][j].exposure_s, again.frames[i][j].exposure_s);
    }
  }
  EXPECT_TRUE(IsPoseNear(recording.rig.cameras[0].depth->own_camera->T_color_depth,
                         again.rig.cameras[0].depth->own_camera->T_color_depth, 0.0, 1e-15));
  EXPECT_EQ(recording.rig.board, again.rig.board);
  EXPECT_EQ(recording.rig.odometry_noise.sigma_xy_m, again.rig.odometry_noise.sigma_xy_m);
  EXPECT_EQ(recording.rig.odometry_noise.sigma_yaw_rad, again.rig.odometry_noise.sigma_yaw_rad);
  EXPECT_EQ(recording.rig.odometry_noise.rotation_centre_m, again.rig.odometry_noise.rotation_centre_m);
  for (const auto prior : {&OdometryNoise::scale_sigma, &OdometryNoise::yaw_factor_sigma,
                           &OdometryNoise::veer_sigma_rad_per_m, &OdometryNoise::turn_lag_sigma_s})
    EXPECT_EQ(recording.rig.odometry_noise.*prior, again.rig.odometry_noise.*prior);
  for (std::size_t c = 0; c < recording.rig.cameras.size(); ++c)
    EXPECT_EQ(recording.rig.cameras[c].clock_offset_sigma_s, again.rig.cameras[c].clock_offset_sigma_s);
  EXPECT_EQ(recording.rig.accept->angle_rad, again.rig.accept->angle_rad);
  again.folder = folder / "b";
  fs::create_directory(again.folder);
  save_recording(again);
  for (const char* file : {"rig.yaml", "odometry.csv", "left/frames.csv", "center/frames.csv", "right/frames.csv"})
    EXPECT_EQ(folder.read(std::string("a/") + file), folder.read(std::string("b/") + file)) << file;
}

TEST(Recording, DepthAndCloudsUnderOtherNamesGetColumns) {
  const SmallRecording folder;
  Recording recording = load_recording(folder.path());
  recording.frames[0][1].cloud_file = "left/elsewhere/scan.pcd";
  save_recording(recording);
  EXPECT_THAT(folder.read("left/frames.csv"), HasSubstr("color/2.png,11,0,,elsewhere/scan.pcd"));
  EXPECT_EQ(load_recording(folder.path()).frames[0][1].cloud_file, "left/elsewhere/scan.pcd");
}

// ------------------------------------------------------------------------------------------- a real robot's recording

TEST(Recording, ImagesInNaturalOrderPairWithOneRowEach) {
  const SmallRecording folder;
  folder.write("left/depth/2.png", "png");
  folder.write("left/cloud/10.pcd", "pcd");
  const Recording recording = load_recording(folder.path());
  ASSERT_EQ(recording.frames[0].size(), 3U);
  EXPECT_EQ(recording.frames[0][0].color_file, "left/color/1.png");
  EXPECT_EQ(recording.frames[0][2].color_file, "left/color/10.png");
  EXPECT_EQ(recording.frames[0][1].stamp_s, 11.0);
  EXPECT_EQ(recording.frames[0][1].depth_file, "left/depth/2.png");
  EXPECT_EQ(recording.frames[0][2].cloud_file, "left/cloud/10.pcd");
  EXPECT_EQ(recording.rig.robot_frame, "base_footprint");
  EXPECT_EQ(recording.rig.cameras[0].link, "left");
}

TEST(Recording, TwoCamerasWithOneFolderAreRefused) {
  const SmallRecording folder;
  const auto problems_with = [&folder](const std::string& of_right) {
    folder.write("rig.yaml", rig_text("  left: {intrinsics: " + std::string(kIntrinsics) + "}\n  right:\n    folder: " +
                                      of_right + "\n    intrinsics: " + kIntrinsics + "\n"));
    return folder.problems();
  };
  fs::create_directory_symlink("left", folder / "link");
  for (const char* same : {"left", "left/", "./left", "left/color/..", "link"})
    EXPECT_THAT(problems_with(same), testing::AllOf(HasSubstr("rig.yaml:5: cameras.right.folder: "),
                                                    HasSubstr("holds the images of left already (folder left); every "
                                                              "camera needs a folder of its own")))
        << same;
  folder.write("second/2.png", "png");
  folder.write("second/10.png", "png");
  folder.write("second/1.png", "png");
  EXPECT_EQ(problems_with("second"), "");
}

TEST(Recording, AnotherSeparatorThanACommaIsOneError) {
  SmallRecording folder;
  const auto count_lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  for (const auto& [text, name] : {std::make_pair("stamp_s;x_m;y_m;yaw_rad\n10;0;0;0\n11;0,5;0;0,1\n", "semicolons"),
                                   {"10;0;0;0\n11;0.5;0;0.1\n12;1;0;0.2\n", "semicolons"},
                                   {"stamp_s\tx_m\ty_m\tyaw_rad\n10\t0\t0\t0\n", "tabs"},
                                   {"10 0 0 0\n11 0.5 0 0.1\n", "spaces"}}) {
    folder.write("odometry.csv", text);
    const std::string problems = error_text([&folder] {
      Problems found;
      read_odometry_csv(folder / "odometry.csv", &found);
      found.throw_if_any();
    });
    EXPECT_THAT(problems, testing::AllOf(HasSubstr("odometry.csv:1: "), HasSubstr("separated by " + std::string(name)),
                                         HasSubstr("commas are needed")));
    EXPECT_EQ(count_lines(problems), 0) << problems;
  }
  folder.write("odometry.csv", "stamp_s,x_m,y_m,yaw_rad\n10,0,0,0\n11,0.5,0,0.1\n12,1,0,0.2\n");
  folder.write("left/frames.csv", "file;stamp_s\ncolor/1.png;10\n");
  EXPECT_THAT(folder.problems(), HasSubstr("frames.csv:1: file;stamp_s: the columns are separated by semicolons"));
  fs::remove(folder / "left/frames.csv");
  folder.write("segments.csv", "kind;begin_s;end_s\nstraight;10;11\n");
  EXPECT_THAT(folder.problems(), HasSubstr("segments.csv:1: kind;begin_s;end_s: the columns are separated by"));
}

TEST(Recording, NamesThatAreStampsAreStamps) {
  const TempFolder folder;
  folder.write("rig.yaml", one_camera());
  folder.write("odometry.csv", "1699999.0,0,0,0\n1699999.5,0,0,0\n1700000,1,0,0\n");
  folder.write("left/1699999.123.png", "png");
  folder.write("left/1699999250000000.png", "png");
  const Recording recording = load_recording(folder.path());
  ASSERT_EQ(recording.frames[0].size(), 2U);
  EXPECT_DOUBLE_EQ(recording.frames[0][0].stamp_s, 1699999.123);
  EXPECT_DOUBLE_EQ(recording.frames[0][1].stamp_s, 1699999.25) << "16 digits and more are nanoseconds";
}

TEST(Recording, ImagesWithoutTimeSayWhatToGive) {
  const SmallRecording folder;
  folder.write("left/color/11.png", "png");
  EXPECT_THAT(folder.problems(), HasSubstr("left: tells no time of its 4 images, and the odometry has 3 rows. Give "
                                           "frames.csv (file,stamp_s)"));
}

TEST(Recording, ACameraWithoutImagesIsNamed) {
  const SmallRecording folder;
  fs::remove_all(folder / "left/color");
  EXPECT_THAT(folder.problems(), HasSubstr("left: holds no image"));
  fs::rename(folder / "left", folder / "lfet");
  EXPECT_THAT(folder.problems(), HasSubstr("left: no such folder; did you mean \"lfet\"? known: lfet"));
  fs::remove_all(folder / "lfet");
  EXPECT_THAT(folder.problems(), HasSubstr("left: no such folder"));
}

TEST(Recording, FramesCsvReportsEveryBadRow) {
  const SmallRecording folder;
  folder.write("left/frames.csv",
               "file,stamp_s,exposure_s\ncolor/1.png,10,0.01\n../../secret.png,11,0.01\ncolor/2.png,nan,0.01\n"
               "color/10.png,10,-3\n/etc/passwd,12,0\n");
  const std::string text = folder.problems();
  EXPECT_THAT(text, HasSubstr("frames.csv:3: file: ../../secret.png: leaves the recording"));
  EXPECT_THAT(text, HasSubstr("frames.csv:4: stamp_s: nan: must be a finite number"));
  EXPECT_THAT(text, HasSubstr("frames.csv:5: exposure_s: -3: must be a number, 0 to 100"));
  EXPECT_THAT(text, HasSubstr("frames.csv:6: file: /etc/passwd: leaves the recording"));
  EXPECT_THAT(text, HasSubstr("frames.csv:5: stamp_s: 10: left/color/10.png has the stamp of left/color/1.png"));
}

TEST(Recording, FramesCsvWithoutItsHeaderOrWithSurplusFieldsIsRefused) {
  const SmallRecording folder;
  folder.write("left/frames.csv", "color/1.png,10\ncolor/2.png,11\n");
  EXPECT_THAT(folder.problems(), HasSubstr("frames.csv:1: file: the column is missing; Columns: color/1.png, 10"));
  folder.write("left/frames.csv", "10,11\n");
  EXPECT_THAT(folder.problems(), HasSubstr("frames.csv:1: the first line must name the columns: file,stamp_s"));
  folder.write("left/frames.csv", "file,stamp_s\ncolor/1.png,10\ncolor/2.png,11,5\n");
  EXPECT_THAT(folder.problems(), HasSubstr("frames.csv:3: "));
  folder.write("left/frames.csv", "");
  EXPECT_THAT(folder.problems(), HasSubstr("frames.csv: is empty"));
}

TEST(Recording, TwoImagesOfOneNameAreRefused) {
  const SmallRecording folder;
  folder.write("left/color/2.jpg", "jpg");
  EXPECT_THAT(folder.problems(), HasSubstr("two files with one stem; one of them must go"));
}

TEST(Recording, LinksThatLeaveTheFolderAreRefused) {
  const TempFolder outside;
  outside.write("a.png", "png");
  const SmallRecording folder;
  fs::remove(folder / "left/color/1.png");
  fs::create_symlink(outside / "a.png", folder / "left/color/1.png");
  EXPECT_THAT(folder.problems(), HasSubstr("leaves the folder through a link"));
  fs::remove_all(folder / "left");
  fs::create_directory_symlink(outside.path(), folder / "left");
  EXPECT_THAT(folder.problems(), HasSubstr("leaves the folder through a link"));
}

// ---------------------------------------------------------------------------------------------------------- odometry

std::vector<OdometrySample> read_odometry(const std::string& text, std::string* problems_text = nullptr) {
  const TempFolder folder;
  folder.write("odometry.csv", text);
  Problems problems;
  const auto odometry = read_odometry_csv(folder / "odometry.csv", &problems);
  std::string found = problems.text();
  const std::string prefix = folder.path().string() + "/";
  for (std::size_t at = found.find(prefix); at != std::string::npos; at = found.find(prefix))
    found.erase(at, prefix.size());
  if (problems_text != nullptr) *problems_text = found;
  EXPECT_TRUE(problems_text != nullptr || found.empty()) << found;
  return odometry;
}

TEST(Odometry, HeaderColumnsMayComeInAnyOrderWithOthersBetween) {
  const auto odometry =
      read_odometry("yaw_rad, ticks ,x_m,stamp_s,y_m\r\n0.5,77,1,10,2\r\n# note\r\n\r\n0.6,78,1.5,11,2\r\n");
  ASSERT_EQ(odometry.size(), 2U);
  EXPECT_EQ(odometry[0].stamp_s, 10.0);
  EXPECT_EQ(odometry[0].x_m, 1.0);
  EXPECT_EQ(odometry[0].y_m, 2.0);
  EXPECT_EQ(odometry[0].yaw_rad, 0.5);
}

TEST(Odometry, WithoutHeaderThereAreFourColumns) {
  EXPECT_EQ(read_odometry("1,2,3,0.4\n2,2,3,0.4,").size(), 2U);
  EXPECT_EQ(read_odometry("\xEF\xBB\xBFstamp_s,x_m,y_m,yaw_rad\n1,2,3,0.4\n").size(), 1U);
}

// A pose with a quaternion, and decimal commas: the first four fields are not what the reader asks for.
TEST(Odometry, ColumnsThatNothingNamesAreNotGuessed) {
  std::string text;
  read_odometry("1,2,3,0,0,0,0.1,0.99\n", &text);
  EXPECT_EQ(text,
            "odometry.csv:1: has 8 columns; without a first line that names them there may be 4, and decimals need "
            "points, not commas: stamp_s,x_m,y_m,yaw_rad are needed");
  read_odometry("stamp_s,x_m,y_m,yaw_rad\n1,5,2,0,3,0,0,1\n", &text);
  EXPECT_EQ(text,
            "odometry.csv:2: has 8 columns; the first line names 4, and decimals need points, not commas: "
            "stamp_s,x_m,y_m,yaw_rad are needed");
  read_odometry("1,5;2,0;3,0;0,1\n", &text);
  EXPECT_EQ(text,
            "odometry.csv:1: 1: the columns are separated by semicolons; commas are needed, and points in decimals");
}

TEST(Odometry, EveryBadRowIsReported) {
  std::string text;
  read_odometry("stamp_s,x_m,y_m,yaw_rad\n1,0,0,0\n2,nan,0,0\n3,0,0\n2.5,0,inf,x\n1,0,0,0\n0.5,0,0,0\n", &text);
  EXPECT_EQ(text,
            "odometry.csv:3: x_m: nan: must be a finite number\n"
            "odometry.csv:4: has 3 columns; 4 are needed: stamp_s,x_m,y_m,yaw_rad, separated by commas\n"
            "odometry.csv:5: y_m: inf: must be a finite number\n"
            "odometry.csv:5: yaw_rad: x: must be a finite number\n"
            "odometry.csv:6: stamp_s: 1: repeats the stamp of the row before; stamps must increase\n"
            "odometry.csv:7: stamp_s: 0.5: goes back in time; stamps must increase");
}

TEST(Odometry, WrongColumnsNameTheNearest) {
  std::string text;
  read_odometry("stamp_s,x_m,y_m,yaw_deg\n1,2,3,4\n", &text);
  EXPECT_EQ(
      text,
      "odometry.csv:1: yaw_rad: the column is missing; is \"yaw_deg\" meant? Columns: stamp_s, x_m, y_m, yaw_deg");
}

TEST(Odometry, AFloodOfProblemsIsCut) {
  std::string rows, text;
  for (int i = 0; i < 1000; ++i) rows += "x,0,0,0\n";
  read_odometry("1,0,0,0\n" + rows, &text);
  EXPECT_THAT(text, HasSubstr("and 980 more problems of this file"));
  read_odometry("", &text);
  EXPECT_EQ(text, "odometry.csv: is empty; it needs rows of stamp_s,x_m,y_m,yaw_rad");
  read_odometry("stamp_s,x_m,y_m,yaw_rad\n", &text);
  EXPECT_EQ(text, "odometry.csv: is empty; it needs rows of stamp_s,x_m,y_m,yaw_rad");
  read_odometry(std::string("\0\0\0\0", 4), &text);
  EXPECT_THAT(text, HasSubstr("is no text"));
}

TEST(Odometry, ReadsBackToTheSameBits) {
  const Recording recording = sample_recording("");
  const auto again = read_odometry(odometry_csv(recording.odometry));
  ASSERT_EQ(again.size(), recording.odometry.size());
  for (std::size_t i = 0; i < again.size(); ++i) EXPECT_EQ(again[i].x_m, recording.odometry[i].x_m);
}

// --------------------------------------------------------------------------------------------------------------- rig

std::string rig_problems(const std::string& text) {
  const TempFolder folder;
  folder.write("rig.yaml", text);
  std::string found = error_text([&] { load_rig(folder / "rig.yaml"); });
  const std::string prefix = folder.path().string() + "/";
  for (std::size_t at = found.find(prefix); at != std::string::npos; at = found.find(prefix))
    found.erase(at, prefix.size());
  return found;
}

Board read_board(const std::string& text) {
  const TempFolder folder;
  folder.write("rig.yaml", "board: " + text + "\ncameras:\n  left: {intrinsics: " + kIntrinsics + "}\n");
  return load_rig(folder / "rig.yaml").board;
}

TEST(Rig, TheShortestUsefulFileTakesSensorAndCameraInfo) {
  const TempFolder folder;
  folder.write("rig.yaml", rig_text("  left: {sensor: d455, folder: cam0, link: left_link}\n",
                                    "odometry: wheel.csv\naccept: {xy_mm: 8, z_mm: 4, angle_deg: 0.2}\n"));
  folder.write("cam0/camera_info.yaml",
               "image_width: 640\nimage_height: 480\ncamera_name: left\n"
               "camera_matrix: {rows: 3, cols: 3, data: [500, 0, 320, 0, 501, 240, 0, 0, 1]}\n"
               "distortion_model: plumb_bob\n"
               "distortion_coefficients: {rows: 1, cols: 5, data: [0.1, -0.2, 0.001, 0.002, 0.05]}\n"
               "rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n");
  const Rig rig = load_rig(folder / "rig.yaml");
  const RigCamera& left = rig.cameras.at(0);
  EXPECT_EQ(left.camera.fy_px, 501.0);
  EXPECT_EQ(left.camera.lens, Lens::kBrownConrady);
  EXPECT_EQ(left.camera.distortion[4], 0.05);
  EXPECT_EQ(left.folder, "cam0");
  // s / (f B) of the D455 at 848 pixels: 0.08 / (446.8 * 0.095).
  EXPECT_NEAR(left.depth->noise.inverse_depth_sigma_per_m, 0.001885, 1e-6);
  EXPECT_EQ(rig.odometry_file, "wheel.csv");
  EXPECT_DOUBLE_EQ(rig.accept->xy_m, 0.008);
  EXPECT_EQ(rig.board.squares_x, 6);
  EXPECT_DOUBLE_EQ(rig.board.square_m, 0.11);
}

TEST(Rig, FramesOfTheTreeAreReadAndWritten) {
  const TempFolder folder;
  const auto text = [](const std::string& frames) {
    return rig_text("  left: {" + frames + ", intrinsics: " + kIntrinsics + "}\n");
  };
  folder.write("rig.yaml", text("link: left_link, optical_frame: left_optical, T_link_camera: {translation_m: [0, "
                                "0.015, 0], quaternion_xyzw: [-0.5, 0.5, -0.5, 0.5]}"));
  const Rig rig = load_rig(folder / "rig.yaml");
  save_rig(rig, folder / "again.yaml");
  const RigCamera left = load_rig(folder / "again.yaml").cameras.at(0);
  EXPECT_EQ(left.link, "left_link");
  EXPECT_EQ(left.optical_frame, "left_optical");
  ASSERT_TRUE(left.T_link_camera);
  EXPECT_EQ(left.T_link_camera->translation.y(), 0.015);
  EXPECT_EQ(left.T_link_camera->rotation.x(), -0.5);
  const std::string pose = "T_link_camera: {translation_m: [0, 0, 0], quaternion_xyzw: [0, 0, 0, 1]}";
  EXPECT_THAT(rig_problems(text("link: eye, optical_frame: eye, " + pose)),
              HasSubstr("cameras.left.T_link_camera: a block: link and optical_frame are one frame"));
  EXPECT_THAT(rig_problems(text(pose)), HasSubstr("is a pose in `link`, which is not given"));
  EXPECT_THAT(rig_problems(text("link: l, T_link_camera: {translation_m: [0, 0], quaternion_xyzw: [0, 0, 0, 2]}")),
              testing::AllOf(HasSubstr("T_link_camera.translation_m"), HasSubstr("has the norm 2")));
}

TEST(Rig, CameraInfoOfRosMessagesIsRead) {
  const TempFolder folder;
  folder.write("rig.yaml", rig_text("  left: {camera_info: info.yaml}\n"));
  const std::string head = "height: 480\nwidth: 640\nk: [500, 0, 320, 0, 501, 240, 0, 0, 1]\n";
  const auto load = [&](const std::string& text) {
    folder.write("left/info.yaml", head + text);
    return load_rig(folder / "rig.yaml").cameras.at(0).camera;
  };
  EXPECT_EQ(load("distortion_model: equidistant\nd: [0.1, 0.2, 0.3, 0.4]\n").lens, Lens::kKannalaBrandt);
  EXPECT_EQ(load("distortion_model: plumb_bob\nd: [0, 0, 0, 0, 0]\n").lens, Lens::kPinhole);
  EXPECT_EQ(load("distortion_model: rational_polynomial\nd: [0.1, 0, 0, 0, 0, 0, 0, 0]\n").lens, Lens::kBrownConrady);
  EXPECT_EQ(load("distortion_model: kannala_brandt\nd: [0, 0, 0, 0]\n").lens, Lens::kKannalaBrandt);
  // Half of the sensor's 640x480 in super-pixels, as in messages.
  const Camera binned = load(
      "d: []\nbinning_x: 2\nbinning_y: 2\nroi: {x_offset: 80, y_offset: 60, width: 480, "
      "height: 360, do_rectify: false}\n---\nheight: 1\n");
  EXPECT_EQ(binned.width_px, 240);
  EXPECT_EQ(binned.cx_px, (320.0 - 80.0 - 0.5) / 2.0);
  EXPECT_THAT(error_text([&] { load("d: []\nroi: {x_offset: 640, width: 1, height: 1}\n"); }),
              HasSubstr("info.yaml:5: roi: a block: the region of interest reaches beyond the image"));
  EXPECT_THAT(error_text([&] { load("d: [" + joined(std::vector<std::string>(12, "0.01")) + "]\n"); }),
              HasSubstr("info.yaml:4: d: a list of 12: D has 12 coefficients"));
  EXPECT_THAT(error_text([&] { load("distortion_model: thin_prism\nd: [0]\n"); }),
              HasSubstr("\"thin_prism\" is not supported; plumb_bob"));
  EXPECT_THAT(error_text([&] {
                load(
                    "d: [0]\n"
                    "K: [500, 1, 320, 0, 501, 240, 0, 0, 1]\n");
              }),
              HasSubstr("skew is not supported"));
}

// As in bags: by one of our lenses where that is near enough. A recording's images are not touched.
TEST(Rig, CameraInfoOfARationalLensIsFitted) {
  const TempFolder folder;
  folder.write("rig.yaml", rig_text("  left: {camera_info: info.yaml}\n"));
  const auto load = [&](const std::string& d) {
    folder.write("left/info.yaml",
                 "height: 480\nwidth: 640\nk: [500, 0, 320, 0, 501, 240, 0, 0, 1]\n"
                 "distortion_model: rational_polynomial\nd: " +
                     d + "\n");
    return load_rig(folder / "rig.yaml").cameras.at(0).camera;
  };
  EXPECT_EQ(load("[0.1, 0, 0, 0, 0, 0, 0, 0]").lens, Lens::kBrownConrady);
  Eigen::Vector2d pixel;
  ASSERT_TRUE(load("[0, 0, 0, 0, 0, 0.1, 0, 0]").project({0.5, 0.3, 1.0}, &pixel));
  const double ratio = 1.0 / (1.0 + 0.1 * (0.25 + 0.09));
  EXPECT_LT((pixel - Eigen::Vector2d(500 * 0.5 * ratio + 320, 501 * 0.3 * ratio + 240)).norm(), 0.25);
  EXPECT_THAT(error_text([&] { load("[4, 0, 0, 0, 0, 8, 0, 0]"); }),
              testing::AllOf(HasSubstr("info.yaml: no lens of ours comes near these coefficients"),
                             HasSubstr("`rigproof init`")));
}

TEST(Rig, CameraInfoOfOpenCvIsRead) {
  const TempFolder folder;
  folder.write("rig.yaml", rig_text("  left: {camera_info: info.yaml}\n"));
  const auto load = [&](const std::string& text) {
    folder.write("left/info.yaml", text);
    return load_rig(folder / "rig.yaml").cameras.at(0).camera;
  };
  const auto storage = [](const std::string& size, const std::string& K, const std::string& D) {
    return "%YAML:1.0\n---\ncalibration_time: \"Mon 30 Nov 2026\"\n" + size + K +
           ": !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 500., 0., 320., 0., 5.01e+02, 240., 0.,\n"
           "       0., 1. ]\n" +
           D + ": !!opencv-matrix\n   rows: 4\n   cols: 1\n   dt: d\n   data: [ 0.1, -2.0e-01, 1.0e-03, 2.0e-03 ]\n";
  };
  const std::string size = "image_width: 640\nimage_height: 480\n";
  const Camera brown = load(storage(size, "camera_matrix", "distortion_coefficients"));
  EXPECT_EQ(brown.lens, Lens::kBrownConrady);
  EXPECT_EQ(brown.fy_px, 501.0);
  EXPECT_EQ(brown.distortion[3], 0.002);
  for (const std::string& same :
       {storage("image_Width: 640\nimage_Height: 480\n", "Camera_Matrix", "Distortion_Coefficients"),
        storage("imageSize: [640, 480]\n", "K", "D")}) {
    const Camera camera = load(same);
    EXPECT_EQ(camera.width_px, 640);
    EXPECT_EQ(camera.fy_px, 501.0);
    EXPECT_EQ(camera.distortion, brown.distortion);
  }
  EXPECT_EQ(load(storage(size + "fisheye_model: 1\n", "camera_matrix", "distortion_coefficients")).lens,
            Lens::kKannalaBrandt);
  // What OpenCV writes beside, and how editors begin and end lines.
  const std::string plain = storage(size, "camera_matrix", "distortion_coefficients");
  for (const std::string& same : {plain + "roi: [0, 0, 640, 360]\n", plain + "R: [0.1, 0.2, 0.3]\n",
                                  plain + "P: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n", "\xef\xbb\xbf" + plain, "\r\n" + plain})
    EXPECT_EQ(load(same).distortion, brown.distortion) << same;
  EXPECT_THAT(error_text([&] { load(storage("imageSize: [640.7, 480]\n", "K", "D")); }),
              AllOf(HasSubstr("imageSize: "), HasSubstr("must be whole numbers of pixels")));
  EXPECT_THAT(error_text([&] { load("[image]\n\nwidth\n640\n"); }), HasSubstr("a file of intrinsics is YAML of"));
  EXPECT_THAT(error_text([&] { load("stereo:\n  M1: [1]\n"); }),
              HasSubstr("info.yaml: holds no intrinsics that can be read"));
}

// A file that describes the camera whole needs nothing of the preset, but says a thing that is not so.
TEST(Rig, ASensorThatThereIsNotIsNamedThoughNothingIsMissing) {
  const std::string text =
      rig_problems(rig_text("  left: {sensor: nonsense, intrinsics: " + std::string(kIntrinsics) + ", depth: none}\n"));
  EXPECT_THAT(text, HasSubstr("rig.yaml:3: cameras.left.sensor: nonsense: there is no \"nonsense\" among the presets"));
  EXPECT_THAT(text, HasSubstr("or leave this key out: the file describes the camera itself"));
}

TEST(Rig, ASensorMayBeAFileBesideTheRig) {
  const TempFolder folder;
  folder.write("mine.yaml", "color: {width_px: 640, height_px: 480, hfov_deg: 90}\ndepth: none\n");
  const auto file = folder.write("rigs/rig.yaml",
                                 "robot: husky\nboard: checkerboard_5x4_100mm\ncameras:\n"
                                 "  left: {sensor: ../mine.yaml}\n  right: {sensor: other.yaml}\n");
  std::vector<RigCamera> cameras;
  RigReadOptions options;
  options.nominal_intrinsics = true;
  const auto read = [&] {
    read_fields(std::filesystem::relative(file), [&](FieldVisitor& visitor) {
      for (const char* key : {"robot", "board"}) visitor.ignored(key, "");
      visit_rig_cameras(visitor, options, cameras, {});
    });
  };
  EXPECT_THAT(error_text(read),
              testing::AllOf(HasSubstr("rig.yaml:5: cameras.right.sensor"), HasSubstr("other.yaml: no such file"),
                             HasSubstr("presets: azure_kinect, d415")));
  folder.write("rigs/other.yaml", "color: {width_px: 800, height_px: 480, hfov_deg: 90}\ndepth: none\n");
  read();
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_TRUE(std::filesystem::path(cameras[1].sensor).is_absolute()) << "else a preset may be taken for it";
  EXPECT_EQ(cameras[0].camera.width_px, 640);
  EXPECT_EQ(cameras[1].camera.width_px, 800);
  EXPECT_EQ(load_sensor_preset(cameras[0].sensor).camera.fx_px, 320.0);
  // Elsewhere there is no such file: what is written does without it.
  Rig rig;
  rig.cameras = cameras;
  save_rig(rig, folder / "saved.yaml");
  EXPECT_THAT(read_text_file(folder / "saved.yaml"), testing::Not(HasSubstr("sensor:")));
}

TEST(Rig, EveryProblemIsReportedAtOnce) {
  const std::string text = rig_problems(
      "board: {type: circles, squares: [6], square_mm: -1}\n"
      "robot_fram: base\n"
      "odometry: {file: a.csv, noise: {model: per_pos, sigma_xy_mm: -1}}\n"
      "cameras:\n"
      "  left: {sensor: d545, intrinsics: {width_px: 640, height_px: 480, fx_px: 0, fy_px: 500, cx_px: 1, cy_px: "
      ".inf}}\n"
      "  center: {link: c}\n"
      "  \"../x\": {intrinsics: " +
      std::string(kIntrinsics) +
      "}\n"
      "accept: {xy_mm: 8}\n");
  EXPECT_THAT(text, HasSubstr("rig.yaml:1: board.type: circles: must be one of checkerboard"));
  EXPECT_THAT(text, HasSubstr("rig.yaml:1: board.squares: a list of 1: must be a list of 2 numbers"));
  EXPECT_THAT(text, HasSubstr("rig.yaml:1: board.square_mm: -1: allowed is 0.1 to 1"));
  EXPECT_THAT(text, HasSubstr("rig.yaml:2: robot_fram: unknown key; did you mean \"robot_frame\"?"));
  EXPECT_THAT(text, HasSubstr("rig.yaml:3: odometry.noise.model: per_pos: must be one of unknown, per_pose"));
  EXPECT_THAT(text, HasSubstr("rig.yaml:3: odometry.noise.sigma_xy_mm: -1: allowed is 0 to"));
  EXPECT_THAT(text, HasSubstr("cameras.left.sensor: d545: there is no \"d545\" among the presets of sensors; did you "
                              "mean \"d455\"?"));
  EXPECT_THAT(text, HasSubstr("cameras.left.intrinsics.fx_px: 0: allowed is 1 to"));
  EXPECT_THAT(text, HasSubstr("cameras.left.intrinsics.cy_px: .inf: must be a number"));
  EXPECT_THAT(text, HasSubstr("rig.yaml:6: cameras.center: has no intrinsics; give `intrinsics:"));
  EXPECT_THAT(text, HasSubstr("cameras.../x: a block: a camera's name has letters"));
  EXPECT_THAT(text, HasSubstr("rig.yaml:8: accept.z_mm: is missing"));
}

TEST(Rig, BoardsThatCannotBeToldApartOrAreGivenInCornersAreRefused) {
  const auto board = [](const std::string& text) {
    return rig_problems("board: " + text + "\ncameras: {left: {intrinsics: " + kIntrinsics + "}}\n");
  };
  EXPECT_EQ(board("{squares: [6, 5], square_mm: 110}"), "");
  EXPECT_THAT(board("{squares: [9, 7], square_mm: 25}"), HasSubstr("looks the same when turned by 180 degrees"));
  EXPECT_THAT(board("{inner_corners: [5, 4], square_mm: 25}"),
              HasSubstr("give squares: one more than inner corners along each side"));
  EXPECT_THAT(board("{squares: [6.5, 5], square_mm: 25}"), HasSubstr("must be whole numbers"));
  EXPECT_THAT(board("{squares: [1, 5], square_mm: 25}"), HasSubstr("allowed is 3 to 100"));
  EXPECT_EQ(board("checkerboard_6x5_110mm"), "");
  EXPECT_THAT(board("checkerboard_6x5"), HasSubstr("did you mean \"checkerboard_6x5_110mm\"?"));
  EXPECT_THAT(board("/etc/passwd"), HasSubstr("there is no \"/etc/passwd\" among the presets")) << "no file elsewhere";
}

TEST(Rig, MayHaveBoardsThatImagesTellApart) {
  const auto charuco = [](const std::string& dictionary) {
    return "{type: charuco, squares: [7, 5], square_mm: 100, dictionary: " + dictionary + "}";
  };
  const std::string first = charuco("DICT_5X5_50"), grid = "{type: aprilgrid, squares: [6, 6], square_mm: 110}";
  const auto rig_of = [&](const std::string& more) {
    return "board: " + first + "\nmore_boards: [" + more + "]\ncameras: {left: {intrinsics: " + kIntrinsics + "}}\n";
  };
  const auto problems = [&](const std::string& more) { return rig_problems(rig_of(more)); };
  TempFolder folder;
  folder.write("rig.yaml", rig_of(charuco("DICT_6X6_250") + ", " + grid));
  const Rig rig = load_rig(folder / "rig.yaml");
  ASSERT_EQ(rig.boards(), 3);
  EXPECT_EQ(rig.board_at(0).dictionary, "DICT_5X5_50");
  EXPECT_EQ(rig.board_at(1).dictionary, "DICT_6X6_250");
  EXPECT_EQ(rig.board_at(2).type, "aprilgrid");
  save_rig(rig, folder / "again.yaml");
  const Rig again = load_rig(folder / "again.yaml");
  EXPECT_EQ(again.board, rig.board);
  EXPECT_EQ(again.more_boards, rig.more_boards);

  EXPECT_EQ(problems(charuco("DICT_4X4_50") + ", aprilgrid_6x4_130mm"), "") << "a preset's name, as for board";
  EXPECT_THAT(
      problems("{squares: [8, 5], square_mm: 90}"),
      HasSubstr("rig.yaml:2: more_boards: a list of 1: boards 1 and 2 cannot be told apart in images: a plain"));
  EXPECT_THAT(
      problems(charuco("DICT_5X5_100") + ", " + charuco("DICT_5X5_250")),
      HasSubstr("boards 1 and 2 cannot be told apart in images: both have markers of DICT_5X5; make one a charuco "
                "board with another dictionary, e.g. DICT_4X4_250"));
  EXPECT_THAT(problems(grid + ", " + grid),
              HasSubstr("boards 2 and 3 cannot be told apart in images: both have markers"));
  EXPECT_THAT(problems("{squares: [8, 5]}"), HasSubstr("more_boards[0].square_mm"));
  const std::string misspelt = problems("charuco_7x5_100m");
  EXPECT_THAT(misspelt, HasSubstr("did you mean \"charuco_7x5_100mm\"?"));
  EXPECT_THAT(misspelt, testing::Not(HasSubstr("told apart")));
  std::string many;
  for (int i = 0; i < 10000; ++i) many += (i == 0 ? "" : ", ") + std::string("no_such_board");
  const std::string refused = problems(many);
  EXPECT_THAT(refused, HasSubstr("more_boards: a list of 10000: allowed are at most 7"));
  EXPECT_LT(refused.size(), 300U);
}

TEST(Rig, MayTellWhereBoardsStand) {
  const auto rig_of = [](const std::string& place) {
    return "board: charuco_7x5_100mm\nmore_boards: [{type: aprilgrid, squares: [6, 6], square_mm: 110, place: " +
           place + "}]\ncameras: {left: {intrinsics: " + kIntrinsics + "}}\n";
  };
  TempFolder folder;
  folder.write("rig.yaml", rig_of("{translation_m: [-1.2, 0.1, 0.6], quaternion_xyzw: [0, 0.6, 0, 0.8], sigma_mm: 3}"));
  const Rig rig = load_rig(folder / "rig.yaml");
  ASSERT_TRUE(rig.more_boards.at(0).place);
  EXPECT_FALSE(rig.board.place);
  const BoardPlace& place = *rig.more_boards[0].place;
  EXPECT_EQ(place.T_first_board.translation, Eigen::Vector3d(-1.2, 0.1, 0.6));
  EXPECT_NEAR(place.T_first_board.rotation.y(), 0.6, 1e-15);
  EXPECT_NEAR(place.sigma_m, 0.003, 1e-15);
  EXPECT_NEAR(place.sigma_rad, deg_to_rad(0.5), 1e-15) << "of an eye";
  save_rig(rig, folder / "again.yaml");
  const BoardPlace again = load_rig(folder / "again.yaml").more_boards.at(0).place.value();
  EXPECT_EQ(again.T_first_board.translation, place.T_first_board.translation);
  EXPECT_NEAR(again.sigma_rad, place.sigma_rad, 1e-15);
  folder.write("rig.yaml", rig_of("{translation_m: [-1.2, 0.1], quaternion_xyzw: [0, 0, 0, 2], sigma_mm: 0}"));
  const std::string text = error_text([&] { load_rig(folder / "rig.yaml"); });
  for (const char* part : {"more_boards[0].place.translation_m", "more_boards[0].place.quaternion_xyzw",
                           "more_boards[0].place.sigma_mm: 0: allowed is 0.01 to 10000"})
    EXPECT_THAT(text, HasSubstr(part));
  EXPECT_THAT(
      rig_problems("board: {squares: [6, 5], square_mm: 110, place: {translation_m: [0, 0, 0], quaternion_xyzw: "
                   "[0, 0, 0, 1]}}\ncameras: {left: {intrinsics: " +
                   std::string(kIntrinsics) + "}}\n"),
      HasSubstr("board.place"))
      << "the others are told against the first one";
}

TEST(Rig, DepthRefinesThePresetOrIsNone) {
  const TempFolder folder;
  const auto depth = [&](const std::string& text) {
    folder.write("rig.yaml", rig_text("  left: {sensor: l515, intrinsics: " + std::string(kIntrinsics) + text + "}\n"));
    return load_rig(folder / "rig.yaml").cameras.at(0).depth;
  };
  EXPECT_EQ(depth("")->noise.law, DepthNoise::Law::kTimeOfFlight);
  EXPECT_EQ(depth(", depth: {unit_m: 0.001}")->unit_m, 0.001);
  EXPECT_EQ(depth(", depth: {unit_m: 0.001}")->noise.constant_m, 0.000875);
  EXPECT_EQ(depth("")->noise.bias_m, 0.003) << "a real device has it";
  EXPECT_FALSE(depth(", depth: {noise: {bias_m: 0}}")->noise.has_bias());
  EXPECT_THAT(
      error_text([&] { depth(", depth: {noise: {bias_m: -1, bias_cell_deg: 0}}"); }),
      AllOf(HasSubstr("depth.noise.bias_m: -1: allowed is 0 to"), HasSubstr("bias_cell_deg: 0: allowed is 1 to")));
  EXPECT_FALSE(depth(", depth: none"));
  EXPECT_THAT(error_text([&] { depth(", depth: {min_m: 5, max_m: 4}"); }), HasSubstr("must be less than max_m"));
  EXPECT_THAT(error_text([&] { depth(", depth: {camera: " + std::string(kIntrinsics) + "}"); }),
              HasSubstr("camera and T_color_depth belong together"));
  EXPECT_THAT(error_text([&] { depth(", depth: off"); }), HasSubstr("depth: off: must be none or a block"));
}

TEST(Rig, HowWellItIsKnownIsThatOfAStrangerUnlessItIsSaid) {
  const TempFolder folder;
  const auto sigma = [&](const std::string& text) {
    folder.write("rig.yaml", rig_text("  left: {intrinsics: " + std::string(kIntrinsics) + text + "}\n"));
    return load_rig(folder / "rig.yaml").cameras.at(0).intrinsics_sigma;
  };
  EXPECT_EQ(sigma(""), IntrinsicsSigma());
  EXPECT_EQ(sigma(", intrinsics_sigma: exact"), IntrinsicsSigma::exact());
  const IntrinsicsSigma some = sigma(", intrinsics_sigma: {focal_percent: 0.1, distortion_px: 0}");
  EXPECT_DOUBLE_EQ(some.focal_relative, 0.001);
  EXPECT_EQ(some.distortion_px, 0.0);
  EXPECT_EQ(some.principal_point_px, IntrinsicsSigma().principal_point_px) << "what is not given stays the usual";
  EXPECT_THAT(error_text([&] { sigma(", intrinsics_sigma: none"); }), HasSubstr("none: must be exact or a block"));
  EXPECT_THAT(error_text([&] { sigma(", intrinsics_sigma: {focal_percent: -1, focal_px: 2}"); }),
              AllOf(HasSubstr("focal_percent: -1: allowed is 0 to 20"), HasSubstr("focal_px")));
}

TEST(Rig, AReadoutIsUnknownUnlessItIsSaid) {
  const TempFolder folder;
  const auto camera = [&](const std::string& text) {
    folder.write("rig.yaml", rig_text("  left: {intrinsics: " + std::string(kIntrinsics) + text + "}\n"));
    return load_rig(folder / "rig.yaml").cameras.at(0);
  };
  EXPECT_EQ(camera("").readout_s, 0.0);
  EXPECT_EQ(camera("").readout_sigma_s, 0.015);
  EXPECT_DOUBLE_EQ(camera(", readout_ms: -20, readout_sigma_ms: 0").readout_s, -0.02);
  EXPECT_EQ(camera(", readout_ms: -20, readout_sigma_ms: 0").readout_sigma_s, 0.0);
  EXPECT_THAT(error_text([&] { camera(", readout_ms: 300, readout_sigma_ms: -1"); }),
              AllOf(HasSubstr("readout_ms: 300: allowed is -200 to 200"), HasSubstr("readout_sigma_ms: -1")));
}

// Whatever a setting of the method can say of a robot, its rig can.
TEST(Rig, SaysHowWellWheelsAndClocksAreKnown) {
  const TempFolder folder;
  const auto load = [&](const std::string& camera, const std::string& noise) {
    folder.write("rig.yaml", rig_text("  left: {intrinsics: " + std::string(kIntrinsics) + camera + "}\n",
                                      "odometry: {file: odometry.csv, noise: {" + noise + "}}\n"));
    return load_rig(folder / "rig.yaml");
  };
  const Rig unsaid = load("", "model: unknown");
  EXPECT_EQ(unsaid.cameras.at(0).clock_offset_sigma_s, 0.0);
  EXPECT_FALSE(unsaid.odometry_noise.scale_sigma || unsaid.odometry_noise.turn_lag_sigma_s);
  const Rig said = load(", clock_offset_sigma_ms: 5",
                        "scale_sigma_percent: 2, yaw_factor_sigma_percent: 0, veer_sigma_deg_per_m: 0.5, "
                        "turn_lag_sigma_ms: 10");
  EXPECT_DOUBLE_EQ(said.cameras.at(0).clock_offset_sigma_s, 0.005);
  EXPECT_DOUBLE_EQ(said.odometry_noise.scale_sigma.value(), 0.02);
  EXPECT_EQ(said.odometry_noise.yaw_factor_sigma, 0.0);
  EXPECT_NEAR(said.odometry_noise.veer_sigma_rad_per_m.value(), deg_to_rad(0.5), 1e-15);
  EXPECT_DOUBLE_EQ(said.odometry_noise.turn_lag_sigma_s.value(), 0.01);
  EXPECT_THAT(error_text([&] { load(", clock_offset_sigma_ms: -1", "scale_sigma_percent: 200"); }),
              AllOf(HasSubstr("clock_offset_sigma_ms: -1"), HasSubstr("scale_sigma_percent: 200")));
  EXPECT_THAT(error_text([&] { load("", "turn_lag_sigma_ms: 1e-9"); }),
              AllOf(HasSubstr("turn_lag_sigma_ms"), HasSubstr("allowed is 0 (believed) or 0.001 and more")));
}

TEST(Rig, ABoardIsAsPrintersLeaveItUnlessItWasMeasured) {
  const Board board = read_board("{squares: [6, 5], square_mm: 110}");
  EXPECT_DOUBLE_EQ(board.square_sigma_relative(), 0.005);
  EXPECT_NEAR(board.bow_sigma(), 0.0003 * 0.66 / 0.42, 1e-9);
  const Board measured = read_board("{squares: [6, 5], square_mm: 110, square_sigma_mm: 0.11, bow_sigma_mm: 0}");
  EXPECT_DOUBLE_EQ(measured.square_sigma_relative(), 0.001);
  EXPECT_EQ(measured.bow_sigma(), 0.0);
  EXPECT_THAT(error_text([] { read_board("{squares: [6, 5], square_mm: 110, square_sigma_mm: -1}"); }),
              HasSubstr("square_sigma_mm: -1"));
}

TEST(Rig, AMeasuredTurningPointSaysHowWellItIsKnown) {
  const TempFolder folder;
  const auto noise = [&](const std::string& text) {
    folder.write("rig.yaml", rig_text("  left: {intrinsics: " + std::string(kIntrinsics) + "}\n",
                                      "odometry: {file: odometry.csv, noise: {" + text + "}}\n"));
    return load_rig(folder / "rig.yaml").odometry_noise;
  };
  EXPECT_TRUE(noise("rotation_centre_sigma_mm: 5").rotation_centre_m.isZero(0.0));
  EXPECT_EQ(noise("rotation_centre_mm: [130, -2.5], rotation_centre_sigma_mm: 5").rotation_centre_m,
            Eigen::Vector2d(0.13, -0.0025));
  EXPECT_THAT(error_text([&] { noise("rotation_centre_mm: [130, 0]"); }),
              AllOf(HasSubstr("rig.yaml:4"), HasSubstr("rotation_centre_sigma_mm: is missing: how well is")));
  EXPECT_THAT(error_text([&] { noise("rotation_centre_mm: [0, 0]"); }), HasSubstr("is missing: how well is"));
  EXPECT_THAT(error_text([&] { noise("rotation_centre_mm: [130], rotation_centre_sigma_mm: -1"); }),
              AllOf(HasSubstr("rotation_centre_mm"), HasSubstr("must be a list of 2 numbers"),
                    HasSubstr("rotation_centre_sigma_mm: -1")));
}

TEST(Rig, QuaternionsMustBeUnits) {
  const TempFolder folder;
  const auto load = [&](const std::string& quaternion) {
    folder.write("rig.yaml",
                 rig_text("  left: {intrinsics: " + std::string(kIntrinsics) + ", depth: {camera: " + kIntrinsics +
                          ", T_color_depth: {translation_m: [0.01, 0, 0], quaternion_xyzw: " + quaternion + "}}}\n"));
    return load_rig(folder / "rig.yaml").cameras.at(0).depth->own_camera->T_color_depth;
  };
  EXPECT_NEAR(load("[0, 0, 0, 1.0005]").rotation.norm(), 1.0, 1e-15);
  EXPECT_THAT(error_text([&] { load("[0, 0, 0, 1.01]"); }), HasSubstr("has the norm 1.01; it must be 1 within 0.001"));
  EXPECT_THAT(error_text([&] { load("[0, 0, 1]"); }), HasSubstr("must be a list of 4 numbers"));
}

// What a person wrote in the key's unit comes back as written. Not every double is some double times 1000, so other
// values may move by one rounding, but only once.
TEST(Rig, UnitsOfKeysLoseNothing) {
  EXPECT_EQ(value_in_unit(110.0 / 1000.0, 1000.0), 110.0);
  RandomStream random(1, "units");
  for (int i = 0; i < 10000; ++i) {
    const double written = *parse_number(std::to_string(random.uniform(0.0, 1000.0)));
    EXPECT_EQ(value_in_unit(written / 1000.0, 1000.0), written);
    const double si = random.uniform(), once = value_in_unit(si, 1000.0);
    EXPECT_NEAR(once / 1000.0, si, 2.3e-16 * si);
    EXPECT_EQ(value_in_unit(once / 1000.0, 1000.0), once);
  }
}

TEST(Rig, WhatIsWrittenKeepsToTheSchema) {
  const TempFolder folder;
  save_rig(sample_rig(), folder / "rig.yaml");
  const auto written = nlohmann::json::parse(emit_json(read_yaml_file(folder / "rig.yaml")));
  EXPECT_EQ(schema_violations(written, nlohmann::json::parse(rig_schema())), "");
}

TEST(Presets, EverySensorAndBoardLoads) {
  EXPECT_EQ(load_sensor_preset("d455").camera.fx_px, 640.0) << "90 degrees over 1280 pixels";
  for (const char* name : {"d435", "d455", "l515", "ideal", "fisheye"}) {
    const SensorPreset preset = load_sensor_preset(name);
    EXPECT_FALSE(preset.description.empty());
    EXPECT_GT(preset.camera.max_field_angle(), 0.5);
  }
  EXPECT_FALSE(load_sensor_preset("fisheye").depth);
  EXPECT_EQ(load_board("checkerboard_5x4_100mm").corner_count(), 12);
}

// The figures that the data sheets imply: sigma at 1, 2, 4 m for the D455 (848 pixels) and the D435, the L515's line.
TEST(Presets, DepthNoiseFollowsThePublishedFigures) {
  const auto sigma_mm = [](const char* name, double depth_m) {
    return 1000.0 * load_sensor_preset(name).depth->noise.sigma_m(depth_m);
  };
  // The published figures have two or three digits.
  EXPECT_NEAR(sigma_mm("d455", 1.0), 1.9, 0.05);
  EXPECT_NEAR(sigma_mm("d455", 2.0), 7.5, 0.05);
  EXPECT_NEAR(sigma_mm("d455", 4.0), 30.0, 0.2);
  EXPECT_NEAR(sigma_mm("d435", 1.0), 3.8, 0.05);
  EXPECT_NEAR(sigma_mm("d435", 4.0), 60.0, 0.5);
  EXPECT_NEAR(sigma_mm("l515", 1.0), 2.5, 1e-9);
  EXPECT_NEAR(sigma_mm("l515", 9.0), 15.5, 1e-9);
  const DepthNoise l515 = load_sensor_preset("l515").depth->noise;
  EXPECT_NEAR(l515.inverse_depth_sigma(2.0), l515.sigma_m(2.0) / 4.0, 1e-15);
  EXPECT_NEAR(l515.inverse_depth_bias(0.5), 0.003 / 4.0, 1e-15);
  const DepthNoise d455 = load_sensor_preset("d455").depth->noise;
  EXPECT_NEAR(d455.inverse_depth_bias(0.5), 0.0012, 0.00005) << "1.2 mm at 1 m, as the preset's file says";
  EXPECT_EQ(d455.inverse_depth_bias(0.5), d455.inverse_depth_bias(2.0));
  EXPECT_FALSE(load_sensor_preset("ideal").depth->noise.has_bias());
}

}  // namespace
}  // namespace rigproof
