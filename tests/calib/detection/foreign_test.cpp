// Boards in pictures as cameras and simulators of others make them. The whole table: bench_detection_foreign.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "colour_filter.h"
#include "foreign_picture.h"
#include "rigproof/calib/vision/checkerboard.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

using Eigen::Vector2d;

TEST(ForeignPictures, EveryBoardAndCornerIsFoundAndItsErrorStatedOverTrials) {
  const Trials views(2, 12);
  for (const ForeignPicture& kind : foreign_pictures()) {
    double whitened = 0.0;
    int corners = 0;
    for (int i = 0; i < views.count(); ++i) {
      const ForeignView view = foreign_view(static_cast<std::uint64_t>(i));
      const Image8 image =
          draw_foreign(view.camera, view.board, view.T_camera_board, kind, static_cast<std::uint64_t>(i));
      const BoardDetection detection = detect_checkerboard(image, view.board);
      const auto* seen = std::get_if<std::vector<CornerObservation>>(&detection);
      if (seen == nullptr) {
        EXPECT_FALSE(opencv_finds(image, view.board))
            << kind.name << ", view " << i << ": " << worded(std::get<BoardNotFound>(detection).why);
        continue;
      }
      EXPECT_EQ(static_cast<int>(seen->size()), view.board.corner_count()) << kind.name << ", view " << i;
      const std::vector<Vector2d> truth = true_corners(view.camera, view.board, view.T_camera_board, kind.picture);
      for (const CornerObservation& corner : *seen) {
        const Vector2d error = corner.pixel - truth[static_cast<std::size_t>(corner.id)];
        whitened += 0.5 * error.dot(corner.covariance_px2.inverse() * error);
        ++corners;
      }
    }
    ASSERT_GT(corners, 0) << kind.name;
    // What repeats along an edge of an aliased picture is shared by its corners: the pooled figure scatters by a fifth
    // over twelve views.
    EXPECT_LT(std::sqrt(whitened / corners), 1.3 + views.tolerance(0.2)) << kind.name;
  }
}

// Edges along the pixels' rows and columns: what a colour filter does to them is the same all along them, and moves
// corners by .025 px, four times what is stated, where it is not known.
TEST(ForeignPictures, AColourFilterHardlyMovesEdgesAlongTheRows) {
  ForeignPicture kind;
  kind.picture.noise_sigma = 1.0;
  kind.demosaiced = true;
  const Camera camera = Camera::symmetric(1280, 720, 640.0);
  const Board board{"checkerboard", 6, 5, 0.1, {}, {}, {}};
  double squares = 0.0, whitened = 0.0;
  int corners = 0;
  for (std::uint64_t i = 0; i < 12; ++i) {
    RandomStream random(i, "upright boards");
    const Rigid3 T = board_in_view(camera, board, random.uniform(1.0, 2.5), 0.05, 0.3, random.uniform(-0.01, 0.01),
                                   {random.uniform(400.0, 880.0), random.uniform(250.0, 470.0)});
    const BoardDetection detection = detect_checkerboard(draw_foreign(camera, board, T, kind, i), board);
    const auto* seen = std::get_if<std::vector<CornerObservation>>(&detection);
    ASSERT_NE(seen, nullptr) << i;
    const std::vector<Vector2d> truth = true_corners(camera, board, T, kind.picture);
    for (const CornerObservation& corner : *seen) {
      const Vector2d error = corner.pixel - truth[static_cast<std::size_t>(corner.id)];
      squares += 0.5 * error.squaredNorm();
      whitened += 0.5 * error.dot(corner.covariance_px2.inverse() * error);
      ++corners;
    }
  }
  EXPECT_LT(std::sqrt(squares / corners), 0.012);
  EXPECT_LT(std::sqrt(whitened / corners), 1.8);
}

TEST(ColourFilter, IsFoundWhereItIsAndNotInNoise) {
  detection::ColourFilter shares;
  shares << -0.1, 0.1, -0.1, 0.1, -0.08, -0.08, 0.08, 0.08;
  RandomStream random(3, "colour filter");
  detection::FilterEquations with, without;
  for (int i = 0; i < 4000; ++i) {
    const int place = i % 4;
    const double along_x = random.uniform(-20.0, 20.0), along_y = random.uniform(-20.0, 20.0), noise = random.normal();
    for (auto* equations : {&with, &without}) {
      const double filtered = equations == &with ? along_x * shares[place] + along_y * shares[place + 4] : 0.0;
      const double error = -filtered - noise;  // model less image
      equations->normal(place, place) += along_x * along_x;
      equations->normal(place + 4, place + 4) += along_y * along_y;
      equations->normal(place, place + 4) += along_x * along_y;
      equations->normal(place + 4, place) += along_x * along_y;
      equations->gradient[place] += along_x * error;
      equations->gradient[place + 4] += along_y * error;
      equations->residual_squares += error * error;
      ++equations->pixels;
    }
  }
  const auto found = detection::solve_filter(with);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - shares).cwiseAbs().maxCoeff(), 0.02);
  EXPECT_FALSE(detection::solve_filter(without));
  EXPECT_FALSE(detection::solve_filter({}));
}

// Edges sharper than a pixel: the fit's blur is at its least, and the corner is measured all the same.
TEST(ForeignPictures, EdgesWithoutBlurAreMeasured) {
  ForeignPicture kind;
  kind.picture.psf_sigma_px = 0.0;
  kind.picture.point_samples = true;
  kind.picture.supersampling = 1;
  for (std::uint64_t i = 0; i < 3; ++i) {
    const ForeignView view = foreign_view(i);
    const BoardDetection detection =
        detect_checkerboard(draw_foreign(view.camera, view.board, view.T_camera_board, kind, i), view.board);
    const auto* seen = std::get_if<std::vector<CornerObservation>>(&detection);
    ASSERT_NE(seen, nullptr) << i;
    EXPECT_EQ(static_cast<int>(seen->size()), view.board.corner_count()) << i;
  }
}

TEST(ForeignPictures, APatternThatIsNoBoardIsNotCalledHidden) {
  const Camera camera = Camera::symmetric(1280, 720, 640.0);
  const Board board{"checkerboard", 5, 4, 0.1, {}, {}, {}}, strip{"checkerboard", 7, 2, 0.1, {}, {}, {}};
  const Rigid3 T = board_in_view(camera, strip, 1.5, 0.2, 0.4, 0.3, {640.0, 360.0});
  const BoardDetection detection = detect_checkerboard(draw_board(camera, strip, T), board);
  ASSERT_TRUE(std::holds_alternative<BoardNotFound>(detection));
  EXPECT_EQ(worded(std::get<BoardNotFound>(detection).why), "no board");
}

}  // namespace
}  // namespace rigproof
