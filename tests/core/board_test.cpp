#include "rigproof/core/board.h"

#include <gtest/gtest.h>

namespace rigproof {
namespace {

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
  EXPECT_TRUE(Board::is_dark(0, 0));
  // The square that a half turn brings to (0, 0) is light, so the turned board looks different.
  EXPECT_FALSE(Board::is_dark(board.squares_x - 1, board.squares_y - 1));
  board.squares_x = 9;
  board.squares_y = 7;
  EXPECT_TRUE(board.ambiguous_under_half_turn());
}

}  // namespace
}  // namespace rigproof
