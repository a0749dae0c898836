#include "rigproof/core/board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "rigproof/core/board_markers.h"
#include "rigproof/core/rig_yaml.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(Board, CornersRunAlongXFirst) {
  Board board;
  board.squares_x = 6;
  board.squares_y = 5;
  board.square_m = 0.11;
  ASSERT_EQ(board.corner_count(), 20);
  const auto corners = board.corners();
  EXPECT_EQ(corners[0], Eigen::Vector3d(0.0, 0.0, 0.0));
  EXPECT_EQ(corners[1], Eigen::Vector3d(0.11, 0.0, 0.0));
  EXPECT_EQ(corners[5], Eigen::Vector3d(0.0, 0.11, 0.0));
  EXPECT_EQ(corners[19], Eigen::Vector3d(0.11 * 4, 0.11 * 3, 0.0));
}

TEST(Board, OutlineSurroundsTheSquares) {
  const Board board;
  const auto outline = board.outline();
  ASSERT_EQ(outline.size(), 4U);
  EXPECT_EQ(outline[0], Eigen::Vector3d(-0.1, -0.1, 0.0));
  EXPECT_NEAR(outline[2].x(), 0.4, 1e-15);
  EXPECT_NEAR(outline[2].y(), 0.3, 1e-15);
  EXPECT_LT((0.25 * (outline[0] + outline[1] + outline[2] + outline[3]) - board.centre()).norm(), 1e-15);
}

TEST(Board, HalfTurnIsTellableWithOneOddCount) {
  Board board;
  EXPECT_FALSE(board.ambiguous_under_half_turn());
  EXPECT_TRUE(board.is_dark(0, 0));
  // The square that a half turn brings to (0, 0) is light, so the turned board looks different.
  EXPECT_FALSE(board.is_dark(board.squares_x - 1, board.squares_y - 1));
  board.squares_x = 9;
  board.squares_y = 7;
  EXPECT_TRUE(board.ambiguous_under_half_turn());
}

TEST(Board, CornersOfAnAprilGridAreThoseOfItsTags) {
  Board board;
  board.type = "aprilgrid";
  board.squares_x = 3;
  board.squares_y = 2;
  board.square_m = 0.13;
  board.marker_m = 0.1;
  EXPECT_EQ(board.corner_count(), 24);
  EXPECT_DOUBLE_EQ(board.along(-1), 0.1 - 0.13);
  EXPECT_DOUBLE_EQ(board.along(0), 0.0);
  EXPECT_DOUBLE_EQ(board.along(1), 0.1);
  EXPECT_DOUBLE_EQ(board.along(2), 0.13);
  EXPECT_DOUBLE_EQ(board.along(6), 0.39) << "the outer edge of the last small square";
  EXPECT_TRUE(board.corner(9).isApprox(Eigen::Vector3d(board.along(3), board.along(1), 0.0)));
  EXPECT_TRUE(board.centre().isApprox(Eigen::Vector3d(0.18, 0.115, 0.0)));
  EXPECT_TRUE(board.outline()[2].isApprox(Eigen::Vector3d(0.39, 0.26, 0.0)));
  const std::vector<BoardMarker> tags = markers_of(board);
  ASSERT_EQ(tags.size(), 6U);
  EXPECT_EQ(tags[0].ix, 1);
  EXPECT_EQ(tags[0].iy, 3) << "ids begin in the lowest row";
  EXPECT_EQ(tags[5].ix, 5);
  EXPECT_EQ(tags[5].iy, 1);
  EXPECT_TRUE(board.is_dark(tags[0].ix, tags[0].iy));
}

class MarkedBoard : public testing::Test {
 protected:
  Board read(const std::string& rest) {
    return load_board(scratch_.write("board.yaml", "type: charuco\nsquares: [6, 4]\nsquare_mm: 40\n" + rest).string());
  }
  std::string failure(const std::string& rest) {
    return error_text([&] { read(rest); });
  }

  TempFolder scratch_;
};

TEST_F(MarkedBoard, HasMarkersOfThreeQuartersAndTheSmallestDictionary) {
  const Board board = read("");
  EXPECT_DOUBLE_EQ(board.marker_side_m(), 0.03);
  EXPECT_STREQ(dictionary_of(board).name, "DICT_5X5_50");
  const std::vector<BoardMarker> markers = markers_of(board);
  ASSERT_EQ(markers.size(), 12U);
  EXPECT_EQ(markers[0].ix, 1) << "the first square is dark";
  EXPECT_EQ(markers[3].iy, 1);
}

TEST_F(MarkedBoard, LegacyPatternBeginsWithAMarkerWhereRowsAreEven) {
  Board board = read("marker_mm: 20\ndictionary: DICT_4X4_1000\nlegacy_pattern: true\n");
  EXPECT_DOUBLE_EQ(board.marker_side_m(), 0.02);
  EXPECT_EQ(dictionary_of(board).bits, 4);
  EXPECT_EQ(markers_of(board)[0].ix, 0);
  board.squares_y = 5;
  EXPECT_EQ(markers_of(board)[0].ix, 1) << "OpenCV draws odd rows the same in all versions";
}

TEST_F(MarkedBoard, WhatCannotBeIsRefused) {
  EXPECT_THAT(failure("marker_mm: 40\n"), HasSubstr("less than square_mm"));
  EXPECT_THAT(failure("dictionary: DICT_8X8\n"), AllOf(HasSubstr("DICT_8X8"), HasSubstr("DICT_4X4_50, DICT_4X4_100")));
  EXPECT_THAT(error_text([&] {
                load_board(scratch_
                               .write("b.yaml",
                                      "type: charuco\nsquares: [20, 20]\nsquare_mm: 40\n"
                                      "dictionary: DICT_6X6_100\n")
                               .string());
              }),
              AllOf(HasSubstr("200 markers"), HasSubstr("DICT_6X6_100 has 100")));
  EXPECT_THAT(error_text([&] {
                load_board(scratch_
                               .write("b.yaml",
                                      "type: checkerboard\nsquares: [6, 5]\nsquare_mm: 40\n"
                                      "marker_mm: 20\n")
                               .string());
              }),
              HasSubstr("of charuco boards and aprilgrids"));
  EXPECT_THAT(error_text([&] {
                load_board(scratch_
                               .write("b.yaml",
                                      "type: aprilgrid\nsquares: [6, 4]\nsquare_mm: 40\n"
                                      "dictionary: DICT_5X5_50\n")
                               .string());
              }),
              HasSubstr("are of charuco boards"));
}

TEST_F(MarkedBoard, OfTagsTheSideMayBeStated) {
  const auto load = [&](const std::string& rest) {
    return load_board(scratch_.write("g.yaml", "type: aprilgrid\nsquares: [6, 4]\nsquare_mm: 130\n" + rest).string());
  };
  EXPECT_NEAR(load("").marker_side_m(), 0.1, 1e-15) << "Kalibr's gap of 0.3 tags";
  EXPECT_NEAR(load("marker_mm: 104\n").marker_side_m(), 0.104, 1e-15);
}

}  // namespace
}  // namespace rigproof
