// Boards in pictures as cameras and simulators of others make them. The whole table: bench_detection_foreign.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "foreign_picture.h"
#include "rigproof/calib/vision/checkerboard.h"
#include "rigproof/core/conventions.h"
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
