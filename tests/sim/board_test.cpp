// What is printed on boards, read back: markers by OpenCV's own detector, the PDF by rendering it, defects by
// measuring.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "board_model.h"
#include "error_text.h"
#include "process.h"
#include "rigproof/core/files.h"
#include "rigproof/sim/board_pattern.h"
#include "rigproof/sim/board_pdf.h"
#include "rigproof/sim/models.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Board board_of(const std::string& type, int columns, int rows, double square_m) {
  Board board;
  board.type = type;
  board.squares_x = columns;
  board.squares_y = rows;
  board.square_m = square_m;
  return board;
}

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
  const double cell = image.cols / 7.0;
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = 2;
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
  cv::aruco::detectMarkers(image, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11), corners, ids,
                           parameters);
  ASSERT_EQ(ids.size(), 15U);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const cv::Point2f middle = 0.25F * (corners[i][0] + corners[i][1] + corners[i][2] + corners[i][3]);
    EXPECT_NEAR(middle.x, cell * (1.5 + ids[i] % 5) - 0.5, 2.0);
    EXPECT_NEAR(middle.y, cell * (1.5 + 2 - ids[i] / 5) - 0.5, 2.0) << "ids begin at the bottom left";
    EXPECT_NEAR(cv::norm(corners[i][1] - corners[i][0]), cell / 1.3, 3.0);
  }
}

TEST(BoardPattern, TooManyMarkersAndUnknownTypesAreRefused) {
  EXPECT_THAT(error_text([] { dark_areas(board_of("aprilgrid", 30, 30, 0.1)); }),
              AllOf(HasSubstr("900 markers"), HasSubstr("587")));
  EXPECT_THAT(error_text([] { dark_areas(board_of("circles", 5, 4, 0.1)); }), HasSubstr("circles"));
}

// Dark and light runs along a line of pixels, in pixels: edges are where the level crosses the middle.
std::vector<double> edges_of(const cv::Mat& line) {
  std::vector<double> edges;
  const auto level = [&](int i) { return static_cast<double>(line.at<std::uint8_t>(i)); };
  for (int i = 1; i < static_cast<int>(line.total()); ++i) {
    const double a = level(i - 1), b = level(i);
    if ((a < 128.0) != (b < 128.0)) edges.push_back(i - 1 + (128.0 - a) / (b - a));
  }
  return edges;
}

class BoardPdfTest : public testing::Test {
 protected:
  static constexpr int kDotsPerInch = 300;
  static constexpr double kPixelsPerMm = kDotsPerInch / 25.4;

  cv::Mat render(const std::string& pdf) {
    std::ofstream(folder_ / "board.pdf", std::ios::binary) << pdf;
    const ProcessOutput result = run_process({"pdftoppm", "-r", std::to_string(kDotsPerInch), "-gray", "-singlefile",
                                              (folder_ / "board.pdf").string(), (folder_ / "page").string()});
    EXPECT_EQ(result.exit_code, 0) << "pdftoppm is in the package poppler-utils\n" << result.err;
    return cv::imread((folder_ / "page.pgm").string(), cv::IMREAD_GRAYSCALE);
  }

  // The ruler's base line is the longest dark run below the board, which ends there.
  static double ruler_mm(const cv::Mat& page, double board_end_mm) {
    int longest = 0;
    for (int y = static_cast<int>(board_end_mm * kPixelsPerMm); y < page.rows; ++y) {
      int run = 0;
      for (int x = 0; x < page.cols; ++x)
        longest = std::max(longest, run = page.at<std::uint8_t>(y, x) < 200 ? run + 1 : 0);
    }
    return longest / kPixelsPerMm;
  }

  const TempFolder folder_;
};

TEST_F(BoardPdfTest, SquaresAndRulerHaveTheirTrueSize) {
  const cv::Mat page = render(board_pdf(board_of("checkerboard", 6, 5, 0.025), {"a4", 0.01}));
  ASSERT_FALSE(page.empty());
  // A4 upright holds 150 mm of squares.
  EXPECT_NEAR(page.cols, 210.0 * kPixelsPerMm, 1.0);
  EXPECT_NEAR(page.rows, 297.0 * kPixelsPerMm, 1.0);
  // The first row of squares, 6 + 10 mm below the edge of the page: dark, light, dark, light, dark and a last light
  // one.
  const int row = static_cast<int>((16.0 + 12.5) * kPixelsPerMm);
  const std::vector<double> edges = edges_of(page.row(row));
  ASSERT_EQ(edges.size(), 6U);
  // The renderer rounds edges to whole pixels of 0.085 mm.
  for (std::size_t i = 1; i < edges.size(); ++i) EXPECT_NEAR((edges[i] - edges[i - 1]) / kPixelsPerMm, 25.0, 0.1);
  EXPECT_NEAR(edges.front() / kPixelsPerMm, 0.5 * (210.0 - 150.0), 0.1) << "in the middle of the page";
  const std::vector<double> down = edges_of(page.col(static_cast<int>(42.5 * kPixelsPerMm)));
  ASSERT_GE(down.size(), 6U);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_NEAR((down[i] - down[i - 1]) / kPixelsPerMm, 25.0, 0.1);
  EXPECT_NEAR(down.front() / kPixelsPerMm, 16.0, 0.1);
  EXPECT_NEAR(ruler_mm(page, 155.0), 150.0, 0.4) << "an A4 page has room for 150 mm";
}

TEST_F(BoardPdfTest, MarkersOfAPrintedCharucoBoardAreFound) {
  const cv::Mat page = render(board_pdf(board_of("charuco", 7, 5, 0.04), {"fit", 0.01}));
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
  cv::aruco::detectMarkers(page, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_50), corners, ids);
  EXPECT_EQ(ids.size(), 17U);
  EXPECT_NEAR(cv::norm(corners.at(0)[1] - corners.at(0)[0]) / kPixelsPerMm, 30.0, 0.2);
  EXPECT_GE(ruler_mm(page, 220.0), 100.0);
}

TEST_F(BoardPdfTest, TagsOfAPrintedAprilGridHaveTheirTrueSizeAndTheirRuler) {
  const cv::Mat page = render(board_pdf(board_of("aprilgrid", 5, 3, 0.04), {"fit", 0.01}));
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = 2;
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
  cv::aruco::detectMarkers(page, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11), corners, ids,
                           parameters);
  ASSERT_EQ(ids.size(), 15U);
  // Corners of contours are whole pixels of 0.085 mm inside of the tag, two to three in all.
  for (const std::vector<cv::Point2f>& tag : corners)
    EXPECT_NEAR(cv::norm(tag[1] - tag[0]) / kPixelsPerMm, 40.0 / 1.3, 0.3);
  EXPECT_GE(ruler_mm(page, 145.0), 100.0);
}

TEST_F(BoardPdfTest, ABoardThatFitsOnlyOnItsSideIsTurned) {
  // 6 x 5 squares of 35 mm, 210 x 175 mm: with the lines below too high for A4 across, too wide for it upright.
  const cv::Mat page = render(board_pdf(board_of("checkerboard", 6, 5, 0.035), {"a4", 0.005}));
  ASSERT_FALSE(page.empty());
  EXPECT_NEAR(page.cols, 210.0 * kPixelsPerMm, 1.0);
  // The first row of squares runs down the right: five along the page's width, six along its height.
  const std::vector<double> across = edges_of(page.row(static_cast<int>((11.0 + 17.5) * kPixelsPerMm)));
  ASSERT_GE(across.size(), 5U);
  EXPECT_NEAR(across.back() / kPixelsPerMm, 0.5 * (210.0 + 175.0), 0.2) << "dark at the top right";
  const std::vector<double> down = edges_of(page.col(static_cast<int>((0.5 * (210.0 + 175.0) - 17.5) * kPixelsPerMm)));
  ASSERT_GE(down.size(), 6U);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_NEAR((down[i] - down[i - 1]) / kPixelsPerMm, 35.0, 0.2);
}

TEST(BoardPdf, SaysWhatWouldFit) {
  EXPECT_THAT(error_text([] {
                board_pdf(board_of("checkerboard", 6, 5, 0.11), {"a4", 0.01});
              }),
              AllOf(HasSubstr("a4"), HasSubstr("110 mm do not fit"), HasSubstr("squares of up to 35 mm")));
  EXPECT_THAT(error_text([] { board_pdf(Board(), {"a7", 0.01}); }), HasSubstr("a4, a3"));
}

TEST(BoardPdf, IsTheSameAgainAndHasTheInstructions) {
  const std::string pdf = board_pdf(Board(), {});
  EXPECT_EQ(pdf, board_pdf(Board(), {}));
  EXPECT_THAT(pdf, AllOf(HasSubstr("Print at 100 %"), HasSubstr("divided by 5 as square_mm"),
                         HasSubstr("/PrintScaling /None")));
}

double share_that_differs(const cv::Mat& a, const cv::Mat& b, int by) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  return static_cast<double>(cv::countNonZero(difference > by)) / static_cast<double>(a.total());
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
