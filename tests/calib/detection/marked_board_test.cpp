// ChArUco boards and AprilGrids in pictures made from formulas: identities, accuracy, parts of boards.
#include "rigproof/calib/vision/marked_board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "charuco_views.h"
#include "foreign_picture.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

using Eigen::Vector2d;

std::string reason_of(const BoardDetection& detection) {
  if (const auto* missing = std::get_if<BoardNotFound>(&detection)) return worded(missing->why);
  return "found";
}

Board board_7x5() { return {"charuco", 7, 5, 0.1, {}, {}, {}}; }

Board legacy_6x4() {
  Board board{"charuco", 6, 4, 0.1, {}, {}, {}};
  board.dictionary = "DICT_6X6_100";
  board.marker_m = 0.05;
  board.legacy_pattern = true;
  return board;
}

// Two metres before a camera, somewhat turned.
CharucoView view_of(const Board& board) {
  CharucoView view{board, Camera::symmetric(1280, 720, 640.0), {}};
  view.T_camera_board = board_in_view(view.camera, board, 1.6, 0.4, 0.7, 0.3, {600.0, 380.0});
  return view;
}

Image8 picture_of(const CharucoView& view, const BoardPictureOptions& options = {}) {
  return draw_board(view.camera, view.board, view.T_camera_board, options);
}

// Views out to 4 m and 60 degrees, with a camera of 640 px focal length: squares of 8 px at the farthest.
TEST(Charuco, IsFoundRightlyIdentifiedAndAccurateOverTrials) {
  const Trials views(10, 100);
  const CharucoCounts counts = count_views(views.count(), {}, 11);
  EXPECT_EQ(counts.missed, 0);
  EXPECT_EQ(counts.wrong, 0);
  EXPECT_EQ(counts.lost, 0);
  // The goal of a clean picture, as of a checkerboard's.
  EXPECT_LT(counts.rms_px(), 0.006);
  EXPECT_LT(counts.largest, 0.05);
}

// Of 1,000 the only one that was missed: at twice its size the search sees but a few of its corners.
TEST(Charuco, OneSeenFromAfarAndAslantIsFound) {
  RandomStream random(7, "ChArUco views");
  CharucoView view;
  for (int i = 0; i <= 348; ++i) view = random_view({}, random);
  BoardPictureOptions picture;
  picture.seed = 7348;
  EXPECT_EQ(reason_of(detect_by_markers(picture_of(view, picture), view.board)), "found");
}

TEST(Charuco, NoiseStaysWithinTheStatedCovarianceOverTrials) {
  const Trials views(6, 60);
  BoardPictureOptions noisy;
  noisy.noise_sigma = 2.0;
  const CharucoCounts counts = count_views(views.count(), noisy, 12);
  EXPECT_EQ(counts.missed + counts.wrong, 0);
  // The floor of 0.003 px makes it less than one; the corners of one board are as many draws.
  EXPECT_LT(counts.whitened(), 1.15);
  EXPECT_GT(counts.whitened(), 0.6);
}

// Of boards with few columns, far away, the rest may be too little to tell the board by.
TEST(Charuco, HalfHiddenOnesArePlacedAsWellAsTheRestTellsOverTrials) {
  const Trials views(12, 60);
  BoardPictureOptions noisy;
  noisy.noise_sigma = 2.0;
  const CharucoCounts counts = count_views(views.count(), noisy, 15, {false, 4.0, 0.5});
  EXPECT_EQ(counts.wrong, 0);
  EXPECT_LE(counts.missed, 0.05 * counts.views + 1.0);
  EXPECT_GT(counts.lost, 0.3 * (counts.lost + counts.corners));
  EXPECT_LT(counts.poses_by_bound(), 1.2);
  EXPECT_GT(counts.poses_by_bound(), 0.5);
}

TEST(Charuco, AHalfHiddenBoardGivesTheCornersThatAreSeen) {
  const CharucoView view = view_of(board_7x5());
  const std::vector<Vector2d> truth = true_corners(view.camera, view.board, view.T_camera_board);
  BoardPictureOptions left;
  left.hidden_to_x = 3.5;
  const BoardDetection detection = detect_by_markers(picture_of(view, left), view.board);
  ASSERT_EQ(reason_of(detection), "found");
  const auto& corners = std::get<std::vector<CornerObservation>>(detection);
  // Columns 4, 5 and 6 of squares are seen: the corners from x = 4 on, in four rows.
  EXPECT_EQ(corners.size(), 12U);
  for (const CornerObservation& corner : corners) {
    EXPECT_GE(corner.id % 6, 3);
    EXPECT_LT((corner.pixel - truth[static_cast<std::size_t>(corner.id)]).norm(), 0.05) << corner.id;
  }
  left.hidden_to_x = 6.2;
  EXPECT_NE(reason_of(detect_by_markers(picture_of(view, left), view.board)), "found");
}

TEST(Charuco, AnotherBoardIsNotTaken) {
  const CharucoView view = view_of(board_7x5());
  const Image8 image = picture_of(view);
  Board other = view.board;
  EXPECT_EQ(reason_of(detect_by_markers(image, other)), "found");
  other.dictionary = "DICT_6X6_50";
  EXPECT_EQ(reason_of(detect_by_markers(image, other)), "no board");
  other = view.board;
  std::swap(other.squares_x, other.squares_y);
  EXPECT_EQ(reason_of(detect_by_markers(image, other)), "no board");
  Board legacy = legacy_6x4();
  const Image8 old = picture_of(view_of(legacy));
  EXPECT_EQ(reason_of(detect_by_markers(old, legacy)), "found");
  legacy.legacy_pattern = false;
  EXPECT_EQ(reason_of(detect_by_markers(old, legacy)), "no board");
  BoardPictureOptions clutter;
  clutter.clutter = true;
  const Board plain{"checkerboard", 6, 5, 0.1, {}, {}, {}};
  CharucoView checkered = view;
  checkered.board = plain;
  EXPECT_EQ(reason_of(detect_by_markers(picture_of(checkered, clutter), board_7x5())), "no board");
}

// Squares of 5 to 8 px, whose markers have cells of less than a pixel.
std::vector<CharucoView> small_views(int count, std::uint64_t seed) {
  RandomStream random(seed, "small views");
  std::vector<CharucoView> views;
  for (int i = 0; i < count; ++i) {
    CharucoView view{board_7x5(), Camera::symmetric(320, 180, 160.0), {}};
    view.T_camera_board = board_in_view(view.camera, view.board, random.uniform(2.0, 3.2), random.uniform(0.0, 0.5),
                                        random.uniform(0.0, 6.0), random.uniform(-0.3, 0.3),
                                        {random.uniform(60.0, 260.0), random.uniform(50.0, 130.0)});
    views.push_back(view);
  }
  return views;
}

TEST(Charuco, SmallSquaresAreAsUncertainAsTheyAreOverTrials) {
  CharucoCounts counts;
  BoardPictureOptions picture;
  picture.noise_sigma = 0.5;
  for (const CharucoView& view : small_views(Trials(40, 300).count(), 5)) {
    picture.seed = static_cast<std::uint64_t>(counts.views);
    counts.add(view, picture);
  }
  EXPECT_EQ(counts.wrong, 0);
  EXPECT_GT(counts.corners, 50);
  EXPECT_LT(counts.whitened(), 1.1);  // 1.15 of markers that are dark all over
  EXPECT_GT(counts.whitened(), 0.5);
}

/// How often a board is found as it is, and as others with other markers.
struct Readings {
  int found = 0, taken = 0, taken_knowingly = 0;  ///< the last: where it is known that there are several

  void look(const Image8& image, const Board& shown) {
    std::vector<Board> boards = {shown, shown, shown};
    boards[0].dictionary = "DICT_5X5_50";
    boards[1].dictionary = "DICT_4X4_50";
    boards[2].dictionary = "DICT_6X6_50";
    for (std::size_t b = 0; b < boards.size(); ++b) {
      CheckerboardOptions knowing;
      for (std::size_t other = 0; other < boards.size(); ++other)
        if (other != b) knowing.others.push_back(boards[other]);
      const bool with = reason_of(detect_by_markers(image, boards[b], knowing)) == "found";
      taken += b > 0 && reason_of(detect_by_markers(image, boards[b])) == "found";
      taken_knowingly += b > 0 && with;
      found += b == 0 && with;
    }
  }
};

// Markers that are hardly read look like those of another board by chance.
TEST(Charuco, SmallBoardsAreNotTakenForOthersOfTheRigOverTrials) {
  Readings readings;
  BoardPictureOptions picture;
  picture.noise_sigma = 3.0;
  for (const CharucoView& view : small_views(Trials(60, 300).count(), 6)) {
    ++picture.seed;
    readings.look(picture_of(view, picture), view.board);
  }
  EXPECT_GT(readings.found, 0);
  EXPECT_EQ(readings.taken, 0);
  EXPECT_EQ(readings.taken_knowingly, 0);
}

// Cells of less than a pixel, blurred, are much alike: they count as fewer numbers than there are. In pictures of real
// cameras a board passed for another one, with corners hundreds of pixels off.
TEST(Charuco, SmallBoardsOfRealCamerasAreNotTakenForOthersOverTrials) {
  constexpr int kFew = 60;
  const int count = Trials(kFew, 300).count();
  Readings readings;
  ForeignPicture camera{"camera", {}, true, 0.5, 90};
  camera.picture.noise_sigma = 1.5;
  std::uint64_t seed = 0;
  for (const CharucoView& view : small_views(count, 7))
    readings.look(draw_foreign(view.camera, view.board, view.T_camera_board, camera, ++seed), view.board);
  EXPECT_GT(readings.found, count >= kFew ? 5 : -1) << "of " << count;
  EXPECT_EQ(readings.taken, 0);
  EXPECT_EQ(readings.taken_knowingly, 0);
}

// Their squares are plain to see: "no board", or something in front of it, was no reason.
TEST(Charuco, WhatIsTooSmallToReadIsNoMissingBoard) {
  ForeignPicture camera{"camera", {}, true, 0.5, 90};
  camera.picture.noise_sigma = 1.5;
  std::map<std::string, int> said;
  std::uint64_t seed = 0;
  for (const CharucoView& view : small_views(30, 7)) {
    const Image8 image = draw_foreign(view.camera, view.board, view.T_camera_board, camera, ++seed);
    const std::string reason = reason_of(detect_by_markers(image, view.board));
    ++said[reason.substr(0, reason.find(" ("))];
  }
  EXPECT_GT(said["board too small"], 5);
  EXPECT_EQ(said["board partly hidden"], 0);
}

// A fisheye bends edges and lets squares grow from one side to the other: without knowing of either, all corners of a
// board at the image's border were .01 to .02 px too far in.
TEST(Charuco, FisheyesMoveNoBoardAsAWhole) {
  Camera camera = Camera::symmetric(640, 360, 310.0);
  camera.lens = Lens::kKannalaBrandt;
  camera.distortion = {-0.012, 0.002, -0.001, 0.0, 0.0};
  for (const char* type : {"charuco", "checkerboard"}) {
    Board board = board_7x5();
    board.type = type;
    for (const Vector2d& pixel : {Vector2d(80.0, 90.0), Vector2d(560.0, 170.0), Vector2d(320.0, 300.0)}) {
      const Rigid3 T = board_in_view(camera, board, 1.4, 0.3, 0.5, 0.1, pixel);
      const std::vector<Vector2d> truth = true_corners(camera, board, T);
      const BoardDetection detection = detect_board(draw_board(camera, board, T), board);
      ASSERT_EQ(reason_of(detection), "found") << type << " " << pixel.transpose();
      Vector2d sum = Vector2d::Zero();
      const auto& corners = std::get<std::vector<CornerObservation>>(detection);
      for (const CornerObservation& corner : corners) sum += corner.pixel - truth[static_cast<std::size_t>(corner.id)];
      EXPECT_LT((sum / static_cast<double>(corners.size())).norm(), 0.0025) << type << " " << pixel.transpose();
    }
  }
}

TEST(Charuco, WhichBoardItIsCanBeTold) {
  const std::optional<Board> plain = find_any_marked_board(picture_of(view_of(board_7x5())));
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->squares_x, 7);
  EXPECT_EQ(plain->squares_y, 5);
  EXPECT_EQ(plain->dictionary, "DICT_5X5_50");
  EXPECT_FALSE(plain->legacy_pattern);
  EXPECT_NEAR(*plain->marker_m, 0.75, 0.03);
  const std::optional<Board> legacy = find_any_marked_board(picture_of(view_of(legacy_6x4())));
  ASSERT_TRUE(legacy);
  EXPECT_EQ(legacy->squares_x, 6);
  EXPECT_EQ(legacy->squares_y, 4);
  EXPECT_EQ(legacy->dictionary, "DICT_6X6_50");
  EXPECT_TRUE(legacy->legacy_pattern);
  EXPECT_NEAR(*legacy->marker_m, 0.5, 0.03);
  const CharucoView checkered{{}, Camera::symmetric(1280, 720, 640.0), view_of(Board()).T_camera_board};
  EXPECT_FALSE(find_any_marked_board(picture_of(checkered)));
}

Board grid_6x4() {
  Board board{"aprilgrid", 6, 4, 0.13, {}, {}, {}};
  return board;
}

// Tags of 100 mm: their borders, 20 mm wide, have 3 px at the farthest.
TEST(AprilGrid, IsFoundRightlyIdentifiedAndAccurateOverTrials) {
  const Trials views(10, 100);
  const CharucoCounts counts = count_views(views.count(), {}, 13, {true, 2.0});
  EXPECT_EQ(counts.missed, 0);
  EXPECT_EQ(counts.wrong, 0);
  EXPECT_EQ(counts.lost, 0);
  EXPECT_LT(counts.rms_px(), 0.006);
  EXPECT_LT(counts.largest, 0.05);
}

TEST(AprilGrid, NoiseStaysWithinTheStatedCovarianceOverTrials) {
  const Trials views(6, 40);
  BoardPictureOptions noisy;
  noisy.noise_sigma = 2.0;
  const CharucoCounts counts = count_views(views.count(), noisy, 14, {true, 2.0});
  EXPECT_EQ(counts.missed + counts.wrong, 0);
  EXPECT_LT(counts.whitened(), 1.15);
  EXPECT_GT(counts.whitened(), 0.6);
}

TEST(AprilGrid, HalfHiddenOnesArePlacedAsWellAsTheRestTellsOverTrials) {
  const Trials views(5, 20);
  BoardPictureOptions noisy;
  noisy.noise_sigma = 2.0;
  const CharucoCounts counts = count_views(views.count(), noisy, 16, {true, 2.0, 0.5});
  EXPECT_EQ(counts.missed + counts.wrong, 0);
  EXPECT_GT(counts.lost, 0.3 * (counts.lost + counts.corners));
  EXPECT_LT(counts.poses_by_bound(), 1.2);
  EXPECT_GT(counts.poses_by_bound(), 0.5);
}

TEST(AprilGrid, AHalfHiddenOneGivesTheCornersThatAreSeen) {
  const CharucoView view = view_of(grid_6x4());
  const std::vector<Vector2d> truth = true_corners(view.camera, view.board, view.T_camera_board);
  BoardPictureOptions left;
  left.hidden_to_x = 3.7;  // the columns of tags 0 to 2: squares of pictures begin one before corner 0
  const BoardDetection detection = detect_by_markers(picture_of(view, left), view.board);
  ASSERT_EQ(reason_of(detection), "found");
  const auto& corners = std::get<std::vector<CornerObservation>>(detection);
  EXPECT_EQ(corners.size(), 48U);
  for (const CornerObservation& corner : corners) {
    EXPECT_GE(corner.id % 12, 6);
    EXPECT_LT((corner.pixel - truth[static_cast<std::size_t>(corner.id)]).norm(), 0.05) << corner.id;
  }
  left.hidden_to_x = 6.9;
  EXPECT_NE(reason_of(detect_by_markers(picture_of(view, left), view.board)), "found");
}

TEST(AprilGrid, BordersOfOneBitAreReadToo) {
  const CharucoView view = view_of(grid_6x4());
  BoardPictureOptions narrow;
  narrow.tag_border_bits = 1;
  const std::vector<Vector2d> truth = true_corners(view.camera, view.board, view.T_camera_board);
  const BoardDetection detection = detect_by_markers(picture_of(view, narrow), view.board);
  ASSERT_EQ(reason_of(detection), "found");
  const auto& corners = std::get<std::vector<CornerObservation>>(detection);
  EXPECT_EQ(corners.size(), truth.size());
  for (const CornerObservation& corner : corners)
    EXPECT_LT((corner.pixel - truth[static_cast<std::size_t>(corner.id)]).norm(), 0.05) << corner.id;
}

TEST(AprilGrid, AnotherOneIsNotTaken) {
  const Image8 image = picture_of(view_of(grid_6x4()));
  Board other = grid_6x4();
  std::swap(other.squares_x, other.squares_y);
  EXPECT_EQ(reason_of(detect_by_markers(image, other)), "no board");
  other = grid_6x4();
  other.squares_x = 7;
  EXPECT_EQ(reason_of(detect_by_markers(image, other)), "no board");
  EXPECT_EQ(reason_of(detect_by_markers(image, board_7x5())), "no board");
  EXPECT_EQ(reason_of(detect_by_markers(picture_of(view_of(board_7x5())), grid_6x4())), "no board");
}

TEST(AprilGrid, WhichOneItIsCanBeTold) {
  for (const int border : {2, 1}) {
    BoardPictureOptions options;
    options.tag_border_bits = border;
    const std::optional<Board> seen = find_any_marked_board(picture_of(view_of(grid_6x4()), options));
    ASSERT_TRUE(seen) << border;
    EXPECT_EQ(seen->type, "aprilgrid");
    EXPECT_EQ(seen->squares_x, 6);
    EXPECT_EQ(seen->squares_y, 4);
    EXPECT_NEAR(*seen->marker_m, 1.0 / 1.3, 0.03);
  }
}

TEST(Charuco, OddImagesAreNoBoard) {
  EXPECT_EQ(reason_of(detect_by_markers(Image8(16, 16), board_7x5())), "image too small");
  EXPECT_EQ(reason_of(detect_by_markers(Image8(), board_7x5())), "image too small");
  EXPECT_EQ(reason_of(detect_by_markers(Image8(64, 48), board_7x5())), "no board");
  EXPECT_FALSE(find_any_marked_board(Image8(64, 48)));
  EXPECT_FALSE(find_any_marked_board(Image8()));
}

}  // namespace
}  // namespace rigproof
