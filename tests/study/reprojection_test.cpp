// The picture of what is left after calibration goes with the lenses and the board that the poses go with.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "../validate/synthetic.h"
#include "inspect_reprojection.h"
#include "rigproof/calib/estimate/board_shape.h"

namespace rigproof {
namespace {

using namespace testing_support;
using inspect_detail::carried_over;
using inspect_detail::CarriedOver;

double rms_px(const CarriedOver& carried) {
  double square = 0.0;
  for (const inspect_detail::Residual& residual : carried.residuals) square += residual.difference.squaredNorm();
  return std::sqrt(square / (2.0 * static_cast<double>(carried.residuals.size())));
}

// Lenses one percent and a board ten percent off what was stated, and a result that found both.
struct Reprojection : testing::Test {
  Reprojection() : truth(make_truth(12)), observations(make_observations(truth, 0.02)), result(exact_result(truth)) {
    for (std::size_t i = 0; i < truth.cameras.size(); ++i) {
      result.lenses.push_back({truth.cameras[i].name, truth.cameras[i].camera});
      observations.cameras[i].camera.fx_px *= 1.01;
      observations.cameras[i].camera.fy_px *= 1.01;
    }
    EstimatedQuantity size;
    size.name = "board_size_percent";
    size.value = 10.0;
    result.also_estimated.push_back(size);
    observations.board.square_m /= 1.1;
  }
  const Truth truth;
  Observations observations;
  Result result;
};

TEST_F(Reprojection, GoesWithTheEstimatedLensesAndBoard) {
  const CarriedOver carried = carried_over(observations, result, 1);
  EXPECT_GT(carried.from_same_stop, 0U);
  ASSERT_GT(carried.residuals.size(), 100U);
  EXPECT_LT(rms_px(carried), 0.3);
}

TEST_F(Reprojection, ShowsLensesThatTheResultDidNotFind) {
  result.lenses.clear();
  EXPECT_GT(rms_px(carried_over(observations, result, 1)), 1.0);
}

TEST_F(Reprojection, ShowsABoardThatTheResultDidNotFind) {
  result.also_estimated.clear();
  EXPECT_GT(rms_px(carried_over(observations, result, 1)), 1.0);
}

TEST_F(Reprojection, IsEmptyForACameraWithoutAPose) {
  result.camera_to_robot.clear();
  EXPECT_TRUE(carried_over(observations, result, 1).residuals.empty());
}

// Detected against fitted corners: what a recording without truth can tell of its noise.
double fitted_over_expected(const Reprojection& r, std::size_t camera) {
  const inspect_detail::CornerFit fit = inspect_detail::fit_corners(r.observations, r.result);
  const inspect_detail::ResidualPicture picture = inspect_detail::fitted_corners(r.observations, r.result, fit, camera);
  EXPECT_GT(picture.residuals.size(), 50U);
  EXPECT_LT(picture.stated_sigma_px, 0.02) << "the fit takes a part of the noise";
  return picture.rms_over_stated();
}

TEST_F(Reprojection, AGoodFitLeavesWhatTheStatedNoiseLetsExpect) {
  for (std::size_t camera = 0; camera < truth.cameras.size(); ++camera)
    EXPECT_NEAR(fitted_over_expected(*this, camera), 1.0, 0.1) << camera;
}

TEST_F(Reprojection, NoiseThatIsTwiceAsLargeAsStatedShowsInTheRatio) {
  for (BoardView& view : observations.board_views)
    for (CornerObservation& corner : view.corners) corner.covariance_px2 /= 4.0;
  for (std::size_t camera = 0; camera < truth.cameras.size(); ++camera)
    EXPECT_NEAR(fitted_over_expected(*this, camera), 2.0, 0.2) << camera;
}

// Paper bows, and printers stretch one side more than the other.
TEST_F(Reprojection, ABoardThatTheResultFoundBentLeavesNoMoreThanAFlatOne) {
  const Eigen::Vector4d shape(0.0, 0.003, 0.001, 0.0007);
  Board flat = observations.board;
  flat.square_m *= 1.1;
  for (BoardView& view : observations.board_views) {
    const TrueCamera& camera = truth.cameras[static_cast<std::size_t>(view.camera)];
    const Rigid3 T_camera_board =
        (truth.stops[static_cast<std::size_t>(view.stop)].T_world_robot * camera.T_robot_camera).inverse() *
        truth.T_world_board;
    for (CornerObservation& corner : view.corners) {
      const Eigen::Vector3d p = flat.corner(corner.id);
      Eigen::Vector2d stated, bent;
      ASSERT_TRUE(camera.camera.project(T_camera_board * p, &stated));
      ASSERT_TRUE(camera.camera.project(T_camera_board * ml::corner_of_board(flat, shape, p).point, &bent));
      corner.pixel += bent - stated;
    }
  }
  EXPECT_GT(fitted_over_expected(*this, 0), 1.4) << "as flat";
  const double carried_flat_px = rms_px(carried_over(observations, result, 1));
  for (const auto& [name, value] :
       {std::pair{"board_ratio_percent", 100.0 * shape[1]}, std::pair{"board_bow_x_mm", 1000.0 * shape[2]},
        std::pair{"board_bow_y_mm", 1000.0 * shape[3]}}) {
    EstimatedQuantity& quantity = result.also_estimated.emplace_back();
    quantity.name = name;
    quantity.value = value;
  }
  for (std::size_t camera = 0; camera < truth.cameras.size(); ++camera)
    EXPECT_NEAR(fitted_over_expected(*this, camera), 1.0, 0.1) << camera;
  const double carried_px = rms_px(carried_over(observations, result, 1));
  EXPECT_LT(carried_px, 0.3) << "as flat " << carried_flat_px;
  EXPECT_GT(carried_flat_px, 1.5 * carried_px);
}

TEST_F(Reprojection, AWrongPoseOrBoardShowsInTheRatio) {
  result.also_estimated.clear();
  EXPECT_GT(fitted_over_expected(*this, 0), 5.0) << "the board's size was found and is needed";
  result = exact_result(truth);
  result.camera_to_robot[2].T_parent_child.translation.z() += 0.01;
  EXPECT_GT(fitted_over_expected(*this, 2), 5.0);
}

}  // namespace
}  // namespace rigproof
