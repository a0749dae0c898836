// Boards with markers in rendered pictures: OpenCV's own detectors find every marker where the truth projects it.
#include <gtest/gtest.h>

#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>

#include "rigproof/core/conventions.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/sim/models.h"
#include "rigproof/sim/renderer.h"

namespace rigproof {
namespace {

/// A shipped board in the lab, and the picture of it.
class RenderedBoard {
 public:
  explicit RenderedBoard(const std::string& preset) : board_(load_board(preset)) {
    const SceneModel scene = load_scene_model("indoor_lab");
    const RigModel rig = load_rig_model("husky_1x_d455");
    const Rigid3 T_world_board = place_board(board_, scene.board.middle());
    WorldDescription description = describe_world(rig, scene, board_, T_world_board, 3);
    description.cameras[0].camera = camera_ = Camera::symmetric(1280, 1200, 1100.0);
    const auto world = World::compose(description);
    world->place_robot(planar_pose(2.0, 0.3, -0.1));
    Renderer renderer(*world, RenderOptions());
    RenderedView view;
    renderer.render(0, &view);
    T_camera_board_ = world->T_world_camera(0).inverse() * T_world_board;
    const cv::Mat rgb(view.color.height, view.color.width, CV_8UC3, view.color.pixels.data());
    cv::cvtColor(rgb, grey_, cv::COLOR_RGB2GRAY);
  }

  const Board& board() const { return board_; }
  const cv::Mat& grey() const { return grey_; }

  /// Distance of a pixel from where a point of the board is.
  double distance_px(const cv::Point2f& pixel, const Eigen::Vector3d& point) const {
    Eigen::Vector2d expected;
    EXPECT_TRUE(camera_.project(T_camera_board_ * point, &expected));
    return (Eigen::Vector2d(static_cast<double>(pixel.x), static_cast<double>(pixel.y)) - expected).norm();
  }

 private:
  Board board_;
  Camera camera_;
  Rigid3 T_camera_board_;
  cv::Mat grey_;
};

TEST(MarkerBoards, CornersOfARenderedCharucoBoardAreWhereTheTruthHasThem) {
  const RenderedBoard picture("charuco_7x5_100mm");
  const Board& board = picture.board();
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_50);
  std::vector<int> ids, inner_ids;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<cv::Point2f> inner;
  cv::aruco::detectMarkers(picture.grey(), dictionary, corners, ids);
  EXPECT_EQ(ids.size(), 17U);
  const auto charuco = cv::aruco::CharucoBoard::create(7, 5, 0.1F, 0.075F, dictionary);
  cv::aruco::interpolateCornersCharuco(corners, ids, picture.grey(), charuco, inner, inner_ids);
  ASSERT_EQ(inner.size(), static_cast<std::size_t>(board.corner_count()));
  // What this OpenCV interpolates is half a pixel off, to the lower right.
  cv::cornerSubPix(picture.grey(), inner, {5, 5}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 1e-3});
  for (std::size_t i = 0; i < inner.size(); ++i)
    EXPECT_LT(picture.distance_px(inner[i], board.corner(inner_ids[i])), 0.3) << inner_ids[i];
}

TEST(MarkerBoards, TagsOfARenderedAprilGridAreWhereTheTruthHasThem) {
  const RenderedBoard picture("aprilgrid_6x4_130mm");
  const Board& board = picture.board();
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = 2;
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
  cv::aruco::detectMarkers(picture.grey(), cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11), corners,
                           ids, parameters);
  ASSERT_EQ(ids.size(), 24U);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    // Ids begin at the bottom left; twelve corners a row, two a tag.
    const int first = 12 * 2 * (3 - ids[i] / 6) + 2 * (ids[i] % 6);
    const std::array<int, 4> outline = {first, first + 1, first + 13, first + 12};
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_LT(picture.distance_px(corners[i][k], board.corner(outline[k])), 1.0)
          << "tag " << ids[i] << " corner " << k;
  }
}

}  // namespace
}  // namespace rigproof
