#include "rigproof/validate/bound.h"

#include <gtest/gtest.h>

#include "rigproof/geometric/geometric.h"

namespace rigproof {
namespace {

GeometricRun run_of(int stops) {
  GeometricConfig config;
  config.stops = stops;
  return draw_geometric_run(config);
}

TEST(DataBound, ShrinksWithTheRootOfTheStops) {
  const GeometricRun few = run_of(25), many = run_of(100);
  const auto of_few = data_bound(few.observations, few.truth), of_many = data_bound(many.observations, many.truth);
  ASSERT_TRUE(of_few && of_many);
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const double ratio = of_few->camera_to_robot[axis].value() / of_many->camera_to_robot[axis].value();
    EXPECT_NEAR(ratio, 2.0, 0.5) << axis;  // other stops see the board otherwise: a quarter
    EXPECT_LT(of_many->camera_to_camera[axis].value(), 0.01);
  }
}

TEST(DataBound, SaysNothingAboutTheHeightWithoutGround) {
  GeometricConfig config;
  config.stops = 20;
  config.ground = false;
  const GeometricRun run = draw_geometric_run(config);
  const auto bound = data_bound(run.observations, run.truth);
  ASSERT_TRUE(bound);
  EXPECT_FALSE(bound->camera_to_robot[2].has_value());
  EXPECT_TRUE(bound->camera_to_robot[0].has_value());
  EXPECT_NE(format_bound(*bound).find("tz - cm"), std::string::npos);
}

TEST(DataBound, NeedsTheTruthOfTheseObservations) {
  GeometricRun run = run_of(5);
  run.truth.cameras[1].name = "another";
  EXPECT_FALSE(data_bound(run.observations, run.truth));
}

TEST(DataBound, IsOneSentence) {
  DataBound bound;
  bound.camera_to_robot = {0.0009, 0.0013, 2.6e-5, 1.4e-5, 1.6e-5, 4.2e-4};
  bound.camera_to_camera = {1e-4, 1e-4, 1.3e-4, 2.3e-5, 1e-5, 1e-5};
  EXPECT_EQ(format_bound(bound),
            "The data allow tx .09 ty .13 tz .0026 cm, rx .0008 ry .0009 rz .024 deg (1 sigma); between cameras .013 "
            "cm, .0013 deg.\n");
}

}  // namespace
}  // namespace rigproof
