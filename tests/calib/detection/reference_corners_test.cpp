// The corners that the MEMROC authors' program works with, beside ours on the same pictures.
#include "rigproof/calib/vision/reference_corners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "board_picture.h"
#include "rigproof/calib/vision/checkerboard.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

const Camera kCamera = Camera::symmetric(1280, 720, 640.0);

struct Picture {
  Image8 image;
  std::vector<Eigen::Vector2d> truth;
};

Picture picture_at(double distance_m, double obliquity_deg, double roll_deg, const Eigen::Vector2d& pixel) {
  const Board board;
  const Rigid3 pose =
      board_in_view(kCamera, board, distance_m, deg_to_rad(obliquity_deg), 0.7, deg_to_rad(roll_deg), pixel);
  BoardPictureOptions options;
  options.supersampling = 2;
  return {draw_board(kCamera, board, pose, options), true_corners(kCamera, board, pose, options)};
}

double rms_px(const std::vector<double>& distances) {
  double sum = 0.0;
  for (const double d : distances) sum += d * d;
  return std::sqrt(sum / static_cast<double>(distances.size()));
}

// To the nearest true corner: the numbering is OpenCV's.
std::vector<double> distances(const rivals::ChessboardCorners& corners, const std::vector<Eigen::Vector2d>& truth) {
  std::vector<double> all;
  for (const Eigen::Vector2f& corner : corners.pixels) {
    double best = INFINITY;
    for (const Eigen::Vector2d& there : truth) best = std::min(best, (corner.cast<double>() - there).norm());
    all.push_back(best);
  }
  return all;
}

TEST(ReferenceCorners, AreWithinATenthOfAPixelAndFarBehindOurs) {
  std::vector<double> theirs, ours;
  for (int i = 0; i < 6; ++i) {
    const Picture picture = picture_at(1.8 + 0.25 * i, 10.0 + 5.0 * i, 4.0 * i - 10.0, {400.0 + 90.0 * i, 330.0});
    const auto corners = rivals::reference_corners(picture.image, Board());
    ASSERT_TRUE(corners) << i;
    ASSERT_EQ(corners->pixels.size(), picture.truth.size());
    for (const double d : distances(*corners, picture.truth)) theirs.push_back(d);
    const BoardDetection found = detect_checkerboard(picture.image, Board());
    ASSERT_EQ(found.index(), 0U) << i;
    for (const CornerObservation& corner : std::get<0>(found))
      ours.push_back((corner.pixel - picture.truth[static_cast<std::size_t>(corner.id)]).norm());
  }
  // Iterations end once a step is below a tenth of a pixel.
  EXPECT_LT(rms_px(theirs), 0.1);
  EXPECT_GT(rms_px(theirs), 3.0 * rms_px(ours));
}

TEST(ReferenceCorners, AreAllOrNone) {
  const Picture cut_off = picture_at(1.8, 10.0, 0.0, {15.0, 360.0});
  EXPECT_FALSE(rivals::reference_corners(cut_off.image, Board()));
  EXPECT_FALSE(rivals::reference_corners(Image8(64, 48, 1, 120), Board()));
  EXPECT_FALSE(rivals::reference_corners(Image8(1, 1), Board())) << "OpenCV asserts on some images";
}

TEST(ReferenceCorners, RunAlongTheBoardsRows) {
  const Picture picture = picture_at(2.0, 25.0, 12.0, {640.0, 360.0});
  const auto corners = rivals::reference_corners(picture.image, Board());
  ASSERT_TRUE(corners);
  const auto spacing = [&](std::size_t a, std::size_t b) { return (corners->pixels[a] - corners->pixels[b]).norm(); };
  const auto columns = static_cast<std::size_t>(Board().inner_corners_x());
  const float square = spacing(0, 1);
  for (std::size_t i = 0; i + 1 < corners->pixels.size(); ++i) {
    if ((i + 1) % columns != 0) {
      EXPECT_NEAR(spacing(i, i + 1) / square, 1.0, 0.35) << i;
    }
  }
  for (std::size_t i = 0; i + columns < corners->pixels.size(); ++i)
    EXPECT_NEAR(spacing(i, i + columns) / square, 1.0, 0.35) << i;
}

}  // namespace
}  // namespace rigproof
