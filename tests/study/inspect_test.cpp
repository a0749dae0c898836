#include "rigproof/study/report/inspect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "../validate/synthetic.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using namespace testing_support;
namespace fs = std::filesystem;

// A board seen by a camera: a floor, the squares, nothing else. Enough to look at.
cv::Mat drawn_view(const Truth& truth, std::size_t stop, std::size_t camera) {
  const TrueCamera& c = truth.cameras[camera];
  const Rigid3 T_camera_board = (truth.stops[stop].T_world_robot * c.T_robot_camera).inverse() * truth.T_world_board;
  cv::Mat image(c.camera.height_px, c.camera.width_px, CV_8UC3, cv::Scalar(150, 160, 165));
  for (int iy = -1; iy < truth.board.inner_corners_y(); ++iy) {
    for (int ix = -1; ix < truth.board.inner_corners_x(); ++ix) {
      std::vector<cv::Point> square;
      for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
        Eigen::Vector2d pixel;
        const Eigen::Vector3d corner(truth.board.square_m * (ix + dx), truth.board.square_m * (iy + dy), 0.0);
        if (c.camera.project(T_camera_board * corner, &pixel))
          square.emplace_back(static_cast<int>(16 * pixel.x()), static_cast<int>(16 * pixel.y()));
      }
      const int shade = truth.board.is_dark(ix + 1, iy + 1) ? 30 : 240;
      if (square.size() == 4) cv::fillConvexPoly(image, square, cv::Scalar(shade, shade, shade), cv::LINE_AA, 4);
    }
  }
  return image;
}

class Inspect : public testing::Test {
 protected:
  Inspect() : truth_(make_truth(24)), observations_(make_observations(truth_, 0.02)) {
    Recording recording;
    recording.folder = folder_.path();
    recording.rig.cameras = observations_.cameras;
    for (BoardView& view : observations_.board_views) {
      view.file =
          observations_.cameras[static_cast<std::size_t>(view.camera)].name + "_" + std::to_string(view.stop) + ".png";
      cv::imwrite((folder_ / view.file).string(),
                  drawn_view(truth_, static_cast<std::size_t>(view.stop), static_cast<std::size_t>(view.camera)));
    }
    add_odometry_noise();
    add_exclusions();
    input_.input.recording = recording;
    input_.observations = observations_;
    input_.truth = truth_;
    Result result = exact_result(truth_);
    result.method = "ml";
    result.camera_to_robot[2].T_parent_child.translation.z() += 0.006;
    input_.results = {result};
  }

  void add_odometry_noise() {
    RandomStream random(1, "odometry");
    for (Stop& stop : observations_.stops) {
      stop.x_m += random.normal(0.0, 0.02);
      stop.y_m += random.normal(0.0, 0.02);
      stop.yaw_rad += random.normal(0.0, 0.02);
    }
  }

  void add_exclusions() {
    for (int stop = 0; stop < 7; ++stop)
      observations_.exclusions.push_back(
          {stop % 3, stop, observations_.board_views[static_cast<std::size_t>(stop)].file,
           stop % 2 == 0 ? Finding("board.cut_off") : Finding("view.residual", {{"residual_px", stop + 0.4}})});
    observations_.exclusions.push_back({1, -1, "center_missing.png", Finding("board.not_found")});
  }

  std::vector<std::string> write() {
    std::vector<std::string> names;
    for (const fs::path& file : write_pictures(input_, pictures_)) {
      const cv::Mat picture = cv::imread(file.string());
      EXPECT_GT(picture.cols, 500) << file;
      EXPECT_GT(picture.rows, 200) << file;
      names.push_back(file.filename().string());
    }
    return names;
  }

  const TempFolder folder_;
  const fs::path pictures_ = folder_ / "pictures";
  Truth truth_;
  Observations observations_;
  InspectInput input_;
};

TEST_F(Inspect, WritesEveryPicture) {
  EXPECT_THAT(write(), testing::ElementsAre("mosaic.png", "coverage.png", "drive.png", "rig.png", "corners_left.png",
                                            "corners_center.png", "corners_right.png", "reprojection_ml_left.png",
                                            "reprojection_ml_center.png", "reprojection_ml_right.png", "excluded.png"));
  if (const char* keep = std::getenv("RIGPROOF_KEEP_PICTURES"))
    fs::copy(pictures_, keep, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
}

TEST_F(Inspect, ARealRecordingHasNoTruth) {
  input_.truth.reset();
  input_.observations.exclusions.clear();
  EXPECT_THAT(write(), testing::ElementsAre("mosaic.png", "coverage.png", "drive.png", "rig.png", "corners_ml_left.png",
                                            "corners_ml_center.png", "corners_ml_right.png", "reprojection_ml_left.png",
                                            "reprojection_ml_center.png", "reprojection_ml_right.png"));
}

TEST_F(Inspect, ObservationsAloneWillDo) {
  input_.truth.reset();
  input_.results.clear();
  input_.input.recording.reset();
  EXPECT_THAT(write(), testing::ElementsAre("mosaic.png", "coverage.png", "drive.png", "excluded.png"));
}

TEST_F(Inspect, BrokenImagesAreShownAsSuch) {
  { std::ofstream(folder_ / observations_.board_views[0].file) << "not an image"; }
  fs::remove(folder_ / observations_.board_views[1].file);
  EXPECT_THAT(write(), testing::Contains("mosaic.png"));
}

TEST_F(Inspect, RefusedResultsAndEmptyDataGiveNoPicture) {
  input_.results[0].camera_to_robot.clear();
  input_.observations.board_views.clear();
  input_.observations.exclusions.clear();
  EXPECT_THAT(write(), testing::ElementsAre("drive.png", "rig.png"));
}

TEST_F(Inspect, AnUnwritableFolderIsAnError) {
  { std::ofstream(folder_ / "pictures") << "a file where the folder should be"; }
  EXPECT_THROW(write_pictures(input_, pictures_), Error);
}

}  // namespace
}  // namespace rigproof
