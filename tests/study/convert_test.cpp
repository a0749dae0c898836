#include "rigproof/study/workflow/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core/persistence.hpp>

#include "error_text.h"
#include "rigproof/calib/vision/ground_plane.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/core/files.h"
#include "rigproof/core/result.h"
#include "rigproof/core/yaml.h"
#include "rigproof/formats/format.h"
#include "rigproof/formats/trajectory.h"
#include "small_recording.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

void expect_same_cameras(const Recording& a, const Recording& b) {
  ASSERT_EQ(a.rig.cameras.size(), b.rig.cameras.size());
  for (std::size_t k = 0; k < a.rig.cameras.size(); ++k) {
    const Camera &x = a.rig.cameras[k].camera, &y = b.rig.cameras[k].camera;
    EXPECT_EQ(x.width_px, y.width_px);
    EXPECT_EQ(x.height_px, y.height_px);
    EXPECT_EQ(x.fx_px, y.fx_px);
    EXPECT_EQ(x.fy_px, y.fy_px);
    EXPECT_EQ(x.cx_px, y.cx_px);
    EXPECT_EQ(x.cy_px, y.cy_px);
    EXPECT_EQ(x.lens, y.lens);
    EXPECT_EQ(x.distortion, y.distortion);
  }
}

void expect_same_odometry(const Recording& a, const Recording& b) {
  ASSERT_EQ(a.odometry.size(), b.odometry.size());
  for (std::size_t i = 0; i < a.odometry.size(); ++i) {
    EXPECT_EQ(a.odometry[i].x_m, b.odometry[i].x_m);
    EXPECT_EQ(a.odometry[i].y_m, b.odometry[i].y_m);
    // Through sine and cosine and back.
    EXPECT_NEAR(a.odometry[i].yaw_rad, b.odometry[i].yaw_rad, 1e-15);
  }
}

std::string bytes(const Recording& recording, std::size_t camera, std::size_t frame) {
  return read_text_file(recording.folder / recording.frames[camera][frame].color_file);
}

TEST(Convert, ToTheMemrocLayoutAndBackIsExact) {
  const TempFolder scratch;
  const Recording original = small_recording(scratch / "original");
  const ConvertReport report = convert(original, "memroc", scratch / "memroc/");  // as a shell completes it
  EXPECT_EQ(report.images, 6U);
  EXPECT_EQ(report.clouds, 3U);
  const Recording there = *open_input(scratch / "memroc").recording;
  EXPECT_EQ(there.rig.board, original.rig.board);
  expect_same_cameras(original, there);
  expect_same_odometry(original, there);
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(bytes(there, k, i), bytes(original, k, i));
  convert(there, "recording", scratch / "back");
  const Recording back = load_recording(scratch / "back");
  EXPECT_EQ(back.rig.board, original.rig.board);
  expect_same_cameras(original, back);
  expect_same_odometry(original, back);
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(bytes(back, k, i), bytes(original, k, i));
}

TEST(Convert, CloudsHoldEveryPointOfTheDepthImage) {
  const TempFolder scratch;
  const Recording original = small_recording(scratch / "original");
  convert(original, "memroc", scratch / "memroc");
  const Recording there = *open_input(scratch / "memroc").recording;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto depth = read_depth_image(original.folder / original.frames[0][i].depth_file);
    const auto expected = points_from_depth(std::get<Image16>(depth), original.rig.cameras[0], 1).points;
    const auto cloud = read_point_cloud(there.folder / there.frames[0][i].cloud_file);
    ASSERT_TRUE(std::holds_alternative<std::vector<Eigen::Vector3f>>(cloud));
    EXPECT_EQ(std::get<std::vector<Eigen::Vector3f>>(cloud), expected);
  }
  EXPECT_TRUE(there.frames[1][0].cloud_file.empty());
}

TEST(Convert, ThinsCloudsToTheirLimit) {
  const TempFolder scratch;
  const Recording original = small_recording(scratch / "original");
  ConvertOptions options;
  options.max_cloud_points = 800;
  convert(original, "memroc", scratch / "memroc", options);
  const auto cloud = read_point_cloud(scratch / "memroc/camera1/clouds/0000.txt");
  const std::size_t points = std::get<std::vector<Eigen::Vector3f>>(cloud).size();
  EXPECT_GT(points, 300U);
  EXPECT_LE(points, 800U);
}

// What the authors' program reads, written out: a change of any digit or separator is a change of the format.
TEST(Convert, WritesTheTextsOfTheLayout) {
  const TempFolder scratch;
  convert(small_recording(scratch / "original"), "memroc", scratch / "memroc");
  EXPECT_EQ(scratch.read("memroc/CalibrationInfo.yaml"),
            "number_of_cameras: 2\ncamera_folder_prefix: camera\npattern_type: checkerboard\nnumber_of_rows: 4\n"
            "number_of_columns: 3\nsize: 0.1\nresize_factor: 1\n");
  EXPECT_EQ(scratch.read("memroc/camera2/intrinsic_pars_file.yaml"),
            "fx: 41.5\nfy: 41.5\ncx: 31.5\ncy: 23.5\nhas_dist_coeff: 1\ndist_k0: 0.11\ndist_k1: -0.24\n"
            "dist_px: 4e-04\ndist_py: -3e-04\ndist_k2: 0.1\ndist_k3: 0.0\ndist_k4: 0.0\ndist_k5: 0.0\n"
            "img_width: 64\nimg_height: 48\n");
  const std::string pose = scratch.read("memroc/camera1/pose/0000.csv");
  EXPECT_THAT(pose, testing::StartsWith("0.99500416527802"));
  EXPECT_THAT(pose, testing::EndsWith("\n0.0,0.0,1.0,0.0\n0.0,0.0,0.0,1.0\n"));
  EXPECT_EQ(std::count(pose.begin(), pose.end(), ','), 12);
}

TEST(Convert, RefusesWhatIsInTheWayOrCannotBeSaid) {
  const TempFolder scratch;
  Recording recording = small_recording(scratch / "original");
  scratch.write("taken/file", "x");
  EXPECT_THAT(error_text([&] { convert(recording, "memroc", scratch / "taken"); }), HasSubstr("something already"));
  EXPECT_THAT(error_text([&] { convert(recording, "recording", scratch / "taken"); }), HasSubstr("something already"));
  fs::create_directory(scratch / "empty");
  fs::create_directory_symlink("empty", scratch / "link");
  EXPECT_THAT(error_text([&] { convert(recording, "memroc", scratch / "link"); }), HasSubstr("something already"));
  EXPECT_TRUE(fs::is_symlink(scratch / "link"));
  recording.rig.cameras[1].camera.lens = Lens::kKannalaBrandt;
  recording.rig.board.squares_x = 6;
  const std::string error = error_text([&] { convert(recording, "memroc", scratch / "new"); });
  EXPECT_THAT(error, HasSubstr("cameras.right.lens"));
  EXPECT_THAT(error, HasSubstr("180 degrees"));
  EXPECT_FALSE(fs::exists(scratch / "new"));
}

TEST(Convert, ToEurocTellsImagesLensesAndOdometryByTheirStamps) {
  const TempFolder scratch;
  Recording recording = small_recording(scratch / "original");
  EXPECT_THAT(error_text([&] { convert(recording, "euroc", scratch / "refused"); }), HasSubstr("k3 must be 0"));
  recording.rig.cameras[1].camera.distortion[4] = 0.0;
  recording.rig.odometry_noise.rotation_centre_m << 0.2, -0.1;  // others take odometry for that of the origin
  const Rigid3 T_point_robot = planar_pose(-0.2, 0.1, 0.0);
  const ConvertReport report = convert(recording, "euroc", scratch / "there");
  EXPECT_EQ(report.images, 6U);
  const fs::path mav = scratch / "there/mav0";
  const std::vector<TrajectoryPose> poses = read_trajectory(mav / "odom0/data.csv");
  ASSERT_EQ(poses.size(), recording.odometry.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const OdometrySample& sample = recording.odometry[i];
    EXPECT_DOUBLE_EQ(poses[i].stamp_s, sample.stamp_s);
    const Rigid3 pose = planar_pose(sample.x_m, sample.y_m, sample.yaw_rad) * T_point_robot;
    EXPECT_LT(transform_error(poses[i].T_world_body, pose).norm(), 1e-12);
  }
  EXPECT_EQ(read_text_file(mav / "cam1/data/0000000102000000000.png"), bytes(recording, 1, 1));
  EXPECT_THAT(read_text_file(mav / "cam1/data.csv"), HasSubstr("\n0000000102000000000,0000000102000000000.png\n"));
  const YamlTree sensor = read_yaml_file(mav / "cam1/sensor.yaml");
  EXPECT_EQ(sensor.find("distortion_model")->scalar, "radial-tangential");
  EXPECT_EQ(sensor.find("distortion_coefficients")->items.size(), 4U);
  EXPECT_EQ(sensor.find("intrinsics")->items[0].scalar, "41.5");
  EXPECT_EQ(read_yaml_file(scratch / "there/target.yaml").find("targetCols")->scalar, "4");
  for (const auto& entry : fs::recursive_directory_iterator(scratch / "there"))
    EXPECT_NE(entry.path().filename(), "truth") << "nor anything else that a robot does not record";
}

TEST(Convert, AnAprilGridIsToldAsKalibrDoesAndNotToLayoutsOfEqualSquares) {
  const TempFolder scratch;
  Recording recording = small_recording(scratch / "original");
  for (RigCamera& camera : recording.rig.cameras) camera.camera.distortion.fill(0.0);
  recording.rig.board = Board();
  recording.rig.board.type = "aprilgrid";
  recording.rig.board.square_m = 0.15625;
  recording.rig.board.marker_m = 0.125;
  convert(recording, "euroc", scratch / "there", {});
  const std::string target = read_text_file(scratch / "there/target.yaml");
  EXPECT_THAT(target, AllOf(HasSubstr("target_type: aprilgrid"), HasSubstr("tagCols: 5"), HasSubstr("tagRows: 4"),
                            HasSubstr("tagSize: 0.125"), HasSubstr("tagSpacing: 0.25")));
  for (const char* format : {"memroc", "mcalib", "mrcal", "opencv"})
    EXPECT_THAT(error_text([&] { convert(recording, format, scratch / "refused", {}); }),
                AllOf(HasSubstr("rig.yaml: board.type: aprilgrid"), HasSubstr("equal squares")));
  EXPECT_FALSE(fs::exists(scratch / "refused"));
}

TEST(Convert, SeveralBoardsAreToldToARecordingAlone) {
  const TempFolder scratch;
  Recording recording = small_recording(scratch / "original");
  Board marked;
  marked.type = "charuco";
  recording.rig.board = marked;
  marked.dictionary = "DICT_4X4_50";
  recording.rig.more_boards = {marked};
  int refused = 0;
  for (const std::string& format : writable_formats()) {
    if (format == "recording") continue;
    EXPECT_THAT(error_text([&] { convert(recording, format, scratch / "refused", {}); }),
                AllOf(HasSubstr("rig.yaml: more_boards: "), HasSubstr("knows one board, and this recording has 2")))
        << format;
    ++refused;
  }
  EXPECT_GE(refused, 5);
  EXPECT_FALSE(fs::exists(scratch / "refused"));
  convert(recording, "recording", scratch / "there", {});
  EXPECT_EQ(load_recording(scratch / "there").rig.more_boards, recording.rig.more_boards);
}

TEST(Convert, ToOpenCvIsWhatItsFileStorageReads) {
  const TempFolder scratch;
  Recording recording = small_recording(scratch / "original");
  recording.frames[1].erase(recording.frames[1].begin() + 1);
  EXPECT_EQ(convert(recording, "opencv", scratch / "there").images, 5U);
  const cv::FileStorage file((scratch / "there/recording.yml").string(), cv::FileStorage::READ);
  ASSERT_TRUE(file.isOpened());
  cv::Mat poses, K, D;
  file["T_world_robot"] >> poses;
  file["camera1_K"] >> K;
  file["camera1_D"] >> D;
  ASSERT_EQ(poses.rows, 3);
  const OdometrySample& last = recording.odometry.back();
  const Eigen::Matrix4d T = planar_pose(last.x_m, last.y_m, last.yaw_rad).matrix();
  for (int i = 0; i < 16; ++i) EXPECT_NEAR(poses.at<double>(2, i), T(i / 4, i % 4), 1e-12);
  EXPECT_EQ(K.at<double>(0, 0), 41.5);
  EXPECT_EQ(D.at<double>(4), recording.rig.cameras[1].camera.distortion[4]);
  std::vector<std::string> images;
  file["camera1_images"] >> images;
  ASSERT_EQ(images.size(), 3U);
  EXPECT_EQ(images[1], "") << "no image at that stop";
  EXPECT_EQ(read_text_file(scratch / "there" / images[2]), bytes(recording, 1, 1));
  int cameras = 0;
  file["cameras"] >> cameras;
  EXPECT_EQ(cameras, 2);
}

// One view of two corners by the second camera at the last stop.
Observations one_view(const Recording& recording) {
  Observations observations;
  observations.board = recording.rig.board;
  observations.cameras = recording.rig.cameras;
  BoardView view;
  view.camera = 1;
  view.stop = 2;
  view.file = recording.frames[1][2].color_file;
  view.corners.resize(2);
  view.corners[0].id = 0;
  view.corners[0].pixel = {10.25, 20.5};
  view.corners[1].id = 5;
  view.corners[1].pixel = {11.0, 21.0};
  observations.board_views.push_back(view);
  return observations;
}

TEST(Convert, ToMrcalTellsEveryCornerAndNoExtrinsics) {
  const TempFolder scratch;
  const Recording recording = small_recording(scratch / "original");
  const Observations observations = one_view(recording);
  ConvertOptions options;
  options.observations = &observations;
  EXPECT_EQ(convert(recording, "mrcal", scratch / "there", options).images, 1U);
  const std::string corners = read_text_file(scratch / "there/corners.vnl");
  EXPECT_THAT(corners, HasSubstr("# filename x y level\nright/0002.png 10.25 20.5 0\nright/0002.png 0 0 -\n"));
  EXPECT_THAT(corners, HasSubstr("right/0002.png 11 21 0\n"));
  const Board& board = recording.rig.board;
  EXPECT_EQ(std::count(corners.begin(), corners.end(), '\n'), 1 + board.inner_corners_x() * board.inner_corners_y());
  EXPECT_EQ(read_text_file(scratch / "there/right/0002.png"), bytes(recording, 1, 2));
  const std::string model = read_text_file(scratch / "there/right.cameramodel");
  EXPECT_THAT(model, HasSubstr("'intrinsics': [ 41.5, "));
  EXPECT_THAT(model, HasSubstr("'extrinsics': [ 0, 0, 0, 0, 0, 0 ]"));
  EXPECT_THAT(read_text_file(scratch / "there/arguments.txt"), HasSubstr("left/*.png\nright/*.png\n"));
  Recording fisheye = recording;
  fisheye.rig.cameras[0].camera.lens = Lens::kKannalaBrandt;
  EXPECT_THAT(error_text([&] { convert(fisheye, "mrcal", scratch / "refused", options); }),
              HasSubstr("cameras.left.lens"));
  EXPECT_FALSE(fs::exists(scratch / "refused"));
}

TEST(Convert, ToMcCalibIsWhatFileStorageReads) {
  const TempFolder scratch;
  const Recording recording = small_recording(scratch / "original");
  const Observations observations = one_view(recording);
  ConvertOptions options;
  options.observations = &observations;
  EXPECT_EQ(convert(recording, "mcalib", scratch / "there", options).images, 1U);
  const auto opened = [&](const char* name) {
    return cv::FileStorage((scratch / "there" / name).string(), cv::FileStorage::READ);
  };
  const cv::FileStorage settings = opened("calib_param.yml"), lenses = opened("camera_params.yml"),
                        keypoints = opened("detected_keypoints_data.yml");
  EXPECT_EQ(static_cast<int>(settings["number_camera"]), 2);
  EXPECT_EQ(static_cast<double>(settings["square_size"]), recording.rig.board.square_m);
  cv::Mat K;
  lenses["camera_1"]["camera_matrix"] >> K;
  EXPECT_EQ(K.at<double>(0, 0), 41.5);
  const cv::FileNode seen = keypoints["camera_1"];
  EXPECT_EQ(static_cast<int>(seen["frame_idxs"][0]), 2);
  EXPECT_EQ(static_cast<int>(seen["charuco_idxs"][0][1]), 5);
  EXPECT_EQ(static_cast<double>(seen["pts_2d"][0][0]), 10.25);
  EXPECT_EQ(read_text_file(scratch / "there" / static_cast<std::string>(seen["frame_paths"][0])),
            bytes(recording, 1, 2));
}

// In the way in which MC-Calib writes it, beside what it was given.
TEST(Convert, WhatMcCalibAnswersIsAResultWithTheNamesOfTheExport) {
  const TempFolder scratch;
  const Recording recording = small_recording(scratch / "original");
  const Observations observations = one_view(recording);
  ConvertOptions options;
  options.observations = &observations;
  convert(recording, "mcalib", scratch / "there", options);
  const Rigid3 T_left_right(so3_exp({0.1, -0.2, 0.3}), {0.5, 0.01, -0.02});
  const auto answer = [&](int group_of_right, const fs::path& file) {
    cv::FileStorage out(file.string(), cv::FileStorage::WRITE);
    out << "nb_camera" << 2;
    for (int k = 0; k < 2; ++k) {
      cv::Mat pose = cv::Mat::eye(4, 4, CV_64F);
      const Eigen::Matrix4d matrix = k == 0 ? Eigen::Matrix4d::Identity() : T_left_right.matrix();
      for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) pose.at<double>(r, c) = matrix(r, c);
      out << "camera_" + std::to_string(k) << "{"
          << "camera_matrix" << cv::Mat::eye(3, 3, CV_64F) << "distortion_type" << 0 << "camera_group"
          << (k == 0 ? 0 : group_of_right) << "camera_pose_matrix" << pose << "}";
    }
  };
  answer(0, scratch / "there/calibrated_cameras_data.yml");
  const Result result = load_result(scratch / "there/calibrated_cameras_data.yml");
  EXPECT_EQ(result.status, ResultStatus::kSolved);
  EXPECT_EQ(result.method, "mcalib");
  EXPECT_TRUE(result.camera_to_robot.empty());
  ASSERT_EQ(result.camera_to_camera.size(), 1U);
  EXPECT_EQ(result.camera_to_camera[0].parent, "left");
  EXPECT_EQ(result.camera_to_camera[0].child, "right");
  EXPECT_LT(transform_error(result.camera_to_camera[0].T_parent_child, T_left_right).norm(), 1e-12);
  answer(1, scratch / "there/apart.yml");
  const Result apart = load_result(scratch / "there/apart.yml");
  EXPECT_EQ(apart.status, ResultStatus::kPartial);
  EXPECT_TRUE(apart.camera_to_camera.empty());
  ASSERT_EQ(apart.reasons.size(), 1U);
  EXPECT_EQ(apart.reasons[0].code, "cameras.apart");
  answer(0, scratch / "elsewhere.yml");
  EXPECT_EQ(load_result(scratch / "elsewhere.yml").camera_to_camera.at(0).child, "camera_1");
}

TEST(Convert, ToColmapHasPixelsThatBeginAtTheirCorner) {
  const TempFolder scratch;
  const Recording recording = small_recording(scratch / "original");
  EXPECT_EQ(convert(recording, "colmap", scratch / "there").images, 6U);
  const Camera& lens = recording.rig.cameras[1].camera;
  const YamlTree rig = read_yaml_file(scratch / "there/rig_config.json");  // JSON is YAML, too
  const YamlTree& right = rig.items[0].find("cameras")->items[1];
  EXPECT_EQ(right.find("image_prefix")->scalar, "rig/right/");
  EXPECT_EQ(std::stod(right.find("camera_params")->items[2].scalar), lens.cx_px + 0.5);
  EXPECT_EQ(read_text_file(scratch / "there/images/rig/right/0001.png"), bytes(recording, 1, 1));
  EXPECT_THAT(read_text_file(scratch / "there/odometry.csv"), HasSubstr("stop,x_m,y_m,yaw_rad\n0000,"));
}

TEST(Convert, AnInterruptedOneLeavesNothing) {
  const TempFolder scratch;
  Recording recording = small_recording(scratch / "original");
  recording.rig.cameras[1].camera.distortion[4] = 0.0;
  ConvertOptions options;
  options.progress = [](std::size_t done, std::size_t) { return done < 2; };
  for (const std::string& format : writable_formats()) {
    try {
      convert(recording, format, scratch / "new", options);
      FAIL() << "went on";
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::kTryAgain);
    }
    EXPECT_FALSE(fs::exists(scratch / "new"));
    EXPECT_FALSE(fs::exists(scratch / "new.partial"));
  }
}

}  // namespace
}  // namespace rigproof
