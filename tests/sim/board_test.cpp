// What is drawn on boards, read back: markers by OpenCV's own detector, defects by measuring.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>

#include "board_model.h"
#include "board_region.h"
#include "error_text.h"
#include "printed_board.h"
#include "rigproof/sim/board_pattern.h"
#include "rigproof/sim/models.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// The board's texture in grey; the first square begins `frame` squares from its corner.
cv::Mat picture(const Board& board, const BoardDefects& defects = {}) {
  BoardTexture texture = draw_board(board, board.square_m, defects);
  const cv::Mat rgb(texture.height, texture.width, CV_8UC3, texture.rgb.data());
  cv::Mat grey;
  cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
  return grey;
}

TEST(BoardPattern, OpenCvFindsEveryMarkerAndCornerOfACharucoBoard) {
  const Board board = board_of("charuco", 7, 5, 0.04);
  const cv::Mat image = picture(board);
  const double texels = image.cols / 9.0;
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_50);
  const auto charuco = cv::aruco::CharucoBoard::create(7, 5, 0.04F, 0.03F, dictionary);
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
  cv::aruco::detectMarkers(image, dictionary, corners, ids);
  EXPECT_EQ(ids.size(), 17U);
  std::vector<cv::Point2f> inner;
  std::vector<int> inner_ids;
  cv::aruco::interpolateCornersCharuco(corners, ids, image, charuco, inner, inner_ids);
  ASSERT_EQ(inner.size(), static_cast<std::size_t>(board.corner_count()));
  for (std::size_t i = 0; i < inner.size(); ++i) {
    const Eigen::Vector3d corner = board.corner(inner_ids[i]);
    // Two squares from the texture's edge to the first corner. The refinement of this OpenCV, at an edge between two
    // texels, ends half a texel to the lower right of it: 0.2 % of a square.
    EXPECT_NEAR(inner[i].x, texels * (2.0 + corner.x() / 0.04) - 0.5, 0.6);
    EXPECT_NEAR(inner[i].y, texels * (2.0 + corner.y() / 0.04) - 0.5, 0.6);
  }
}

TEST(BoardPattern, OpenCvFindsEveryTagOfAnAprilGrid) {
  const Board board = board_of("aprilgrid", 5, 3, 0.1);
  const cv::Mat image = picture(board);
  const double cell = image.cols / 9.0;  // two columns beside the grid: the margin, and half of a small square
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = 2;
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
  cv::aruco::detectMarkers(image, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11), corners, ids,
                           parameters);
  ASSERT_EQ(ids.size(), 15U);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const cv::Point2f middle = 0.25F * (corners[i][0] + corners[i][1] + corners[i][2] + corners[i][3]);
    EXPECT_NEAR(middle.x, cell * (2.5 + ids[i] % 5) - 0.5, 2.0);
    EXPECT_NEAR(middle.y, cell * (2.5 + 2 - ids[i] / 5) - 0.5, 2.0) << "ids begin at the bottom left";
    EXPECT_NEAR(cv::norm(corners[i][1] - corners[i][0]), cell / 1.3, 3.0);
  }
}

TEST(BoardPattern, TooManyMarkersAndUnknownTypesAreRefused) {
  EXPECT_THAT(error_text([] { dark_areas(board_of("aprilgrid", 30, 30, 0.1)); }),
              AllOf(HasSubstr("900 markers"), HasSubstr("587")));
  EXPECT_THAT(error_text([] { dark_areas(board_of("circles", 5, 4, 0.1)); }), HasSubstr("circles"));
}

double share_that_differs(const cv::Mat& a, const cv::Mat& b, int by) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  return static_cast<double>(cv::countNonZero(difference > by)) / static_cast<double>(a.total());
}

TEST(BoardRefinement, IsFinerWhereTheCellsOfMarkersAreSmall) {
  const Camera camera = Camera::symmetric(1280, 720, 640.0);
  Board board{"charuco", 7, 5, 0.1, {}, {}, {}};  // cells of 10.7 mm
  const auto at = [&](double distance_m) {
    return board_refinement(camera, Rigid3(Eigen::Quaterniond::Identity(), {0.0, 0.0, distance_m}), board);
  };
  EXPECT_EQ(at(3.3), 4) << "2.1 px";
  EXPECT_EQ(at(3.6), 8) << "1.9 px";
  const Rigid3 aslant(so3_exp({0.0, deg_to_rad(60.0), 0.0}), {0.0, 0.0, 2.5});
  EXPECT_EQ(at(2.5), 4);
  EXPECT_EQ(board_refinement(camera, aslant, board), 8) << "1.7 px along the narrow side";
  board.type = "checkerboard";
  EXPECT_EQ(at(3.6), 2);
}

TEST(BoardDefects, AClothHidesItsShareOfTheSheet) {
  const Board board = board_of("checkerboard", 6, 5, 0.1);
  BoardDefects defects;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    defects.seed = seed;
    defects.covered = 0.2;
    // The whole texture is the sheet here, with its margin of a square. The triangle may reach over an edge.
    EXPECT_NEAR(share_that_differs(picture(board), picture(board, defects), 20), 0.2, 0.01);
  }
}

TEST(BoardDefects, GlareBrightensAndDirtDarkensLightAreas) {
  const Board board = board_of("checkerboard", 6, 5, 0.1);
  const cv::Mat clean = picture(board);
  BoardDefects glare;
  glare.glare = 1.0;
  EXPECT_GT(cv::mean(picture(board, glare))[0], cv::mean(clean)[0] + 3.0);
  double high = 0.0;
  cv::minMaxLoc(picture(board, glare), nullptr, &high);
  EXPECT_GT(high, 250.0);
  BoardDefects dirt;
  dirt.dirt = 0.5;
  const double some = share_that_differs(clean, picture(board, dirt), 10);
  dirt.dirt = 1.0;
  EXPECT_GT(some, 0.001);
  EXPECT_GT(share_that_differs(clean, picture(board, dirt), 10), some);
  EXPECT_EQ(share_that_differs(clean, picture(board), 0), 0.0);
}

// Distance from the viewer to the face at a place of the board, by the world's own geometry.
double distance_to(const BoardDefects& defects, double x_m, double y_m, ObjectKind* hit = nullptr) {
  const RigModel rig = load_rig_model("husky_3x_d455");
  const SceneModel scene = load_scene_model("indoor_lab");
  WorldDescription description =
      describe_world(rig, scene, rig.rig.board, place_board(rig.rig.board, scene.board.middle()), 0);
  for (SceneTexture& texture : description.scene.textures) texture.size_px = 16;
  description.board_defects = defects;
  const auto world = World::compose(description);
  const Rigid3& T = description.T_world_board;
  return world->cast_ray(T * Eigen::Vector3d(x_m, y_m, -0.3), T.rotation * Eigen::Vector3d::UnitZ(), hit);
}

TEST(BoardDefects, ABowedPlateStandsOutInItsMiddle) {
  const RigModel rig = load_rig_model("husky_3x_d455");
  const Board& board = rig.rig.board;
  const double middle_x = board.centre().x(), middle_y = board.centre().y();
  const double half = 0.5 * board.square_m * board.squares_x + 0.05;
  BoardDefects defects;
  defects.bow_m = 0.01;
  // Strips depart by half a strip's share squared: 0.01 / 48^2 m; a ray that leans by nothing hits where it is aimed.
  for (const double share : {0.0, 0.5, -0.9}) {
    EXPECT_NEAR(distance_to({}, middle_x + share * half, middle_y), 0.3, 1e-6);
    EXPECT_NEAR(distance_to(defects, middle_x + share * half, middle_y), 0.3 - 0.01 * (1.0 - share * share), 1e-5);
  }
}

TEST(BoardDefects, AScaledPrintIsLarger) {
  const RigModel rig = load_rig_model("husky_3x_d455");
  const Board& board = rig.rig.board;
  const double edge = board.centre().x() + 0.5 * board.square_m * board.squares_x + 0.05;
  BoardDefects defects;
  defects.print_scale_x = 1.02;
  ObjectKind hit = ObjectKind::kNothing;
  const double beyond = edge + 0.01 * (edge - board.centre().x());
  distance_to(defects, beyond, board.centre().y(), &hit);
  EXPECT_EQ(hit, ObjectKind::kBoard);
  distance_to({}, beyond, board.centre().y(), &hit);
  EXPECT_NE(hit, ObjectKind::kBoard);
}

TEST(BoardDefects, PrintedCornersHaveScaleBowAndShifts) {
  const Board board = load_rig_model("husky_3x_d455").rig.board;
  BoardDefects defects;
  EXPECT_FALSE(defects.moves_corners());
  EXPECT_EQ(printed_corners(board, 0.05, defects), board.corners());
  defects.print_scale_x = 1.01;
  defects.bow_m = 0.002;
  for (int id = 0; id < board.corner_count(); ++id) defects.corner_shifts_m.emplace_back(1e-4 * id, -2e-4);
  EXPECT_TRUE(defects.moves_corners());
  const std::vector<Eigen::Vector3d> corners = printed_corners(board, 0.05, defects);
  const double half = 0.5 * board.square_m * board.squares_x + 0.05;
  for (int id = 0; id < board.corner_count(); ++id) {
    const Eigen::Vector3d from_centre = board.corner(id) - board.centre();
    const double across = from_centre.x() / half;
    const Eigen::Vector3d expected(board.centre().x() + 1.01 * from_centre.x() + 1e-4 * id, board.corner(id).y() - 2e-4,
                                   -0.002 * (1.0 - across * across));
    EXPECT_LT((corners[static_cast<std::size_t>(id)] - expected).norm(), 1e-12) << id;
  }
}

}  // namespace
}  // namespace rigproof
