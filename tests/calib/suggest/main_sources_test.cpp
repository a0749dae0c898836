// What the stated uncertainty mostly comes from, in lines that people read.
#include "rigproof/calib/plan/main_sources.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigproof/core/conventions.h"
#include "worded.h"

namespace rigproof {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// @param sigmas mm, deg
EstimatedTransform camera(const std::string& name, const Vector6d& sigmas,
                          const std::vector<EstimatedTransform::Share>& budget) {
  EstimatedTransform transform;
  transform.parent = "base";
  transform.child = name;
  Vector6d si = 0.001 * sigmas;
  for (int i = 3; i < 6; ++i) si[i] = deg_to_rad(sigmas[i]);
  transform.covariance = Matrix6d(si.cwiseAbs2().asDiagonal());
  transform.budget = budget;
  return transform;
}

TEST(MainSources, AreALineForAxesThatHaveThemAlikeWithSizesAndRemedy) {
  Vector6d worse, better;
  worse << 5.0, 5.0, 3.0, 0.02, 0.01, 0.5;
  better << 1.0, 1.0, 1.0, 0.01, 0.005, 0.1;
  const std::vector<EstimatedTransform::Share> budget = {{"turning point", {0.99, 0.99, 0.0, 0.0, 0.0, 0.0}},
                                                         {"board", {0.01, 0.01, 0.64, 0.0, 0.0, 0.0}},
                                                         {"corners", {0.0, 0.0, 0.36, 1.0, 1.0, 0.25}},
                                                         {"odometry", {0.0, 0.0, 0.0, 0.0, 0.0, 0.75}}};
  Result result;
  result.camera_to_robot = {camera("left", better, {{"odometry", {1.0, 1.0, 1.0, 1.0, 1.0, 1.0}}}),
                            camera("right", worse, budget)};
  EXPECT_THAT(
      worded(main_sources(result)),
      ElementsAre(testing::AllOf(StartsWith("x, y: 0.50 cm (right), of it 0.50 from where the robot turns: measure it"),
                                 HasSubstr("`rotation_centre_mm`")),
                  StartsWith("z: 0.30 cm (right), of it 0.24 from board: measure the side of ten squares"),
                  "roll, pitch: up to 0.020 deg (right), of it 0.020 from corners",
                  "yaw: 0.50 deg (right), of it 0.43 from odometry"));
}

TEST(MainSources, AreNoneOfAxesThatAreNotAnswered) {
  const std::vector<EstimatedTransform::Share> budget = {{"corners", {1.0, 1.0, 1.0, 1.0, 1.0, 1.0}}};
  Result result;
  result.camera_to_robot = {camera("left", Vector6d::Constant(2.0), budget)};
  result.camera_to_robot[0].observable = {false, false, true, false, false, false};
  EXPECT_THAT(worded(main_sources(result)), ElementsAre("z: 0.20 cm, of it 0.20 from corners"));
  result.camera_to_robot[0].covariance.reset();
  EXPECT_TRUE(main_sources(result).empty());
}

}  // namespace
}  // namespace rigproof
