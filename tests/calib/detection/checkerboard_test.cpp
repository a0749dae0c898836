#include "rigproof/calib/vision/checkerboard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "board_fit.h"
#include "board_picture.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"
#include "saddle_fit.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

using Eigen::Vector2d;

Board board_5x4() { return {"checkerboard", 5, 4, 0.1, {}, {}, {}}; }
Board board_6x5() { return {"checkerboard", 6, 5, 0.11, {}, {}, {}}; }

Camera d455() { return Camera::symmetric(1280, 720, 640.0); }

Camera distorted_camera() {
  Camera camera = d455();
  camera.lens = Lens::kBrownConrady;
  camera.distortion = {-0.3, 0.09, 0.0005, -0.0004, -0.01};
  return camera;
}

bool whole_in_view(const Camera& camera, const Board& board, const Rigid3& T_camera_board) {
  for (const Eigen::Vector3d& p : board.outline()) {
    Vector2d pixel;
    if (!camera.project(T_camera_board * p, &pixel) || !camera.contains(pixel, 3.0)) return false;
  }
  return true;
}

struct View {
  Board board;
  Rigid3 T_camera_board;
};

// A board somewhere in the image, wholly visible, at any turn.
View random_view(const Camera& camera, RandomStream& random, double max_distance_m, double max_obliquity_deg) {
  for (;;) {
    View view;
    view.board = random.below(2) == 0 ? board_5x4() : board_6x5();
    const double distance = random.uniform(0.8, max_distance_m);
    const double obliquity = deg_to_rad(random.uniform(0.0, max_obliquity_deg));
    const double axis = random.uniform(0.0, 2.0 * kPi), roll = random.uniform(0.0, 2.0 * kPi);
    const Vector2d pixel(random.uniform(0.05, 0.95) * camera.width_px, random.uniform(0.05, 0.95) * camera.height_px);
    view.T_camera_board = board_in_view(camera, view.board, distance, obliquity, axis, roll, pixel);
    if (whole_in_view(camera, view.board, view.T_camera_board)) return view;
  }
}

std::vector<CornerObservation> corners_of(const BoardDetection& detection) {
  if (const auto* corners = std::get_if<std::vector<CornerObservation>>(&detection)) return *corners;
  return {};
}

std::string reason_of(const BoardDetection& detection) {
  if (const auto* missing = std::get_if<BoardNotFound>(&detection)) return worded(missing->why);
  return "found";
}

/// Errors of detected corners against the truth.
struct Errors {
  Eigen::Array2d sum = Eigen::Array2d::Zero(), squares = Eigen::Array2d::Zero();
  double largest = 0.0, nees = 0.0;
  int corners = 0, boards = 0, incomplete = 0;

  void add(const std::vector<CornerObservation>& detected, const std::vector<Vector2d>& truth) {
    ++boards;
    incomplete += detected.size() != truth.size();
    for (const CornerObservation& corner : detected) {
      const Vector2d error = corner.pixel - truth[static_cast<std::size_t>(corner.id)];
      sum += error.array();
      squares += error.array().square();
      nees += error.dot(corner.covariance_px2.inverse() * error);
      largest = std::max(largest, error.norm());
      ++corners;
    }
  }
  Eigen::Array2d rms() const { return (squares / corners).sqrt(); }
  Eigen::Array2d bias() const { return sum / corners; }
};

Errors measure(const Camera& camera, int views, const BoardPictureOptions& options, std::uint64_t seed) {
  RandomStream random(seed, "views");
  Errors errors;
  for (int i = 0; i < views; ++i) {
    const View view = random_view(camera, random, 4.0, 60.0);
    BoardPictureOptions picture = options;
    picture.seed = seed * 1000 + static_cast<std::uint64_t>(i);
    const auto detection =
        detect_checkerboard(draw_board(camera, view.board, view.T_camera_board, picture), view.board);
    const std::vector<CornerObservation> corners = corners_of(detection);
    EXPECT_FALSE(corners.empty()) << "view " << i << ": " << reason_of(detection);
    errors.add(corners, true_corners(camera, view.board, view.T_camera_board));
  }
  return errors;
}

// One corner that is far off weighs more among fewer, so the limits of root mean squares grow with those of means.
TEST(Checkerboard, IsAccurateOnCleanImagesOverTrials) {
  const Trials views(20, 40);
  const Errors errors = measure(d455(), views.count(), {}, 1);
  // The goal is 0.006 px; 8-bit rounding alone allows about 0.001 px.
  EXPECT_LT(errors.rms().maxCoeff(), views.tolerance(0.003));
  // 640 corners at 0.0015 px have a mean good to 0.00006 px; a tenth of the goal is far above it.
  EXPECT_LT(errors.bias().abs().maxCoeff(), views.tolerance(0.0005));
  EXPECT_LT(errors.largest, 0.03);
  EXPECT_EQ(errors.incomplete, 0);
}

TEST(Checkerboard, IsAccurateUnderStrongLensDistortion) {
  const Errors errors = measure(distorted_camera(), 12, {}, 2);
  EXPECT_LT(errors.rms().maxCoeff(), 0.004);  // bent edges cost a little, the fit models them
  EXPECT_LT(errors.bias().abs().maxCoeff(), 0.0005);
}

TEST(Checkerboard, IsAccurateUnderUnevenLightOverTrials) {
  const Trials views(15, 15);
  BoardPictureOptions options;
  options.slope_per_px = 5e-4;  // light doubles over the image
  options.light = 140.0;        // so that nothing saturates
  const Errors errors = measure(d455(), views.count(), options, 3);
  EXPECT_LT(errors.rms().maxCoeff(), views.tolerance(0.004));
  EXPECT_LT(errors.bias().abs().maxCoeff(), views.tolerance(0.0007));
}

TEST(Checkerboard, CovarianceTellsTheErrorUnderNoiseOverTrials) {
  const Trials views(25, 25);
  BoardPictureOptions options;
  options.noise_sigma = 4.0;
  options.clutter = true;
  const Errors errors = measure(d455(), views.count(), options, 4);
  EXPECT_LT(errors.rms().maxCoeff(), views.tolerance(0.02));
  // Two degrees of freedom a corner. 400 corners: 4 % of scatter in sigma; beyond it the priors on curvature and light
  // make the stated sigma slightly too large on straight edges, so within 20 % in sigma.
  const double ratio = std::sqrt(errors.nees / (2.0 * errors.corners));
  EXPECT_NEAR(ratio, 1.0, views.tolerance(0.2));
}

TEST(Checkerboard, FindsSmallObliqueBoardsAtFourMetres) {
  const Camera camera = d455();
  RandomStream random(5, "far");
  for (int i = 0; i < 24; ++i) {
    const Board board = i % 2 == 0 ? board_5x4() : board_6x5();
    const Rigid3 T =
        board_in_view(camera, board, 4.0, deg_to_rad(60.0), 2.0 * kPi * i / 24.0, random.uniform(0.0, 2.0 * kPi),
                      {random.uniform(300, 980), random.uniform(200, 520)});
    const auto detection = detect_checkerboard(draw_board(camera, board, T), board);
    Errors errors;
    errors.add(corners_of(detection), true_corners(camera, board, T));
    EXPECT_EQ(errors.corners, board.corner_count()) << i << ": " << reason_of(detection);
    EXPECT_LT(errors.largest, 0.05) << i;  // squares are 8 px high
  }
}

TEST(Checkerboard, OrderIsNeverWrongOverTrials) {
  const Trials views(200, 1000);
  const Camera camera = Camera::symmetric(320, 240, 220.0);
  RandomStream random(6, "order");
  int found = 0;
  for (int i = 0; i < views.count(); ++i) {
    const View view = random_view(camera, random, 2.0, 60.0);
    BoardPictureOptions options;
    options.supersampling = 2;  // order needs no thousandths of a pixel
    options.noise_sigma = 2.0;
    options.clutter = i % 2 == 1;
    options.seed = static_cast<std::uint64_t>(i);
    const auto detection =
        detect_checkerboard(draw_board(camera, view.board, view.T_camera_board, options), view.board);
    Errors errors;
    errors.add(corners_of(detection), true_corners(camera, view.board, view.T_camera_board));
    found += errors.corners > 0;
    // A wrong order is off by a square at least, and no square is lower than 5 px here.
    ASSERT_LT(errors.largest, 1.5) << i;
  }
  // Clutter may hide nothing, but one view in a hundred has squares at the limit of 4 px.
  EXPECT_GE(found, views.count() - 1 - views.count() / 100);
}

TEST(Checkerboard, DirtyEdgesAndHiddenCornersCostOnlyThoseCorners) {
  const Camera camera = d455();
  const Board board = board_6x5();
  const Rigid3 T = board_in_view(camera, board, 1.5, 0.3, 1.0, 0.2, {640.0, 360.0});
  Image8 image = draw_board(camera, board, T);
  const std::vector<Vector2d> truth = true_corners(camera, board, T);
  const int hidden = 7;
  const Vector2d& centre = truth[hidden];
  for (int y = -14; y <= 14; ++y)
    for (int x = -14; x <= 14; ++x) image.at(static_cast<int>(centre.x()) + x, static_cast<int>(centre.y()) + y) = 128;
  const std::vector<CornerObservation> corners = corners_of(detect_checkerboard(image, board));
  ASSERT_EQ(corners.size(), truth.size() - 1);
  for (const CornerObservation& corner : corners) {
    EXPECT_NE(corner.id, hidden);
    EXPECT_LT((corner.pixel - truth[static_cast<std::size_t>(corner.id)]).norm(), 0.03);
  }
}

// Boards of an odd number of squares of whose columns something hides some at one end: what is left looks the same half
// a turn and a column away, where the board's own end would have to pass for corners.
TEST(Checkerboard, HiddenColumnsNeverMoveOrTurnItOverTrials) {
  const Trials views(40, 200);
  const Camera camera = Camera::symmetric(640, 480, 450.0);
  RandomStream random(7, "hidden");
  int found = 0;
  for (int i = 0; i < views.count(); ++i) {
    View view;
    do {
      view = random_view(camera, random, 1.2, 50.0);
      const int longer = 6 + static_cast<int>(random.below(8)), less = 1 + 2 * static_cast<int>(random.below(2));
      view.board.squares_x = i % 2 == 0 ? longer : longer - less;
      view.board.squares_y = i % 2 == 0 ? longer - less : longer;
      view.board.square_m = 0.6 / longer;
    } while (!whole_in_view(camera, view.board, view.T_camera_board));
    BoardPictureOptions options;
    options.supersampling = 2;
    options.background = random.uniform(20.0, 240.0);
    options.noise_sigma = random.uniform(0.0, 8.0);
    options.seed = static_cast<std::uint64_t>(i);
    const double hidden = random.uniform(0.2, 2.5);
    const bool at_the_end = random.below(2) == 0;
    options.hidden_from_x = at_the_end ? view.board.squares_x - hidden : -0.6;
    options.hidden_to_x = at_the_end ? 1e3 : hidden;
    Errors errors;
    errors.add(
        corners_of(detect_checkerboard(draw_board(camera, view.board, view.T_camera_board, options), view.board)),
        true_corners(camera, view.board, view.T_camera_board));
    found += errors.corners > 0;
    // Squares are 7 px or more; what hides the next square moves a corner by less than half of one.
    EXPECT_LT(errors.largest, 3.0) << i << ": " << view.board.squares_x << " x " << view.board.squares_y << " squares";
  }
  EXPECT_GE(found, views.count() / 20);  // most of those of which less than a square is hidden
}

// A part of a chequered cloth, or of another board, that is as large as the board.
TEST(Checkerboard, SquaresThatGoOnAreALargerPattern) {
  const Camera camera = d455();
  const Board board = board_5x4(), cloth = {"checkerboard", 9, 8, board.square_m, {}, {}, {}};
  const Rigid3 T = board_in_view(camera, cloth, 2.0, 0.4, 0.5, 0.3, {640.0, 360.0});
  const Image8 image = draw_board(camera, cloth, T);
  const std::vector<Vector2d> corners = true_corners(camera, cloth, T);
  const int first = 3 * cloth.inner_corners_x() + 1;  // beside a dark square, as the board's own
  detection::BoardPlacement part;
  for (int id = 0; id < board.corner_count(); ++id) {
    const int x = id % board.inner_corners_x(), y = id / board.inner_corners_x();
    part.seeds.emplace_back(id, corners[static_cast<std::size_t>(first + y * cloth.inner_corners_x() + x)]);
  }
  const detection::BoardFit fit = detection::fit_board(image, board, part, {});
  EXPECT_TRUE(fit.corners.empty());
  ASSERT_TRUE(fit.why_not);
  EXPECT_EQ(worded(*fit.why_not), "a larger board or pattern (squares go on beyond 4x3 corners)");
}

TEST(Checkerboard, ABoardOfLowSquaresIsTooSmallAndNotHidden) {
  const Camera camera = Camera::symmetric(1280, 720, 640.0);
  const Board board;
  const Rigid3 T = board_in_view(camera, board, 7.0, 1.1, 0.0, 0.0, {640.0, 360.0});
  EXPECT_THAT(reason_of(detect_checkerboard(draw_board(camera, board, T), board)),
              testing::HasSubstr("board too small"));
}

TEST(Checkerboard, TellsWhyThereIsNoBoard) {
  const Camera camera = d455();
  const Board board = board_5x4();
  const Image8 empty(1280, 720, 1, 120);
  EXPECT_EQ(reason_of(detect_checkerboard(empty, board)), "no board");
  // The image ends in the middle of the board.
  const Rigid3 cut = board_in_view(camera, board, 1.0, 0.2, 0.0, 0.1, {1250.0, 360.0});
  EXPECT_EQ(reason_of(detect_checkerboard(draw_board(camera, board, cut), board)), "board cut off");
  const Rigid3 centred = board_in_view(camera, board, 3.0, 0.2, 0.0, 0.1, {640.0, 360.0});
  BoardPictureOptions blurred;
  blurred.psf_sigma_px = 7.5;  // squares are 21 px
  EXPECT_THAT(reason_of(detect_checkerboard(draw_board(camera, board, centred, blurred), board)),
              testing::AnyOf(testing::HasSubstr("blurred"), testing::Eq("no board")));
  blurred.psf_sigma_px = 6.0;
  const Rigid3 far = board_in_view(camera, board, 20.0, 0.2, 0.0, 0.1, {640.0, 360.0});
  EXPECT_NE(reason_of(detect_checkerboard(draw_board(camera, board, far), board)), "found");
  EXPECT_EQ(reason_of(detect_checkerboard(Image8(16, 16), board)), "image too small");
}

// From far the crossings and fields of a tartan alternate as squares do, but no print is so pale.
TEST(Checkerboard, PalePatternsAreNoBoard) {
  const Board board = board_5x4();
  const Rigid3 T_camera_board = board_in_view(d455(), board, 2.5, 0.3, 0.2, 0.1, Vector2d(640.0, 360.0));
  BoardPictureOptions tartan;
  tartan.dark = 110.0;
  tartan.light = 140.0;
  tartan.border_m = 0.0;
  EXPECT_EQ(reason_of(detect_checkerboard(draw_board(d455(), board, T_camera_board, tartan), board)), "no board");
  BoardPictureOptions glare;
  glare.dark = 120.0;
  glare.light = 210.0;
  EXPECT_EQ(reason_of(detect_checkerboard(draw_board(d455(), board, T_camera_board, glare), board)), "found");
}

// Moves what the picture shows by waves of some 1.7 squares, which no lens and no bow does.
Image8 shaken(const Image8& picture, double by_px, double square_px) {
  Image8 result = picture;
  const double wave = 2.0 * kPi / (1.7 * square_px);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const int from_x = static_cast<int>(std::lround(x + by_px * std::sin(wave * y)));
      const int from_y = static_cast<int>(std::lround(y + by_px * std::cos(1.3 * wave * x)));
      *(result.row(y) + x) =
          picture.at(std::clamp(from_x, 0, picture.width - 1), std::clamp(from_y, 0, picture.height - 1));
    }
  return result;
}

// Corrugated metal was read as a board whose corners lay a tenth of a square off any plane.
TEST(Checkerboard, SquaresInDisorderAreNoBoard) {
  const Board board = board_6x5();
  const double square_px = board.square_m * d455().fx_px / 1.5;
  const Image8 picture = draw_board(d455(), board, board_in_view(d455(), board, 1.5, 0.3, 0.4, 0.1, {640.0, 360.0}));
  const auto said = [&](double share) {
    return reason_of(detect_checkerboard(shaken(picture, share * square_px, square_px), board));
  };
  EXPECT_EQ(said(0.02), "found");
  for (const double share : {0.08, 0.1, 0.12, 0.15, 0.18}) EXPECT_EQ(said(share), "no board") << share;
}

// Turns the edges about each corner by so much, one to the left and the next to the right; corners stay in place.
Image8 twisted(const Image8& picture, const std::vector<CornerObservation>& corners, double by_rad, double reach_px) {
  Image8 result = picture;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      Vector2d from(x, y);
      for (const CornerObservation& corner : corners) {
        const Vector2d off = Vector2d(x, y) - corner.pixel;
        const double angle =
            (corner.id % 2 == 0 ? by_rad : -by_rad) * std::exp(-off.squaredNorm() / reach_px / reach_px);
        from += Eigen::Rotation2Dd(angle) * off - off;
      }
      *(result.row(y) + x) = picture.at(std::clamp(static_cast<int>(std::lround(from.x())), 0, picture.width - 1),
                                        std::clamp(static_cast<int>(std::lround(from.y())), 0, picture.height - 1));
    }
  return result;
}

// Corrugated sheets behind a truck were read as a small board whose corners lay right, each with edges of its own.
TEST(Checkerboard, EdgesThatRunOffTheCornersLinesAreNoBoard) {
  const Camera camera = Camera::symmetric(480, 320, 320.0);
  const Board board = board_6x5();
  const double square_px = board.square_m * camera.fx_px / 1.5;
  const Image8 picture = draw_board(camera, board, board_in_view(camera, board, 1.5, 0.3, 0.4, 0.1, {240.0, 160.0}));
  const auto corners = std::get<std::vector<CornerObservation>>(detect_checkerboard(picture, board));
  const auto said = [&](double by_rad) {
    return reason_of(detect_checkerboard(twisted(picture, corners, by_rad, 0.4 * square_px), board));
  };
  EXPECT_EQ(said(0.05), "found");
  for (const double by_rad : {0.2, 0.25, 0.3}) EXPECT_EQ(said(by_rad), "no board") << by_rad;
}

// Grey flecks of some pixels, as stone floors and carpets have them.
Image8 flecked(std::uint64_t seed) {
  RandomStream random(seed, "flecks");
  cv::Mat coarse(72, 128, CV_8U), fine;
  for (int y = 0; y < coarse.rows; ++y)
    for (int x = 0; x < coarse.cols; ++x)
      coarse.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random.uniform(60.0, 200.0));
  cv::resize(coarse, fine, cv::Size(), 8.0, 8.0, cv::INTER_CUBIC);
  Image8 image(fine.cols, fine.rows, 1);
  for (int y = 0; y < image.height; ++y) std::copy_n(fine.ptr(y), image.width, image.row(y));
  return image;
}

// Of them some chain to grids by chance: a board that was never there was called partly hidden, or cut off.
TEST(Checkerboard, AFleckedFloorHidesNoBoard) {
  const Board board = board_5x4();
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    EXPECT_EQ(reason_of(detect_checkerboard(flecked(seed), board)), "no board") << seed;
}

// The grids of flecks hold more corners than what the image's edge leaves of a board: that was "no board".
TEST(Checkerboard, ABoardCutOffBeforeAFleckedFloorIsNamed) {
  const Camera camera = Camera::symmetric(1024, 576, 700.0);
  const Board board = board_5x4();
  const Rigid3 T = board_in_view(camera, board, 1.2, 0.3, 0.4, 0.5 * kPi, {960.0, 300.0});
  const std::vector<Eigen::Vector2d> corners = true_corners(camera, board, T);
  ASSERT_EQ(std::count_if(corners.begin(), corners.end(), [](const auto& p) { return p.x() < 1023.0; }), 8);
  BoardPictureOptions options;
  options.background = 0.0;
  const Image8 before = draw_board(camera, board, T, options);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Image8 picture = flecked(seed);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
      picture.pixels[i] = before.pixels[i] > 0 ? before.pixels[i] : picture.pixels[i];
    EXPECT_EQ(reason_of(detect_checkerboard(picture, board)), "board cut off") << seed;
  }
}

TEST(Checkerboard, AnotherBoardIsNotTakenAndIsNamed) {
  const Camera camera = d455();
  const Rigid3 T = board_in_view(camera, board_5x4(), 1.5, 0.4, 0.5, 0.3, {600.0, 330.0});
  const Image8 image = draw_board(camera, board_5x4(), T);
  const std::optional<CheckerboardSize> seen = find_any_checkerboard(image);
  ASSERT_TRUE(seen.has_value());
  EXPECT_EQ(seen->inner_corners_long, 4);
  EXPECT_EQ(seen->inner_corners_short, 3);
  const Board corners_for_squares{"checkerboard", 4, 3, 0.1, {}, {}, {}};
  EXPECT_THAT(reason_of(detect_checkerboard(image, corners_for_squares)), testing::HasSubstr("another board (4x3"));
  EXPECT_THAT(reason_of(detect_checkerboard(image, board_6x5())), testing::Not("found"));
  const std::string text = describe_size_mismatch(*seen, corners_for_squares);
  EXPECT_THAT(text, testing::HasSubstr("4x3 inner corners = 5x4 squares; the rig says squares [4, 3]"));
  EXPECT_THAT(text, testing::HasSubstr("write [5, 4]"));
}

TEST(Checkerboard, SwappedSidesDescribeTheSameBoardTurned) {
  // 4 x 5 squares are 5 x 4 squares turned by 90 degrees: found as well, with the axes that the rig asks for.
  const Camera camera = d455();
  const Rigid3 T = board_in_view(camera, board_5x4(), 1.5, 0.4, 0.5, 0.3, {600.0, 330.0});
  const Board swapped{"checkerboard", 4, 5, 0.1, {}, {}, {}};
  const auto corners = corners_of(detect_checkerboard(draw_board(camera, board_5x4(), T), swapped));
  ASSERT_EQ(corners.size(), 12U);
  const Vector2d x = corners[1].pixel - corners[0].pixel, y = corners[3].pixel - corners[0].pixel;
  EXPECT_GT(x.x() * y.y() - x.y() * y.x(), 0.0);  // never mirrored
}

TEST(Checkerboard, SymmetricBoardIsReadUpright) {
  const Camera camera = d455();
  const Board board{"checkerboard", 6, 4, 0.1, {}, {}, {}};
  ASSERT_TRUE(board.ambiguous_under_half_turn());
  for (const double roll : {0.2, 0.2 + kPi}) {
    const Rigid3 T = board_in_view(camera, board, 1.5, 0.3, 0.5, roll, {600.0, 330.0});
    const auto corners = corners_of(detect_checkerboard(draw_board(camera, board, T), board));
    ASSERT_EQ(corners.size(), 15U);
    EXPECT_GT(corners[1].pixel.x(), corners[0].pixel.x());
  }
}

TEST(Checkerboard, GreyAndColourAgree) {
  const Camera camera = d455();
  const Rigid3 T = board_in_view(camera, board_5x4(), 1.5, 0.4, 0.5, 0.3, {600.0, 330.0});
  const Image8 grey = draw_board(camera, board_5x4(), T);
  Image8 colour(grey.width, grey.height, 3);
  for (std::size_t i = 0; i < grey.pixels.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) colour.pixels[3 * i + c] = grey.pixels[i];
  const auto a = corners_of(detect_checkerboard(grey, board_5x4()));
  const auto b = corners_of(detect_checkerboard(colour, board_5x4()));
  ASSERT_EQ(a.size(), 12U);
  ASSERT_EQ(b.size(), a.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].pixel, b[i].pixel);
}

TEST(Checkerboard, StrangeImagesGiveNoBoardAndNoException) {
  const Board board = board_5x4();
  RandomStream random(7, "strange");
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(33, 2000), std::pair(640, 480), std::pair(32, 32)}) {
    for (int kind = 0; kind < 5; ++kind) {
      Image8 image(width, height, kind == 4 ? 3 : 1);
      for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const auto x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
        image.pixels[i] = static_cast<std::uint8_t>(kind == 0   ? 0
                                                    : kind == 1 ? 255
                                                    : kind == 2 ? 255U * static_cast<unsigned>((x / 8 + y / 8) % 2)
                                                    : kind == 3 ? 255U * static_cast<unsigned>((x / 3) % 2)
                                                                : random.below(256));
      }
      EXPECT_NO_THROW({ EXPECT_NE(reason_of(detect_checkerboard(image, board)), "found"); }) << width << " " << kind;
      EXPECT_NO_THROW(find_any_checkerboard(image));
    }
  }
  EXPECT_NO_THROW(detect_checkerboard(Image8(), board));
  EXPECT_NO_THROW(detect_checkerboard(Image8(64, 64), Board{"checkerboard", 1, 1, 0.1, {}, {}, {}}));
}

TEST(SaddleFit, CovarianceMatchesMonteCarloOverTrials) {
  const Trials trials(15, 60);
  const Camera camera = d455();
  const Board board = board_5x4();
  const Rigid3 T = board_in_view(camera, board, 2.0, 0.9, 0.7, 0.4, {640.0, 360.0});
  Eigen::Array2d squares = Eigen::Array2d::Zero(), stated = Eigen::Array2d::Zero();
  const std::vector<Vector2d> truth = true_corners(camera, board, T);
  const BoardPictureOptions clean;
  const Image8 picture = draw_board(camera, board, T, clean);
  int count = 0;
  for (int trial = 0; trial < trials.count(); ++trial) {
    RandomStream random(8, "noise", trial);
    Image8 image = picture;
    for (std::uint8_t& pixel : image.pixels)
      pixel = static_cast<std::uint8_t>(std::lround(std::clamp(pixel + random.normal(0.0, 5.0), 0.0, 255.0)));
    for (const CornerObservation& corner : corners_of(detect_checkerboard(image, board))) {
      const Vector2d error = corner.pixel - truth[static_cast<std::size_t>(corner.id)];
      squares += error.array().square();
      stated += corner.covariance_px2.diagonal().array();
      ++count;
    }
  }
  ASSERT_EQ(count, trials.count() * 12);
  // 720 corners: 2.6 % scatter of the sigma; 12 % off and three of these are allowed.
  const Eigen::Array2d ratio = (squares / stated).sqrt();
  EXPECT_GT(ratio.minCoeff(), 0.88 - trials.tolerance(0.08));
  EXPECT_LT(ratio.maxCoeff(), 1.12 + trials.tolerance(0.08));
}

}  // namespace
}  // namespace rigproof
