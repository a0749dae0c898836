// Bags of a small robot, from the first byte to a recording, and what goes wrong on the way.
#include "rigproof/study/import/init.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "bag_bytes.h"
#include "error_text.h"
#include "rigproof/bags/messages.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/core/files.h"
#include "rigproof/core/recording.h"
#include "rigproof/formats/frame_tree.h"
#include "rigproof/png/png_encoder.h"
#include "rigproof/study/import/record_check.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// What a bag is made of; tests change it before it is written.
struct Robot {
  std::vector<std::string> cameras = {"left", "right"};
  bool info = true, odometry = true, tf = true, depth = true;
  double depth_delay_s = 0.0;
  double camera_clock_s = 0.0;  // added to the headers of images
  std::string depth_frame;      // empty: the camera's own
  std::uint32_t depth_width = 64;
  std::uint32_t info_width = 64;
  std::vector<double> rational;  // coefficients of the cameras; empty: a pinhole
  PoseFields odometry_pose;      // added to its height and attitude
  int stops = 5;
};

std::string color_message(const std::string& camera, double stamp_s, int shade) {
  ImageFields image;
  image.stamp_s = stamp_s;
  image.frame_id = camera + "_optical";
  image.width = image.step = 64;
  image.height = 48;
  image.encoding = "mono8";
  image.data = std::string(64 * 48, static_cast<char>(shade));
  return image_message(image);
}

std::string depth_message(const Robot& robot, const std::string& camera, double stamp_s) {
  ImageFields image;
  image.stamp_s = stamp_s;
  image.frame_id = robot.depth_frame.empty() ? camera + "_optical" : robot.depth_frame;
  image.width = robot.depth_width;
  image.step = 2 * robot.depth_width;
  image.height = robot.depth_width * 3 / 4;
  image.encoding = "16UC1";
  for (std::uint32_t i = 0; i < image.width * image.height; ++i) image.data += std::string("\xd0\x07", 2);
  return image_message(image);
}

std::vector<Recorded> messages_of(const Robot& robot) {
  std::vector<Recorded> messages;
  const double start_s = 1700000000.0;
  if (robot.tf) {
    std::vector<TransformFields> transforms = {{"base_footprint", "base_link", {0, 0, 0.1, 0, 0, 0, 1}}};
    for (const std::string& camera : robot.cameras) {
      transforms.push_back({"base_link", camera + "_link", {0.2, 0, 0.5, 0, 0, 0, 1}});
      transforms.push_back({camera + "_link", camera + "_optical", {0, 0.015, 0, -0.5, 0.5, -0.5, 0.5}});
    }
    messages.push_back({"/tf_static", kTfType, start_s, tf_message(start_s, transforms)});
  }
  // Stands for a second at each stop and moves for a second to the next; images at 10 Hz.
  for (int i = 0; i < 200 * robot.stops; ++i) {
    const double t = start_s + 0.01 * i;
    const double cycle = std::floor(0.005 * i), within = 0.01 * i - 2.0 * cycle;
    PoseFields pose = robot.odometry_pose;
    pose.x = 0.3 * (cycle + std::max(0.0, within - 1.0));
    if (robot.odometry) messages.push_back({"/odom", kOdometryType, t, odometry_message(t, pose)});
    if (i % 10 != 5) continue;
    for (const std::string& camera : robot.cameras) {
      InfoFields info;
      info.frame_id = camera + "_optical";
      info.width = robot.info_width;
      info.height = robot.info_width * 3 / 4;
      info.k = {60, 0, 31.5, 0, 60, 23.5, 0, 0, 1};
      if (!robot.rational.empty()) info.model = "rational_polynomial";
      if (!robot.rational.empty()) info.d = robot.rational;
      const double stamp = t + robot.camera_clock_s, later = stamp + robot.depth_delay_s;
      if (robot.info)
        messages.push_back({"/" + camera + "/camera_info", kCameraInfoType, t, info_message(info, stamp)});
      messages.push_back({"/" + camera + "/image_raw", kImageType, t, color_message(camera, stamp, i % 200)});
      if (robot.depth)
        messages.push_back({"/" + camera + "/depth/image_raw", kImageType, t, depth_message(robot, camera, later)});
    }
  }
  return messages;
}

// The same bag with other names of topics.
std::vector<Recorded> renamed(std::vector<Recorded> messages, const std::map<std::string, std::string>& names) {
  for (Recorded& message : messages)
    if (const auto name = names.find(message.topic); name != names.end()) message.topic = name->second;
  return messages;
}

class Init : public testing::Test {
 protected:
  InitOptions options_for(const Robot& robot) {
    InitOptions options;
    options.source = scratch_.write("bag.mcap", mcap_bytes(messages_of(robot)));
    options.output = scratch_ / "monday";
    options.board = Board();
    options.board->type = "aprilgrid";  // of the kinds the quickest not to be found
    return options;
  }
  InitReport run(const Robot& robot) { return init_recording(options_for(robot)); }
  /// Of a failure, which must leave nothing behind.
  std::string failure(const InitOptions& options) {
    const std::string text = error_text([&] { init_recording(options); });
    EXPECT_FALSE(fs::exists(options.output)) << text;
    EXPECT_FALSE(fs::exists(options.output.string() + ".partial")) << text;
    return text;
  }
  std::string failure(const Robot& robot) { return failure(options_for(robot)); }

  TempFolder scratch_;
};

TEST_F(Init, ABagBecomesARecording) {
  const InitReport report = run(Robot());
  EXPECT_EQ(report.stops, 5U);
  ASSERT_EQ(report.cameras.size(), 2U);
  EXPECT_EQ(report.cameras[0].images_in_source, 100U);
  EXPECT_EQ(report.cameras[0].images_kept, 15U);  // three of each stop
  EXPECT_EQ(report.cameras[0].depth_kept, 15U);
  EXPECT_EQ(report.cameras[0].link, "left_link");
  EXPECT_THAT(report.notes, Contains(HasSubstr("while the robot moved")));
  const Recording recording = load_recording(scratch_ / "monday");
  EXPECT_EQ(recording.rig.robot_frame, "base_footprint");
  EXPECT_EQ(recording.rig.cameras[0].camera.fx_px, 60.0);
  EXPECT_EQ(recording.odometry.size(), 1000U);
  ASSERT_EQ(recording.frames[1].size(), 15U);
  EXPECT_EQ(recording.frames[1][0].stamp_s, 1700000000.05);
  EXPECT_TRUE(fs::exists(scratch_ / "monday/right/depth/000014.png"));
  EXPECT_EQ(recording.rig.cameras[0].optical_frame, "left_optical");
  ASSERT_TRUE(recording.rig.cameras[0].T_link_camera);
  EXPECT_EQ(recording.rig.cameras[0].T_link_camera->translation.y(), 0.015);
  const FrameTree tree = load_frame_tree(scratch_ / "monday/tf_static.json");
  EXPECT_EQ(tree.edges().at("left_optical").parent, "left_link");
  EXPECT_EQ(tree.between("base_footprint", "left_link")->translation.z(), 0.6);
  EXPECT_FALSE(fs::exists(scratch_ / "monday/.scratch"));
}

TEST_F(Init, NothingInThePlaceIsOverwritten) {
  const InitOptions options = options_for(Robot());
  scratch_.write("monday/mine.txt", "kept");
  EXPECT_THAT(error_text([&] { init_recording(options); }), HasSubstr("there is something already"));
  EXPECT_EQ(scratch_.read("monday/mine.txt"), "kept");
}

TEST_F(Init, InterruptedItLeavesNothingAndStartsAnew) {
  for (const std::string at : {"read", "write"}) {
    InitOptions options = options_for(Robot());
    options.progress = [&at](const char* what, std::uint64_t, std::uint64_t) { return what != at; };
    EXPECT_THAT(failure(options), HasSubstr("interrupted"));
  }
  scratch_.write("monday.partial/left/color/000000.png", "half a picture of a killed process");
  EXPECT_EQ(run(Robot()).cameras[0].images_kept, 15U);
}

TEST_F(Init, WithoutABoardTheLineToWriteIsSaid) {
  InitOptions options = options_for(Robot());
  options.board.reset();
  const InitReport report = init_recording(options);
  EXPECT_THAT(report.missing, ElementsAre(HasSubstr("board: {type: checkerboard")));
  EXPECT_THAT(error_text([&] { load_recording(scratch_ / "monday"); }), HasSubstr("board"));
  const std::string rig = scratch_.read("monday/rig.yaml");
  EXPECT_THAT(rig, HasSubstr("# About which point the robot turns is in no recording"));
  scratch_.write("monday/rig.yaml", "board: {type: checkerboard, squares: [6, 5], square_mm: 110}\n" + rig);
  EXPECT_EQ(load_recording(scratch_ / "monday").rig.board.squares_x, 6);
}

TEST_F(Init, TopicsAreRenamedLeftOutAndRefusedTwice) {
  InitOptions options = options_for(Robot());
  options.topics = {"front=/left/image_raw", "right=none", "front.depth=none"};
  const InitReport report = init_recording(options);
  ASSERT_EQ(report.cameras.size(), 1U);
  EXPECT_EQ(report.cameras[0].name, "front");
  EXPECT_EQ(report.cameras[0].depth, "");
  InitOptions wrong = options_for(Robot());
  wrong.output = scratch_ / "tuesday";
  wrong.topics = {"left=/left/image_raw", "front=/left/image_raw", "odometry=/odon",
                  "rigt.depth=/left/depth/image_raw"};
  EXPECT_THAT(failure(wrong), AllOf(HasSubstr("is given to --topic left already"), HasSubstr("did you mean \"/odom\""),
                                    HasSubstr("did you mean \"right\"")));
  wrong.topics = {"left"};
  EXPECT_THAT(failure(wrong), HasSubstr("NAME=TOPIC"));
}

TEST_F(Init, TwoCamerasInOneNamespaceAreTwo) {
  Robot robot;
  robot.depth = false;
  InitOptions options = options_for(robot);
  scratch_.write("bag.mcap", mcap_bytes(renamed(messages_of(robot), {{"/left/image_raw", "/left_image"},
                                                                     {"/left/camera_info", "/left_info"},
                                                                     {"/right/image_raw", "/right_image"},
                                                                     {"/right/camera_info", "/right_info"}})));
  const InitReport guessed = init_recording(options);
  ASSERT_EQ(guessed.cameras.size(), 2U);
  EXPECT_EQ(guessed.cameras[0].images, "/left_image");
  EXPECT_EQ(guessed.cameras[0].camera_info, "/left_info");
  EXPECT_EQ(guessed.cameras[1].camera_info, "/right_info");
  EXPECT_THAT(guessed.notes, Not(Contains(HasSubstr("not taken"))));
  options.output = scratch_ / "named";
  options.topics = {"left=/left_image", "right=/right_image"};
  const InitReport named = init_recording(options);
  ASSERT_EQ(named.cameras.size(), 2U);
  EXPECT_EQ(named.cameras[0].name, "left");
  EXPECT_EQ(named.cameras[0].images, "/left_image");
  EXPECT_EQ(named.cameras[1].name, "right");
  EXPECT_EQ(named.cameras[1].images, "/right_image");
  options.output = scratch_ / "shared";
  options.topics.clear();
  scratch_.write("bag.mcap", mcap_bytes(renamed(messages_of(robot), {{"/left/image_raw", "/cams/left_image"},
                                                                     {"/left/camera_info", "/cams/camera_info"},
                                                                     {"/right/image_raw", "/cams/right_image"}})));
  EXPECT_THAT(failure(options), AllOf(HasSubstr("camera right_image: there is no CameraInfo"),
                                      HasSubstr("lies beside several cameras"), Not(HasSubstr("camera left_image"))));
  // Leaving a camera out makes what is its own nobody else's.
  options.topics = {"left_image=none"};
  EXPECT_THAT(failure(options), HasSubstr("camera right_image: there is no CameraInfo"));
}

// Whatever else lies beside it, and in whatever order.
TEST_F(Init, CameraInfoByItsUsualNameComesFirst) {
  InitOptions options = options_for(Robot());
  std::vector<Recorded> messages = messages_of(Robot());
  InfoFields other;
  other.frame_id = "left_optical";
  other.width = 64;
  other.height = 48;
  other.k = {99, 0, 31.5, 0, 99, 23.5, 0, 0, 1};
  messages.insert(messages.begin(),
                  {"/left/color_info", kCameraInfoType, 1700000000.0, info_message(other, 1700000000.0)});
  scratch_.write("bag.mcap", mcap_bytes(messages));
  EXPECT_EQ(init_recording(options).cameras[0].camera_info, "/left/camera_info");
  EXPECT_EQ(load_recording(scratch_ / "monday").rig.cameras[0].camera.fx_px, 60.0);
}

TEST_F(Init, WithoutFramesNamesTellCamerasApart) {
  Robot robot;
  robot.depth = false;
  std::vector<Recorded> messages;
  for (Recorded& message : renamed(messages_of(robot), {{"/left/image_raw", "/left_image_raw"},
                                                        {"/left/camera_info", "/left_camera_info"},
                                                        {"/right/image_raw", "/right_image_raw"},
                                                        {"/right/camera_info", "/right_camera_info"}})) {
    if (message.type == kImageType) {
      RosImage image = read_image(message.data);
      image.header.frame_id.clear();
      message.data = message_bytes(image);
      if (message.topic == "/left_image_raw")
        messages.push_back({"/left_image_rect", kImageType, message.log_s, message.data});
    }
    messages.push_back(message);
  }
  InitOptions options = options_for(robot);
  scratch_.write("bag.mcap", mcap_bytes(messages));
  const InitReport report = init_recording(options);
  ASSERT_EQ(report.cameras.size(), 2U);
  EXPECT_EQ(report.cameras[0].images, "/left_image_raw");
  EXPECT_EQ(report.cameras[0].camera_info, "/left_camera_info");
  EXPECT_EQ(report.cameras[1].camera_info, "/right_camera_info");
  EXPECT_THAT(report.notes, Contains(HasSubstr("=/left_image_rect in place of /left_image_raw")));
}

TEST_F(Init, OtherPicturesOfACameraAreNoCamerasAndSaid) {
  Robot robot;
  robot.depth = false;
  std::vector<Recorded> messages = messages_of(robot);
  for (const std::string other : {"/left/image_rect", "/left/infra1/image_raw", "/right/image_color"})
    for (const Recorded& message : messages_of(robot))
      if (message.topic == other.substr(0, other.find('/', 1)) + "/image_raw")
        messages.push_back({other, message.type, message.log_s, message.data});
  InitOptions options = options_for(robot);
  options.topics = {"right=none"};
  scratch_.write("bag.mcap", mcap_bytes(messages));
  const InitReport report = init_recording(options);
  ASSERT_EQ(report.cameras.size(), 1U);
  EXPECT_EQ(report.cameras[0].images, "/left/image_raw");
  EXPECT_THAT(report.notes,
              Contains(AllOf(HasSubstr("--topic left=/left/image_rect in place of /left/image_raw"),
                             HasSubstr("--topic left_infra1=/left/infra1/image_raw"), Not(HasSubstr("/right")))));
}

TEST_F(Init, MissingCalibrationIsSaidForEveryCameraAndGivenByAFile) {
  Robot robot;
  robot.info = false;
  EXPECT_THAT(failure(robot), AllOf(HasSubstr("camera left: there is no CameraInfo"), HasSubstr("camera right"),
                                    HasSubstr("--camera-info left=FILE")));
  InitOptions options = options_for(robot);
  const std::string file =
      scratch_
          .write("info.yaml",
                 "image_width: 64\nimage_height: 48\ncamera_matrix: {rows: 3, cols: 3, data: [70, 0, 31, 0, 71, 23, 0, "
                 "0, 1]}\n"
                 "distortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n")
          .string();
  options.camera_infos = {"left=" + file, "right=" + file};
  init_recording(options);
  EXPECT_EQ(load_recording(scratch_ / "monday").rig.cameras[0].camera.fy_px, 71.0);
}

// K and D of a file are of the raw images.
TEST_F(Init, AFileForRectifiedImagesGivesP) {
  Robot robot;
  robot.cameras = {"left"};
  robot.depth = false;
  InitOptions options = options_for(robot);
  scratch_.write("bag.mcap", mcap_bytes(renamed(messages_of(robot), {{"/left/image_raw", "/left/image_rect"}})));
  const std::string raw =
      "image_width: 64\nimage_height: 48\ncamera_matrix: {rows: 3, cols: 3, data: [70, 0, 31, 0, 71, 23, 0, 0, 1]}\n"
      "distortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [-0.3, 0.1, 0, 0, 0]}\n";
  options.camera_infos = {"left=" + scratch_.write("info.yaml", raw).string()};
  EXPECT_THAT(failure(options), AllOf(HasSubstr("info.yaml"), HasSubstr("has no projection_matrix (P)")));
  scratch_.write("info.yaml",
                 raw + "projection_matrix: {rows: 3, cols: 4, data: [55, 0, 30, 0, 0, 56, 22, 0, 0, 0, 1, 0]}\n");
  EXPECT_THAT(init_recording(options).notes, Contains(HasSubstr("left: images are rectified: the matrix P")));
  const Camera camera = load_recording(scratch_ / "monday").rig.cameras[0].camera;
  EXPECT_EQ(camera.lens, Lens::kPinhole);
  EXPECT_EQ(camera.fx_px, 55.0);
  EXPECT_EQ(camera.cy_px, 22.0);
}

// Its images are rectified like those of a bag's own CameraInfo.
TEST_F(Init, AFileOfARationalLensServesLikeAMessage) {
  Robot robot;
  robot.cameras = {"left"};
  InitOptions options = options_for(robot);
  options.camera_infos = {"left=" + scratch_
                                        .write("info.yaml",
                                               "width: 64\nheight: 48\nk: [60, 0, 31.5, 0, 60, 23.5, 0, 0, 1]\n"
                                               "distortion_model: rational_polynomial\nd: [4, 0, 0, 0, 0, 8, 0, 0]\n")
                                        .string()};
  EXPECT_THAT(init_recording(options).notes, Contains(HasSubstr("images are rectified as they are read")));
  EXPECT_EQ(load_recording(scratch_ / "monday").rig.cameras[0].camera.lens, Lens::kPinhole);
}

TEST_F(Init, ACamchainOfKalibrIsForAllCameras) {
  const auto camera = [](const std::string& name, const std::string& focal, const std::string& end) {
    return name + ":\n  camera_model: pinhole\n  cam_overlaps: []\n  resolution: [64, 48]\n  intrinsics: [" + focal +
           ", 71, 31, 23]\n" + end;
  };
  const std::string left =
                        camera("cam0", "70",
                               "  distortion_model: radtan\n  distortion_coeffs: [-0.1, 0.02, 0.001, 0]\n  rostopic: "
                               "/left/image_raw/compressed\n"),
                    right =
                        camera("cam1", "80",
                               "  distortion_model: equidistant\n  distortion_coeffs: [0.1, 0, 0, 0]\n  T_cn_cnm1:\n"
                               "  - [0, 1, 0, 0.1]\n  - [-1, 0, 0, 0.2]\n  - [0, 0, 1, 0.3]\n  - [0, 0, 0, 1]\n");
  InitOptions options = options_for(Robot());
  const std::string file = scratch_.write("camchain.yaml", left + right).string();
  options.camera_infos = {file};
  EXPECT_THAT(failure(options), AllOf(HasSubstr("camera right: " + file +
                                                ": which of its cameras is right? It has cam0 "
                                                "(/left/image_raw/compressed), cam1"),
                                      HasSubstr("name right as one of them: --topic cam0=/right/image_raw"),
                                      Not(HasSubstr("camera left"))));
  options.topics = {"cam1=/right/image_raw"};
  EXPECT_THAT(init_recording(options).notes, Contains(HasSubstr("is kept in camchain.json")));
  const Recording recording = load_recording(scratch_ / "monday");
  EXPECT_EQ(recording.rig.cameras[0].camera.fx_px, 70.0);
  EXPECT_EQ(recording.rig.cameras[0].camera.lens, Lens::kBrownConrady);
  EXPECT_EQ(recording.rig.cameras[1].camera.fx_px, 80.0);
  EXPECT_EQ(recording.rig.cameras[1].camera.cy_px, 23.0);
  EXPECT_EQ(recording.rig.cameras[1].camera.lens, Lens::kKannalaBrandt);
  // T_cn_cnm1 has the camera before in this one: left lies at (.1, .2, .3) of right.
  const auto T_right_left = load_frame_tree(scratch_ / "monday/camchain.json").between("cam1", "left");
  ASSERT_TRUE(T_right_left);
  EXPECT_LT((T_right_left->translation - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 1e-9);
  EXPECT_LT((*T_right_left * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0.1, -0.8, 0.3)).norm(), 1e-9);
  options.output = scratch_ / "any_order";
  scratch_.write("camchain.yaml", right + left);
  init_recording(options);
  EXPECT_EQ(read_text_file(scratch_ / "any_order/camchain.json"), read_text_file(scratch_ / "monday/camchain.json"));
  options.output = scratch_ / "tuesday";
  scratch_.write("camchain.yaml", left + "cam1: {camera_model: omni, intrinsics: [1], distortion_model: radtan}\n");
  EXPECT_THAT(failure(options), AllOf(HasSubstr("camchain.yaml:9: cam1.camera_model: omni: must be one of pinhole"),
                                      HasSubstr("cam1.resolution"), HasSubstr("cam1.distortion_coeffs")));
  for (const std::string T :
       {"[[1, 0, 0, 0]]", "1", "[[1,0,0,0],[0,1,0,0],[0,0,2,0],[0,0,0,1]]",
        "[[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]", "[[1,0,0,0],[0,1,0,0],[0,0,1,.nan],[0,0,0,1]]",
        "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,x]]"}) {
    scratch_.write("camchain.yaml", left + camera("cam1", "80", "  distortion_model: none\n  T_cn_cnm1: " + T + "\n"));
    EXPECT_THAT(failure(options), HasSubstr("cam1.T_cn_cnm1")) << T;
  }
  scratch_.write("camchain.yaml", "image_width: 64\nimage_height: 48\n");
  EXPECT_THAT(failure(options), HasSubstr("must be CAMERA=FILE"));
  scratch_.write("camchain.yaml", (left + right).substr(0, left.size() - 40) + " [");
  EXPECT_THAT(failure(options), HasSubstr("camchain.yaml:7: not valid YAML"));
  // However large a number is, there is none before it.
  options.topics = {"cam9999999999999999999999=/right/image_raw"};
  scratch_.write("camchain.yaml", left + "cam9999999999999999999999" + right.substr(4));
  options.output = scratch_ / "large";
  init_recording(options);
  EXPECT_FALSE(fs::exists(scratch_ / "large/camchain.json"));
  options.output = scratch_ / "tuesday";
  options.topics = {"cam1=/right/image_raw"};
  options.camera_infos = {(scratch_ / "nowhere.yaml").string()};
  EXPECT_THAT(failure(options), HasSubstr("nowhere.yaml: no such file"));
}

// Kalibr numbers cameras as they were named to it, which need not be as their topics are called.
TEST_F(Init, ACamchainGoesByTopicsBeforeNames) {
  const auto camera = [](const std::string& name, const std::string& focal, const std::string& topic) {
    return name + ": {camera_model: pinhole, resolution: [64, 48], intrinsics: [" + focal +
           ", 71, 31, 23], distortion_model: none, rostopic: " + topic + "}\n";
  };
  InitOptions options = options_for(Robot());
  scratch_.write("bag.mcap",
                 mcap_bytes(renamed(messages_of(Robot()), {{"/left/image_raw", "/robot/cam0/image_raw"},
                                                           {"/right/image_raw", "/robot/cam1/image_raw"}})));
  options.camera_infos = {
      scratch_.write("camchain.yaml", camera("cam0", "80", "/cam1/image_raw") + camera("cam1", "70", "/cam0/image_raw"))
          .string()};
  EXPECT_EQ(init_recording(options).cameras[0].images, "/robot/cam0/image_raw");
  EXPECT_EQ(load_recording(scratch_ / "monday").rig.cameras[0].camera.fx_px, 70.0);
  EXPECT_EQ(load_recording(scratch_ / "monday").rig.cameras[1].camera.fx_px, 80.0);
  // By name where no topic tells, and said.
  options.output = scratch_ / "tuesday";
  scratch_.write("camchain.yaml", camera("cam0", "80", "/old/image") + camera("cam1", "70", "/older/image"));
  EXPECT_THAT(init_recording(options).notes,
              Contains(AllOf(HasSubstr("cam0"), HasSubstr("calibrated with /old/image"))));
  EXPECT_EQ(load_recording(scratch_ / "tuesday").rig.cameras[0].camera.fx_px, 80.0);
  // A file of one camera for one camera leaves no choice.
  options.output = scratch_ / "wednesday";
  const std::string one = scratch_.write("one.yaml", camera("cam0", "90", "/old/image")).string();
  options.camera_infos = {"cam0=" + one, "cam1=" + one};
  init_recording(options);
  EXPECT_EQ(load_recording(scratch_ / "wednesday").rig.cameras[1].camera.fx_px, 90.0);
}

TEST_F(Init, IntrinsicsOfAnotherSizeAreRefused) {
  Robot robot;
  robot.info_width = 128;
  EXPECT_THAT(failure(robot), AllOf(HasSubstr("64x48"), HasSubstr("128x96")));
}

TEST_F(Init, ClocksOfDifferentEpochs) {
  Robot robot;
  robot.camera_clock_s = -1699999990.0;
  EXPECT_THAT(failure(robot), AllOf(HasSubstr("different clocks"), HasSubstr("--stamps log")));
  InitOptions options = options_for(robot);
  options.log_stamps = true;
  EXPECT_EQ(init_recording(options).stops, 5U);
  EXPECT_EQ(load_recording(scratch_ / "monday").frames[0][0].stamp_s, 1700000000.05);
}

TEST_F(Init, DepthBesideItsImageIsPairedOrLeftOutWithWords) {
  Robot robot;
  robot.depth_delay_s = 0.007;
  const InitReport beside = run(robot);
  EXPECT_EQ(beside.cameras[0].depth_kept, 15U);
  EXPECT_THAT(beside.notes, Contains(HasSubstr("up to 7.0 ms")));
  fs::remove_all(scratch_ / "monday");
  robot.depth_delay_s = 0.04;
  const InitReport far = run(robot);
  EXPECT_EQ(far.cameras[0].depth_kept, 0U);
  EXPECT_THAT(far.notes, Contains(HasSubstr("40.0 ms")));
}

TEST_F(Init, DepthOfAnotherFrameNeedsItsPlace) {
  Robot robot;
  robot.cameras = {"left"};
  robot.depth_frame = "left_depth_optical";
  robot.depth_width = 32;
  const InitReport report = run(robot);
  EXPECT_EQ(report.cameras[0].depth, "");
  EXPECT_THAT(report.notes, Contains(AllOf(HasSubstr("32x24"), HasSubstr("align_depth"))));
  EXPECT_FALSE(load_recording(scratch_ / "monday").rig.cameras[0].depth);
}

TEST_F(Init, ATiltedOdometryIsSaid) {
  Robot robot;
  robot.odometry_pose = {0, 0, 0, 0, std::sin(0.05), 0, std::cos(0.05)};
  const InitReport report = run(robot);
  EXPECT_NEAR(report.tilt_deg, 5.73, 0.01);
  EXPECT_THAT(report.notes, Contains(HasSubstr("tilts by up to 5.7 deg")));
}

TEST_F(Init, WithoutOdometryOrImagesItSaysWhatIsThere) {
  Robot robot;
  robot.odometry = false;
  EXPECT_THAT(failure(robot), HasSubstr("neither nav_msgs/Odometry nor"));
  robot = Robot();
  robot.cameras.clear();
  EXPECT_THAT(failure(robot), AllOf(HasSubstr("has no images"), HasSubstr("/odom (nav_msgs/msg/Odometry)")));
}

TEST_F(Init, OdometryOfTfServesWhereThereIsNoOther) {
  Robot robot;
  robot.odometry = false;
  std::vector<Recorded> messages = messages_of(robot);
  for (int i = 0; i < 1000; ++i) {
    const double t = 1700000000.0 + 0.01 * i;
    const double x = 0.1 * std::floor(0.005 * i) + 0.1 * std::max(0.0, std::fmod(0.01 * i, 2.0) - 1.0);
    messages.push_back(
        {"/tf", kTfType, t, tf_message(t, {{"odom", "base_link", {x, 0, 0, 0, 0, 0, 1}}, {"base_link", "wheel", {}}})});
  }
  InitOptions options = options_for(robot);
  scratch_.write("bag.mcap", mcap_bytes(messages));
  const InitReport report = init_recording(options);
  EXPECT_EQ(report.odometry, "/tf odom -> base_link");
  EXPECT_EQ(report.stops, 5U);
}

TEST_F(Init, TwoDriversOnOneTopicAreRefused) {
  std::vector<Recorded> messages = messages_of(Robot());
  messages.push_back({"/left/image_raw", kImageType, 1700000001.0, color_message("other", 1700000001.0, 1)});
  InitOptions options = options_for(Robot());
  scratch_.write("bag.mcap", mcap_bytes(messages));
  EXPECT_THAT(failure(options), AllOf(HasSubstr("left_optical"), HasSubstr("other_optical")));
}

// ------------------------------------------------------------------------------------------------- frames of the robot

struct WithFrames {
  std::vector<TransformFields> transforms;
  std::string bytes() const {
    Robot robot;
    robot.tf = false;
    std::vector<Recorded> messages = messages_of(robot);
    messages.insert(messages.begin(), {"/tf_static", kTfType, 1700000000.0, tf_message(1700000000.0, transforms)});
    return mcap_bytes(messages);
  }
};

TEST_F(Init, FramesInACircleOrOfTwoParentsAreRefusedOrLeftOut) {
  InitOptions options = options_for(Robot());
  for (const auto& [transforms, words] :
       {std::pair{std::vector<TransformFields>{{"mast", "left_optical", {}}, {"left_optical", "mast", {}}},
                  "in a circle"},
        std::pair{std::vector<TransformFields>{{"mast", "left_optical", {}}, {"base_link", "left_optical", {}}},
                  "two parents, mast and base_link"}}) {
    scratch_.write("bag.mcap", WithFrames{transforms}.bytes());
    options.topics.clear();
    EXPECT_THAT(failure(options),
                AllOf(HasSubstr("camera left: /tf_static"), HasSubstr(words), HasSubstr("--topic tf_static=none")));
    options.topics = {"tf_static=none"};
    EXPECT_THAT(init_recording(options).notes, Contains(HasSubstr("is not in /tf_static")));
    EXPECT_FALSE(fs::exists(scratch_ / "monday/tf_static.json"));
    fs::remove_all(scratch_ / "monday");
    RecordCheckOptions check;
    check.source = options;
    check.source.board = Board();
    EXPECT_EQ(RecordWatch(check).look().stops, 5U) << "while it drives, too";
  }
}

TEST_F(Init, FramesWithoutAPathToTheRobotAreSaid) {
  InitOptions options = options_for(Robot());
  scratch_.write("bag.mcap", WithFrames{{{"left_link", "left_optical", {}}}}.bytes());
  const InitReport report = init_recording(options);
  EXPECT_THAT(report.notes, Contains(HasSubstr("does not join left_optical with base_link")));
  EXPECT_THAT(report.notes, Contains(HasSubstr("right_optical is not in /tf_static")));
  EXPECT_EQ(report.cameras[0].link, "left_link");
  options.output = scratch_ / "tuesday";
  options.robot_frame = "left_link";
  EXPECT_THAT(failure(options), HasSubstr("/tf_static does not join it with base_link"));
}

TEST_F(Init, ImagesThatCameTwiceAreLeftOutAndTwoDriversRefused) {
  InitOptions options = options_for(Robot());
  std::vector<Recorded> twice, of_two;
  for (const Recorded& message : messages_of(Robot())) {
    twice.push_back(message);
    of_two.push_back(message);
    if (message.type != kImageType || message.topic.rfind("/left", 0) != 0) continue;
    twice.push_back(message);
    if (message.topic == "/left/image_raw")
      of_two.push_back({message.topic, message.type, message.log_s, color_message("left", message.log_s, 222)});
  }
  scratch_.write("bag.mcap", mcap_bytes(twice));
  const InitReport report = init_recording(options);
  EXPECT_EQ(report.cameras[0].images_in_source, 100U);
  EXPECT_EQ(report.cameras[0].depth_kept, 15U);
  EXPECT_THAT(report.notes, Contains(AllOf(HasSubstr("images that came again"),
                                           HasSubstr("100 of /left/image_raw, 100 of /left/depth/image_raw"),
                                           Not(HasSubstr("right")))));
  options.output = scratch_ / "tuesday";
  scratch_.write("bag.mcap", mcap_bytes(of_two));
  EXPECT_THAT(failure(options),
              AllOf(HasSubstr("camera left: /left/image_raw has different images of one stamp, at 100"),
                    HasSubstr("the first at 1700000000.050 s: two drivers publish on /left/image_raw"),
                    HasSubstr("--stamps log"), Not(HasSubstr("right"))));
}

TEST_F(Init, OtherOdometryIsNamedAndDamageHasARemedy) {
  InitOptions options = options_for(Robot());
  std::vector<Recorded> messages = messages_of(Robot());
  std::vector<Recorded> filtered;
  for (const Recorded& message : messages)
    if (message.topic == "/odom") filtered.push_back({"/odometry/filtered", message.type, message.log_s, message.data});
  messages.insert(messages.end(), filtered.begin(), filtered.end());
  scratch_.write("bag.mcap", mcap_bytes(messages));
  EXPECT_THAT(init_recording(options).notes,
              Contains(AllOf(HasSubstr("odometry is /odom"), HasSubstr("--topic odometry=/odometry/filtered"))));
  options.output = scratch_ / "named";
  options.topics = {"odometry=/odometry/filtered"};
  EXPECT_THAT(init_recording(options).notes, Not(Contains(HasSubstr("odometry is"))));
  messages.back().data.resize(20);
  options.output = scratch_ / "damaged";
  scratch_.write("bag.mcap", mcap_bytes(messages));
  EXPECT_THAT(failure(options),
              AllOf(HasSubstr("topic /odometry/filtered"), HasSubstr("copy the bag without this topic")));
}

// What calibrates is the point on the ground: no other height may go by its name.
TEST_F(Init, ARobotFrameAboveTheGroundOrUnknownIsRefused) {
  InitOptions options = options_for(Robot());
  options.robot_frame = "base_link";
  EXPECT_THAT(failure(options), AllOf(HasSubstr("--robot-frame base_link: /tf_static has it 10 cm above"),
                                      HasSubstr("give --robot-frame base_footprint")));
  options.robot_frame = "base_lnk";
  EXPECT_THAT(failure(options), AllOf(HasSubstr("/tf_static has no such frame; did you mean \"base_link\"?"),
                                      HasSubstr("left_optical, right_link")));
  scratch_.write("bag.mcap", WithFrames{{{"base_footprint", "base_link", {}},
                                         {"base_link", "left_optical", {}},
                                         {"base_link", "right_optical", {}}}}
                                 .bytes());
  options.robot_frame = "base_link";
  EXPECT_THAT(init_recording(options).notes, Not(Contains(HasSubstr("above the ground")))) << "it lies there";
  EXPECT_EQ(load_recording(options.output).rig.robot_frame, "base_link");
}

TEST_F(Init, AHeightThatNobodyKnowsIsSaid) {
  InitOptions options = options_for(Robot());
  scratch_.write("bag.mcap",
                 WithFrames{{{"base_link", "left_optical", {}}, {"base_link", "right_optical", {}}}}.bytes());
  const auto says_where = HasSubstr("`export --parent base_link --parent-height-mm H`");
  EXPECT_THAT(init_recording(options).notes,
              Contains(AllOf(HasSubstr("/tf_static has no base_footprint: it stands for the point on the ground below "
                                       "base_link"),
                             says_where)));
  options.output = scratch_ / "tuesday";
  options.robot_frame = "base_link";
  EXPECT_THAT(init_recording(options).notes, Contains(AllOf(HasSubstr("on the ground below base_link"), says_where)));
}

TEST_F(Init, OdometryOfAFrameWithoutANameOrAPathIsTakenAsItSays) {
  InitOptions options = options_for(Robot());
  const auto moving = [](const std::string& child) {
    std::vector<Recorded> messages = messages_of(Robot());
    for (Recorded& message : messages)
      if (message.topic == "/odom") message.data = odometry_message(message.log_s, PoseFields(), child);
    return mcap_bytes(messages);
  };
  scratch_.write("bag.mcap", moving(""));
  const InitReport nameless = init_recording(options);
  EXPECT_THAT(nameless.notes, Contains(HasSubstr("/odom does not say which frame it moves")));
  EXPECT_THAT(nameless.notes, Not(Contains(HasSubstr("does not join"))));
  EXPECT_EQ(nameless.robot_frame, "base_footprint");
  scratch_.write("bag.mcap", moving("/chassis"));
  options.output = scratch_ / "tuesday";
  const InitReport other = init_recording(options);
  EXPECT_THAT(other.notes, Contains(AllOf(HasSubstr("/tf_static does not join base_footprint with /chassis"),
                                          HasSubstr("results are given in"))));
  EXPECT_EQ(load_recording(options.output).rig.robot_frame, "chassis");
}

// ------------------------------------------------------------------------------------------------------------- clouds

std::string cloud_message(double stamp_s, const std::string& frame, float z_m) {
  const float values[] = {0.5F, 0.0F, z_m, NAN, 0.0F, 0.0F};
  RosPointCloud cloud;
  cloud.header = {static_cast<std::int64_t>(std::llround((stamp_s - 1700000000.0) * 1e9)) + 1700000000000000000, frame};
  cloud.height = 1;
  cloud.width = 2;
  cloud.fields = {{"x", 0, 7, 1}, {"y", 4, 7, 1}, {"z", 8, 7, 1}};
  cloud.point_step = 12;
  cloud.row_step = 24;
  cloud.data = {reinterpret_cast<const char*>(values), sizeof values};
  return message_bytes(cloud);
}

TEST_F(Init, PointsServeWhereThereAreNoDepthImages) {
  Robot robot;
  robot.cameras = {"left"};
  robot.depth = false;
  std::vector<Recorded> messages = messages_of(robot);
  for (int i = 0; i < 100; ++i) {
    const double t = 1700000000.05 + 0.1 * i;
    messages.push_back({"/left/points", kPointCloudType, t, cloud_message(t, "left_link", 3.0F)});
  }
  InitOptions options = options_for(robot);
  scratch_.write("bag.mcap", mcap_bytes(messages));
  const InitReport report = init_recording(options);
  EXPECT_EQ(report.cameras[0].depth, "/left/points");
  EXPECT_EQ(report.cameras[0].depth_kept, 15U);
  const Recording recording = load_recording(scratch_ / "monday");
  ASSERT_TRUE(recording.rig.cameras[0].depth);
  const auto points = read_point_cloud(scratch_ / "monday" / recording.frames[0][0].cloud_file);
  ASSERT_TRUE(std::holds_alternative<std::vector<Eigen::Vector3f>>(points));
  // From the link's axes (x forward) and 15 mm beside it into optical ones; the point that is none is left out.
  const auto& seen = std::get<std::vector<Eigen::Vector3f>>(points);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_LT((seen[0] - Eigen::Vector3f(0.015F, -3.0F, 0.5F)).norm(), 1e-6F);
}

// Colour and depth are rectified alike, and rig.yaml has no distortion.
TEST_F(Init, ImagesOfALensThatNobodyFollowsAreRectified) {
  Robot robot;
  robot.cameras = {"left"};
  robot.rational = {4, 0, 0, 0, 0, 8, 0, 0};  // half the distance from the axis towards the border
  const InitReport report = run(robot);
  EXPECT_THAT(report.notes, Contains(HasSubstr("images are rectified")));
  const Recording recording = load_recording(scratch_ / "monday");
  EXPECT_EQ(recording.rig.cameras[0].camera.lens, Lens::kPinhole);
  const fs::path folder = scratch_ / "monday";
  const auto color = read_grey_image(folder / recording.frames[0][0].color_file);
  const auto depth = read_depth_image(folder / recording.frames[0][0].depth_file);
  ASSERT_TRUE(std::holds_alternative<Image8>(color) && std::holds_alternative<Image16>(depth));
  EXPECT_EQ(std::get<Image8>(color).at(32, 24), 5);  // the shade of the first image
  EXPECT_EQ(std::get<Image16>(depth).at(32, 24), 2000);
}

TEST_F(Init, TypesThatNobodyKnowsAreNamed) {
  Robot robot;
  robot.cameras.clear();
  std::vector<Recorded> messages = messages_of(robot);
  messages.push_back({"/left/image", "my_msgs/msg/Picture", 1700000000.0, CdrBytes().text("?").str()});
  InitOptions options = options_for(robot);
  scratch_.write("bag.mcap", mcap_bytes(messages));
  EXPECT_THAT(failure(options), AllOf(HasSubstr("has no images"), HasSubstr("/left/image (my_msgs/msg/Picture)")));
}

// What a damaged beginning leaves of a bag is nothing; why is said.
TEST_F(Init, AnEmptyBagSaysHowItWasRead) {
  InitOptions options = options_for(Robot());
  const std::string magic("\x89MCAP0\r\n", 8);
  scratch_.write("bag.mcap", magic + std::string("\x01\xff\xff\xff\x7f\0\0\0\0", 9) + "rest");
  EXPECT_THAT(failure(options), AllOf(HasSubstr("no messages at all"), HasSubstr("or is damaged"),
                                      HasSubstr("a record of 2147483647 bytes, of which 13 are there")));
}

TEST_F(Init, DamagedMessagesNameTheirTopic) {
  std::vector<Recorded> messages = messages_of(Robot());
  messages.push_back({"/odom", kOdometryType, 1700000001.0, "no CDR at all"});
  InitOptions options = options_for(Robot());
  scratch_.write("bag.mcap", mcap_bytes(messages));
  EXPECT_THAT(failure(options), AllOf(HasSubstr("topic /odom"), HasSubstr("no plain CDR")));
  options.source = scratch_.write("text.txt", "hello");
  EXPECT_THAT(failure(options), HasSubstr("no bag"));
}

TEST_F(Init, AFewPosesThatAreNoneAreLeftOutAndManyAreRefused) {
  InitOptions options = options_for(Robot());
  std::vector<Recorded> messages = messages_of(Robot());
  const PoseFields none = {NAN, 0, 0, 0, 0, 0, 1};
  const auto add = [&](const char* topic, const char* type, const std::string& data) {
    messages.push_back({topic, type, 1700000001.0, data});
  };
  add("/odom", kOdometryType, odometry_message(1700000001.001, {0, 0, 0, 0, 0, 0, 0}, ""));
  add("/tf", kTfType, tf_message(1700000001.0, {{"base_link", "wheel", none}}));
  add("/tf_static", kTfType, tf_message(1700000001.0, {{"base_link", "arm", none}, {"base_link", "mast", {}}}));
  scratch_.write("bag.mcap", mcap_bytes(messages));
  const InitReport report = init_recording(options);
  EXPECT_EQ(report.odometry_rows, 1000U);
  const InitReport good = [&] {
    InitOptions other = options;
    other.source = scratch_.write("good.mcap", mcap_bytes(messages_of(Robot())));
    other.output = scratch_ / "good";
    return init_recording(other);
  }();
  EXPECT_EQ(read_text_file(scratch_ / "monday/odometry.csv"), read_text_file(scratch_ / "good/odometry.csv"))
      << "a message of zeros, which names no frames, moves nothing";
  EXPECT_THAT(report.notes,
              Contains(AllOf(HasSubstr("/odom: 1 of 1001 poses"), HasSubstr("1700000001.001 s"), HasSubstr("norm 0"))));
  EXPECT_THAT(report.notes, Contains(AllOf(HasSubstr("/tf_static: left out is arm"), HasSubstr("nan"))));
  EXPECT_THAT(report.notes, Not(Contains(HasSubstr("wheel"))));
  EXPECT_TRUE(load_frame_tree(scratch_ / "monday/tf_static.json").has("mast"));
  fs::remove_all(scratch_ / "monday");
  for (int i = 0; i < 60; ++i) add("/odom", kOdometryType, odometry_message(1700000001.0 + 0.001 * i, none));
  scratch_.write("bag.mcap", mcap_bytes(messages));
  EXPECT_THAT(failure(options), AllOf(HasSubstr("/odom: 61 of 1061 poses"), HasSubstr("--topic odometry=TOPIC")));
}

TEST_F(Init, AFrameOfACameraWhosePoseIsNoneIsRefused) {
  InitOptions options = options_for(Robot());
  const PoseFields none = {0, 0, 0, 0, 0, 0, 0};
  const std::vector<TransformFields> bad = {{"base_link", "left_link", none}, {"left_link", "left_optical", {}}};
  scratch_.write("bag.mcap", WithFrames{bad}.bytes());
  EXPECT_THAT(failure(options), AllOf(HasSubstr("camera left: /tf_static: left_link: a pose"),
                                      HasSubstr("--topic tf_static=none"), Not(HasSubstr("camera right"))));
  // One that comes again whole is good.
  std::vector<TransformFields> mended = bad;
  mended.push_back({"base_link", "left_link", {}});
  scratch_.write("bag.mcap", WithFrames{mended}.bytes());
  EXPECT_THAT(init_recording(options).notes, Not(Contains(HasSubstr("left out is"))));
}

// What is told of a bag that grows is what is told of it as it lies there.
TEST_F(Init, OfABagThatGrowsTheSameIsToldAsOfOneThatIsReadAnew) {
  McapLayout layout;
  layout.chunk_bytes = 65536;
  layout.compression = "zstd";
  const std::string bytes = mcap_bytes(messages_of(Robot()), layout);
  RecordCheckOptions options;
  options.source.board = Board();
  options.source.source = scratch_.write("bag.mcap", bytes.substr(0, bytes.size() / 4));
  options.growing = true;
  RecordWatch watch(options);
  std::size_t last = 0;
  for (int part = 2; part <= 8; ++part) {
    std::ofstream(options.source.source, std::ios::binary)
        << bytes.substr(0, bytes.size() * static_cast<std::size_t>(part) / 8);
    const RecordCheck grown = watch.look(), anew = RecordWatch(options).look();
    EXPECT_EQ(grown.stops, anew.stops) << part;
    EXPECT_EQ(grown.duration_s, anew.duration_s) << part;
    ASSERT_EQ(grown.cameras.size(), anew.cameras.size());
    for (std::size_t i = 0; i < grown.cameras.size(); ++i) {
      EXPECT_EQ(grown.cameras[i].stops, anew.cameras[i].stops) << part;
      EXPECT_EQ(grown.cameras[i].underexposed, anew.cameras[i].underexposed) << part;
      EXPECT_EQ(grown.cameras[i].left_out.size(), anew.cameras[i].left_out.size()) << part;
    }
    last = grown.stops;
  }
  EXPECT_EQ(last, 5U);
}

}  // namespace
}  // namespace rigproof
