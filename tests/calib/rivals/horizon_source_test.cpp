// What a network made here, byte by byte, sees of the horizon, and the calibration that follows from it.
#include "rigproof/calib/vision/horizon_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "error_text.h"
#include "onnx_bytes.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "room.h"
#include "temp_folder.h"
#include "worded.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

constexpr int kSpot = 32;

// Black but for a white square around a place.
Image8 spot(int width, int height, const Eigen::Vector2i& centre) {
  Image8 image(width, height);
  for (int y = centre.y() - kSpot / 2; y < centre.y() + kSpot / 2; ++y)
    for (int x = centre.x() - kSpot / 2; x < centre.x() + kSpot / 2; ++x)
      if (x >= 0 && y >= 0 && x < width && y < height) image.at(x, y) = 255;
  return image;
}

TEST(DnnHorizon, TellsPlacesInPixels) {
  const TempFolder folder;
  const auto source = dnn_horizon(folder.write("tiny.onnx", horizon_network(kSpot * kSpot, 0.25)));
  // The middle of a square of an even number of pixels lies between pixels.
  const HorizonSight sight = source->look(spot(512, 512, {300, 180}));
  ASSERT_TRUE(sight.ahead_px && sight.horizon_px);
  EXPECT_NEAR(sight.ahead_px->x(), 299.5, 1.0);
  EXPECT_NEAR(sight.ahead_px->y(), 179.5, 1.0);
  const Eigen::Vector2d left = (*sight.horizon_px)[0], right = (*sight.horizon_px)[1];
  EXPECT_NEAR(left.x(), -0.5, 1e-3);
  EXPECT_NEAR(right.x(), 511.5, 1e-3);
  EXPECT_NEAR((right - left).y() / (right - left).x(), 0.25, 1e-3);
  EXPECT_NEAR(left.y() + 0.25 * 300.0, 179.5, 1.0);
}

TEST(DnnHorizon, StretchesTheImage) {
  const TempFolder folder;
  const auto source = dnn_horizon(folder.write("tiny.onnx", horizon_network(kSpot * kSpot / 4.0, 0.0, true, false)));
  const HorizonSight sight = source->look(spot(1024, 1024, {200, 640}));
  ASSERT_TRUE(sight.ahead_px.has_value());
  EXPECT_FALSE(sight.horizon_px.has_value());
  EXPECT_NEAR(sight.ahead_px->x(), 199.5, 2.0);
  EXPECT_NEAR(sight.ahead_px->y(), 639.5, 2.0);
}

TEST(DnnHorizon, SaysWhatIsWrongWithANetwork) {
  const TempFolder folder;
  EXPECT_THAT(error_text([&] { dnn_horizon(folder / "none.onnx"); }), HasSubstr("none.onnx"));
  const auto features = folder.write("features.onnx", keypoint_network());
  EXPECT_THAT(error_text([&] { dnn_horizon(features); }), HasSubstr("features.onnx"));
  EXPECT_THAT(error_text([&] { horizon_source_by_name("geometry"); }), HasSubstr("onnx:FILE"));
}

// A level camera on a straight drive: the spot stands where the way ahead meets the horizon.
TEST(SensorX2Car, TakesHorizonAndWayAheadFromANetwork) {
  const TempFolder folder;
  const Rigid3 T_robot_camera = mounted(0.2, 0.0, 0.7, deg_to_rad(-7.0), deg_to_rad(9.0), 0.0);
  RoomDrive drive;
  RigCamera camera;
  camera.name = camera.folder = "front";
  camera.camera = Camera::symmetric(512, 512, 400.0);
  drive.observations.cameras = drive.recording.rig.cameras = {camera};
  drive.recording.folder = folder.path();
  drive.recording.frames.resize(1);
  const Eigen::Vector3d ahead = T_robot_camera.rotation.conjugate() * Eigen::Vector3d::UnitX();
  Eigen::Vector2d place;
  ASSERT_TRUE(camera.camera.project(ahead, &place));
  const Image8 image = spot(512, 512, (place + Eigen::Vector2d(0.5, 0.5)).array().round().cast<int>());
  for (int i = 0; i < 5; ++i) {
    const std::string file = std::to_string(i) + ".png";
    cv::imwrite((folder / file).string(), cv::Mat(512, 512, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())));
    drive.observations.stops.push_back({1.0 * i, 0.3 * i, 0.0, 0.0, 0.0});
    drive.observations.exclusions.push_back({0, i, file, Finding("board.not_found")});
    drive.recording.frames[0].push_back({file, "", "", 1.0 * i, 0.0, 0});
  }
  const auto network = dnn_horizon(folder.write("tiny.onnx", horizon_network(kSpot * kSpot, 0.0)));
  MethodInput input{drive.observations, &drive.recording, 2};
  EXPECT_EQ(run_method(find_method("sensorx2car"), input).status, ResultStatus::kRefused);  // black images, no turn
  input.horizon = network.get();
  const Result result = run_method(find_method("sensorx2car"), input);
  ASSERT_EQ(result.status, ResultStatus::kSolved) << testing::PrintToString(result.reasons);
  const Vector6d error = transform_error(result.camera_to_robot[0].T_parent_child, T_robot_camera);
  EXPECT_LT(rad_to_deg(error.tail<3>().norm()), 0.25);
}

}  // namespace
}  // namespace rigproof
