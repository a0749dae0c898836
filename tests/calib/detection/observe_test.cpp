#include "rigproof/calib/vision/observe.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <utility>

#include "board_picture.h"
#include "looking_forward.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/random.h"
#include "rigproof/words/sentences.h"
#include "temp_folder.h"
#include "worded.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr int kStops = 6;
const Board kBoard{"checkerboard", 5, 4, 0.1, {}, {}, {}};
constexpr double kHeight = 0.6;

/// A robot with two cameras that drives in front of a board that stands on the floor, written as a recording.
class ObserveTest : public testing::Test {
 protected:
  void SetUp() override {
    const Camera camera = Camera::symmetric(640, 360, 320.0);
    for (const char* name : {"left", "right"}) {
      RigCamera rig_camera;
      rig_camera.name = rig_camera.folder = name;
      rig_camera.camera = camera;
      rig_camera.depth = DepthStream();
      rig_camera.depth->max_m = 8.0;
      recording_.rig.cameras.push_back(rig_camera);
    }
    recording_.rig.board = kBoard;
    recording_.folder = folder_.path();
    recording_.frames.resize(2);
    for (int i = 0; i < kStops; ++i) add_stop(i);
  }

  // Optical frame on the robot: z forward, x right, y down, tilted 10 degrees down.
  static Rigid3 T_robot_camera(std::size_t camera) {
    const double yaw = camera == 0 ? 0.15 : -0.15;
    const Eigen::Quaterniond tilt(Eigen::AngleAxisd(-0.17, Vector3d::UnitX()));
    return {rotation_z(yaw) * looking_forward() * tilt, {0.2, camera == 0 ? 0.1 : -0.1, kHeight}};
  }
  static Rigid3 T_world_robot(int stop) { return planar_pose(0.15 * stop, 0.1 * (stop % 3), 0.12 * (stop % 4 - 1.5)); }
  // The board faces the robot at 2.2 m, its x axis to the robot's right.
  static Rigid3 T_world_board() { return {looking_forward(), {2.4, 0.2, 0.85}}; }
  static Rigid3 T_camera_board(int stop, std::size_t camera) {
    return (T_world_robot(stop) * T_robot_camera(camera)).inverse() * T_world_board();
  }

  void add_stop(int stop) {
    const double stamp = 2.0 * stop + 1.0;
    const Rigid3 T = T_world_robot(stop);
    for (const double offset : {-0.1, 0.0, 0.1})
      recording_.odometry.push_back({stamp + offset, T.translation.x() + 1e-3 * offset, T.translation.y(), yaw_of(T)});
    for (std::size_t camera = 0; camera < 2; ++camera) {
      const std::string& name = recording_.rig.cameras[camera].name;
      CameraFrame frame;
      frame.color_file = name + "/color/" + std::to_string(stop) + ".png";
      frame.depth_file = name + "/depth/" + std::to_string(stop) + ".png";
      frame.stamp_s = stamp;
      write_frame(stop, camera, frame);
      recording_.frames[camera].push_back(frame);
    }
  }

  void write_frame(int stop, std::size_t camera, const CameraFrame& frame, double noise = 1.0) {
    fs::create_directories(folder_.path() / fs::path(frame.color_file).parent_path());
    fs::create_directories(folder_.path() / fs::path(frame.depth_file).parent_path());
    write_image(stop, camera, frame, noise, kBoard);
    write_depth(stop, camera, folder_.path() / frame.depth_file);
  }

  void write_image(int stop, std::size_t camera, const CameraFrame& frame, double noise, const Board& board) {
    const Camera& optics = recording_.rig.cameras[camera].camera;
    BoardPictureOptions options;
    options.noise_sigma = noise;
    options.supersampling = 2;
    options.seed = static_cast<std::uint64_t>(10 * stop) + camera;
    Image8 image = draw_board(optics, board, T_camera_board(stop, camera), options);
    cv::imwrite((folder_.path() / frame.color_file).string(),
                cv::Mat(image.height, image.width, CV_8UC1, image.pixels.data()));
  }

  // Floor, board, and a wall 4 m ahead that fills more of the image than the floor.
  void write_depth(int stop, std::size_t camera, const fs::path& file) const {
    const Camera& optics = recording_.rig.cameras[camera].camera;
    const Rigid3 T_world_camera = T_world_robot(stop) * T_robot_camera(camera);
    const Rigid3 T_board_world = T_world_board().inverse();
    RandomStream random(3, "depth", stop, static_cast<std::int32_t>(camera));
    cv::Mat depth(optics.height_px, optics.width_px, CV_16UC1, cv::Scalar(0));
    for (int v = 0; v < optics.height_px; ++v) {
      for (int u = 0; u < optics.width_px; ++u) {
        Vector3d ray;
        optics.unproject({static_cast<double>(u), static_cast<double>(v)}, &ray);
        const Vector3d o = T_world_camera.translation, d = T_world_camera.rotation * ray;
        double z = (4.0 - o.x()) / d.x();
        if (d.z() < 0.0) z = std::min(z, -o.z() / d.z());
        const Vector3d ob = T_board_world * o, db = T_board_world.rotation * d;
        const double zb = -ob.z() / db.z();
        const Vector3d hit = ob + zb * db;
        const bool on_board = hit.x() > -0.15 && hit.x() < 0.45 && hit.y() > -0.15 && hit.y() < 0.35;
        if (on_board && zb > 0.0) z = std::min(z, zb);
        const double noisy = 1.0 / (1.0 / z + random.normal(0.0, 0.0019));
        if (noisy > 0.4 && noisy < 8.0)
          depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(std::lround(1000.0 * noisy));
      }
    }
    cv::imwrite(file.string(), depth);
  }

  static std::string error_of(const Recording& recording) {
    try {
      observe(recording);
    } catch (const Error& error) {
      return words::message_of(error);
    }
    return "no error";
  }

  static std::set<std::string> reasons(const Observations& observations) {
    std::set<std::string> all;
    for (const Exclusion& exclusion : observations.exclusions) all.insert(worded(exclusion.why));
    return all;
  }

  TempFolder folder_;
  Recording recording_;
};

TEST_F(ObserveTest, SeesBoardsFloorAndOdometry) {
  const Observations seen = observe(recording_);
  ASSERT_EQ(seen.stops.size(), static_cast<std::size_t>(kStops));
  EXPECT_NEAR(seen.stops[3].x_m, T_world_robot(3).translation.x(), 1e-12);
  EXPECT_EQ(seen.stops[3].interpolation_sigma_m, 0.0);
  ASSERT_EQ(seen.board_views.size(), 2U * kStops);
  for (const Exclusion& exclusion : seen.exclusions) EXPECT_THAT(exclusion.why.code, testing::HasSubstr("plane."));
  for (const BoardView& view : seen.board_views) {
    const auto camera = static_cast<std::size_t>(view.camera);
    const auto truth = true_corners(seen.cameras[camera].camera, kBoard, T_camera_board(view.stop, camera));
    ASSERT_EQ(view.corners.size(), truth.size());
    for (const CornerObservation& corner : view.corners)
      EXPECT_LT((corner.pixel - truth[static_cast<std::size_t>(corner.id)]).norm(), 0.05);
  }
}

// Sharper frames of another moment do not separate them: the body moves on its tyres while the wheels stand.
TEST_F(ObserveTest, OfAStandstillAllCamerasShowOneMoment) {
  for (std::size_t camera = 0; camera < 2; ++camera) {
    std::vector<CameraFrame>& frames = recording_.frames[camera];
    CameraFrame early = frames.front(), late = early;
    early.stamp_s -= 0.08;
    late.stamp_s += 0.08;
    early.color_file = early.color_file + ".early.png";
    late.color_file = late.color_file + ".late.png";
    write_frame(0, camera, early, camera == 0 ? 0.2 : 2.0);
    write_frame(0, camera, late, camera == 0 ? 2.0 : 0.2);
    frames.insert(frames.begin() + 1, late);
    frames.insert(frames.begin(), early);
  }
  const Observations seen = observe(recording_);
  ASSERT_EQ(seen.stops.size(), static_cast<std::size_t>(kStops));
  ASSERT_EQ(seen.board_views.size(), 2U * kStops);
  for (std::size_t camera = 0; camera < 2; ++camera)
    EXPECT_EQ(seen.board_views[camera].stamp_s, seen.stops[0].stamp_s) << camera;
}

TEST_F(ObserveTest, FindsTheFloorAndNotTheWall) {
  const Observations seen = observe(recording_);
  // A frame whose floor is mixed with the wall may be left out, with a reason; none may be wrong.
  ASSERT_GE(seen.ground_planes.size(), 2U * kStops - 1U);
  EXPECT_EQ(seen.ground_planes.size() + seen.exclusions.size(), 2U * kStops);
  for (const PlaneObservation& plane : seen.ground_planes) {
    const Rigid3 T = T_robot_camera(static_cast<std::size_t>(plane.camera));
    const Vector3d expected = -(T.rotation.inverse() * Vector3d::UnitZ()) / kHeight;
    const Vector3d error = plane.inverse_depth_plane - expected;
    // Within 5 sigma: 36 numbers are judged.
    EXPECT_LT(error.dot(plane.covariance_per_m2.inverse() * error), 25.0) << error.transpose();
    EXPECT_LT(error.norm(), 0.01);
  }
}

TEST_F(ObserveTest, MeasuresDepthOnTheBoard) {
  const Observations seen = observe(recording_);
  ASSERT_EQ(seen.board_planes.size(), 2U * kStops);
  for (const PlaneObservation& plane : seen.board_planes) {
    const Rigid3 T = T_camera_board(plane.stop, static_cast<std::size_t>(plane.camera));
    const Vector3d n = T.rotation * Vector3d::UnitZ();
    const Vector3d error = plane.inverse_depth_plane - n / n.dot(T.translation);
    EXPECT_LT(error.dot(plane.covariance_per_m2.inverse() * error), 25.0);
    EXPECT_NEAR(plane.residual_rms, 1.0, 0.25);  // the sensor's law is the one that was drawn from
  }
}

TEST_F(ObserveTest, DoesNotDependOnThreads) {
  ObserveOptions options;
  options.threads = 1;
  const Observations one = observe(recording_, options);
  options.threads = 5;
  const Observations five = observe(recording_, options);
  const TempFolder folder;
  save_observations(one, folder.path() / "one.json");
  save_observations(five, folder.path() / "five.json");
  std::ifstream a(folder.path() / "one.json"), b(folder.path() / "five.json");
  const std::string first((std::istreambuf_iterator<char>(a)), {}), second((std::istreambuf_iterator<char>(b)), {});
  EXPECT_GT(first.size(), 1000U);
  EXPECT_EQ(first, second);
}

TEST_F(ObserveTest, BadFilesAreExclusions) {
  const auto file = [this](std::size_t camera, int stop) {
    return folder_.path() / recording_.frames[camera][static_cast<std::size_t>(stop)].color_file;
  };
  fs::remove(file(0, 0));
  fs::resize_file(file(0, 1), fs::file_size(file(0, 1)) / 2);
  std::ofstream(file(0, 2)) << "not an image";
  cv::imwrite(file(0, 3).string(), cv::Mat(100, 200, CV_8UC1, cv::Scalar(50)));
  fs::remove(folder_.path() / recording_.frames[1][0].depth_file);
  recording_.frames[1][1].color_file = "../../etc/passwd";
  const Observations seen = observe(recording_);
  EXPECT_EQ(seen.board_views.size(), 2U * kStops - 5U);
  EXPECT_GE(seen.exclusions.size(), 6U);
  const std::set<std::string> why = reasons(seen);
  EXPECT_THAT(why, testing::IsSupersetOf({"file is missing", "truncated PNG", "not a PNG or JPEG image",
                                          "image of another size (200x100, the rig says 640x360)"}));
}

// Each camera sees a board of its own, at the same place.
TEST_F(ObserveTest, EachImageCountsForTheBoardThatItShows) {
  std::array<Board, 2> boards = {kBoard, kBoard};
  for (Board& board : boards) board.type = "charuco";
  boards[0].dictionary = "DICT_5X5_50";
  boards[1].dictionary = "DICT_4X4_50";
  recording_.rig.board = boards[0];
  recording_.rig.more_boards = {boards[1]};
  for (int i = 0; i < kStops; ++i)
    for (std::size_t camera = 0; camera < 2; ++camera)
      write_image(i, camera, recording_.frames[camera][static_cast<std::size_t>(i)], 1.0, boards[camera]);
  Observations seen = observe(recording_);
  ASSERT_EQ(seen.boards(), 2);
  ASSERT_EQ(seen.board_views.size(), 2U * kStops);
  EXPECT_EQ(seen.board_planes.size(), 2U * kStops);
  for (const BoardView& view : seen.board_views) {
    ASSERT_EQ(view.board, view.camera) << view.file;
    const auto camera = static_cast<std::size_t>(view.camera);
    const auto truth = true_corners(seen.cameras[camera].camera, boards[camera], T_camera_board(view.stop, camera));
    EXPECT_GE(view.corners.size(), 6U);
    for (const CornerObservation& corner : view.corners)
      EXPECT_LT((corner.pixel - truth[static_cast<std::size_t>(corner.id)]).norm(), 0.1);
  }
  std::swap(recording_.rig.board, recording_.rig.more_boards[0]);
  for (const BoardView& view : observe(recording_).board_views) EXPECT_EQ(view.board, 1 - view.camera) << view.file;
  // Without the other board its images show none.
  recording_.rig.more_boards.clear();
  seen = observe(recording_);
  ASSERT_EQ(seen.board_views.size(), static_cast<std::size_t>(kStops));
  for (const BoardView& view : seen.board_views) EXPECT_EQ(view.camera, 1);
}

TEST_F(ObserveTest, IntrinsicsOfAnotherSizeAreAnError) {
  recording_.rig.cameras[1].camera.width_px = 1280;
  EXPECT_THAT(error_of(recording_), testing::HasSubstr("cameras.right: image is 640x360, the rig says 1280x360"));
}

TEST_F(ObserveTest, AWrongBoardSizeIsNamed) {
  recording_.rig.board.squares_x = 4;
  recording_.rig.board.squares_y = 3;
  EXPECT_THAT(error_of(recording_), testing::HasSubstr("4x3 inner corners = 5x4 squares; the rig says squares [4, 3]"));
}

TEST_F(ObserveTest, OfAnAprilGridTheImagesTellHowLargeItsTagsAre) {
  Board printed{"aprilgrid", 4, 3, 0.2, {}, {}, {}};
  printed.marker_m = 0.155;
  for (int stop = 0; stop < kStops; ++stop)
    for (std::size_t camera = 0; camera < 2; ++camera)
      write_image(stop, camera, recording_.frames[camera][static_cast<std::size_t>(stop)], 1.0, printed);
  recording_.rig.board = printed;
  recording_.rig.board.marker_m = 0.152;  // as a ruler has it
  const Observations seen = observe(recording_);
  EXPECT_EQ(seen.board_views.size(), 2U * kStops);
  EXPECT_NEAR(seen.board.marker_side_m(), 0.155, 3e-5);
  EXPECT_EQ(seen.board.square_m, 0.2) << "which no image tells";
  recording_.rig.board.marker_m = 0.145;
  EXPECT_THAT(error_of(recording_), testing::AllOf(testing::HasSubstr("rig.yaml: board.marker_mm: 145"),
                                                   testing::HasSubstr("77.5 %"), testing::HasSubstr(": 155 if")));
  for (auto& frames : recording_.frames) frames.resize(2);  // enough to see that it is another one
  recording_.rig.board = kBoard;
  EXPECT_THAT(error_of(recording_), testing::HasSubstr("an AprilGrid (type: aprilgrid) with squares [4, 3]"));
}

TEST_F(ObserveTest, ACameraThatNeverSeesTheBoardIsNoError) {
  for (const CameraFrame& frame : recording_.frames[1])
    cv::imwrite((folder_.path() / frame.color_file).string(), cv::Mat(360, 640, CV_8UC1, cv::Scalar(90)));
  const Observations seen = observe(recording_);
  EXPECT_EQ(seen.board_views.size(), static_cast<std::size_t>(kStops));
  EXPECT_THAT(reasons(seen), testing::Contains("no board"));
  // Its floor is known all the same.
  EXPECT_GE(seen.ground_planes.size(), 2U * kStops - 1U);
  for (const CameraFrame& frame : recording_.frames[0])
    cv::imwrite((folder_.path() / frame.color_file).string(), cv::Mat(360, 640, CV_8UC1, cv::Scalar(90)));
  EXPECT_THAT(error_of(recording_), testing::HasSubstr("is in none of 12 readable images (12 no board)"));
}

TEST_F(ObserveTest, WithoutDepthThereAreNoPlanes) {
  for (auto& frames : recording_.frames)
    for (CameraFrame& frame : frames) frame.depth_file.clear();
  const Observations seen = observe(recording_);
  EXPECT_TRUE(seen.ground_planes.empty());
  EXPECT_TRUE(seen.board_planes.empty());
  EXPECT_FALSE(seen.exclusions.empty());
  for (const Exclusion& exclusion : seen.exclusions)
    EXPECT_TRUE(exclusion.depth && exclusion.why.is("depth.missing")) << exclusion.why.code;
}

TEST_F(ObserveTest, ProgressCountsAndInterrupts) {
  ObserveOptions options;
  std::size_t last = 0, planes = 0;
  options.progress = [&last, &planes](std::size_t done, std::size_t all) {
    EXPECT_EQ(done, std::min(last + 1, all));  // all of all: planes are looked for
    EXPECT_EQ(all, 2U * kStops);
    planes += done == last ? 1 : 0;
    last = done;
    return true;
  };
  observe(recording_, options);
  EXPECT_EQ(last, 2U * kStops);
  EXPECT_GT(planes, 0U);
  const auto expect_interrupted = [&] {
    try {
      observe(recording_, options);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::kTryAgain);
    }
  };
  options.progress = [](std::size_t, std::size_t) { return false; };
  expect_interrupted();
  last = 0;
  options.progress = [&last](std::size_t done, std::size_t) { return std::exchange(last, done) != done; };
  expect_interrupted();
}

}  // namespace
}  // namespace rigproof
