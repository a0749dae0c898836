#include "rigproof/validate/explanation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigproof/validate/format.h"
#include "synthetic.h"
#include "worded.h"

namespace rigproof {
namespace {

using namespace testing_support;
using testing::HasSubstr;

Budget tight_budget() {
  Budget budget;
  Vector6d limits;
  limits << 0.01, 0.01, 0.002, 0.002, 0.002, 0.002;
  budget.camera_to_robot = limits;
  budget.camera_to_camera = Vector6d::Constant(0.004);
  return budget;
}

Vector6d vector(double tx, double ty, double tz, double rz = 0.0) {
  Vector6d v;
  v << tx, ty, tz, 0.0, 0.0, rz;
  return v;
}

// That of data which allow errors of any size.
Comparison of_vague_data(Comparison comparison) {
  comparison.bound = DataBound();
  comparison.bound->camera_to_robot.fill(1.0);
  return comparison;
}

std::optional<Explanation> explain(const Truth& truth, const std::vector<Vector6d>& errors) {
  return explain_failures(of_vague_data(compare(make_result(truth, errors), truth)), tight_budget());
}

TEST(Explanation, OneCameraTooHigh) {
  const auto found = explain(
      make_truth(), {vector(0.004, -0.002, 0.0001), vector(0.004, -0.0025, 0.0001), vector(0.004, -0.0024, 0.0062)});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->cause.is("errors.one_axis"));
  EXPECT_EQ(found->axis, 2);
  EXPECT_THAT(found->cause.cameras, testing::ElementsAre("right"));
  EXPECT_NEAR(std::get<double>(found->cause.find("z_cm")->value), 0.62, 1e-9);
  EXPECT_EQ(worded(found->cause), "right is 0.62 cm too high");
  EXPECT_GT(found->explained, 1U);
}

TEST(Explanation, AllCamerasShareAShift) {
  const auto found = explain(make_truth(), {vector(0.02, 0, 0), vector(0.021, 0, 0), vector(0.0205, 0, 0)});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->cause.is("errors.shared_axis"));
  EXPECT_EQ(found->axis, 0);
  EXPECT_EQ(*found->cause.find("source"), FindingValue("source", "odometry"));
  EXPECT_THAT(worded(found->cause), HasSubstr("too far forward"));
}

// Two centimetres where the data allow two millimetres: no odometry can be that wrong.
TEST(Explanation, ABiasThatTheDataForbidIsNotBlamedOnOdometry) {
  const Truth truth = make_truth();
  Comparison comparison = compare(
      make_result(truth, {vector(0.02, 0, 0, 0.001), vector(0.021, 0, 0, 0.001), vector(0.022, 0, 0, 0.001)}), truth);
  EXPECT_EQ(worded(explain_failures(comparison, tight_budget())->cause),
            "all cameras share this error: they are 2.1 cm too far forward")
      << "what the data allow is not known";
  EXPECT_THAT(format_errors(comparison, nullptr, words::sentence_of), HasSubstr("The cameras share this error. "));
  comparison.bound = DataBound();
  comparison.bound->camera_to_robot[0] = 0.006;
  EXPECT_THAT(worded(explain_failures(comparison, tight_budget())->cause),
              HasSubstr("share this error (odometry): they"));
  comparison.bound->camera_to_robot[0] = 0.002;
  EXPECT_NEAR(std::get<double>(explain_failures(comparison, tight_budget())->cause.find("deviations")->value), 10.5,
              1e-9);
  EXPECT_EQ(worded(explain_failures(comparison, tight_budget())->cause),
            "all cameras share this error, far more than the data allow: they are 2.1 cm too far forward");
  EXPECT_THAT(format_errors(comparison, nullptr, words::sentence_of),
              HasSubstr("The cameras share this error, far more than the data allow. "));
  Result turned = exact_result(truth);
  for (EstimatedTransform& estimate : turned.camera_to_robot)
    estimate.T_parent_child = se3_exp(vector(0.02, 0.03, 0.0, 0.02)) * estimate.T_parent_child;
  Comparison whole = compare(turned, truth);
  whole.bound = DataBound();
  whole.bound->camera_to_robot[5] = 0.004;
  EXPECT_THAT(worded(explain_failures(whole, tight_budget())->cause), HasSubstr("far more than the data allow"));
}

TEST(Explanation, ASharedTiltComesFromTheGround) {
  Vector6d tilt = Vector6d::Zero();
  tilt[4] = 0.003;
  const auto found = explain(make_truth(), {tilt, tilt, tilt});
  ASSERT_TRUE(found);
  EXPECT_THAT(worded(found->cause), testing::AllOf(HasSubstr("(ground)"), HasSubstr("0.17 deg pitched too far down")));
}

TEST(Explanation, ScaleOfEverything) {
  const Truth truth = make_truth();
  Result result = exact_result(truth);
  for (EstimatedTransform& estimate : result.camera_to_robot) estimate.T_parent_child.translation *= 1.03;
  const auto found = explain_failures(compare(result, truth), tight_budget());
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->cause.is("errors.scale"));
  EXPECT_THAT(worded(found->cause), HasSubstr("3.0 % too long"));
}

TEST(Explanation, OneCameraWrongInSeveralWays) {
  const auto found = explain(make_truth(), {vector(0, 0, 0), vector(0.02, -0.03, 0.01, 0.01), vector(0, 0, 0)});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->cause.is("errors.one_camera"));
  EXPECT_THAT(worded(found->cause), testing::AllOf(HasSubstr("only center"), HasSubstr("3.0 cm too far right"),
                                                   HasSubstr("0.57 deg turned too far left")));
}

TEST(Explanation, TheRigTurnedAsOneBody) {
  const Truth truth = make_truth();
  Result result = exact_result(truth);
  Vector6d motion = vector(0.02, 0.03, 0.0, 0.02);
  for (EstimatedTransform& estimate : result.camera_to_robot)
    estimate.T_parent_child = se3_exp(motion) * estimate.T_parent_child;
  const auto found = explain_failures(of_vague_data(compare(result, truth)), tight_budget());
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->cause.is("errors.shared_motion"));
  EXPECT_EQ(*found->cause.find("source"), FindingValue("source", "odometry"));
  EXPECT_THAT(worded(found->cause), HasSubstr("odometry"));
}

TEST(Explanation, StatedPairsFollowTheirCamera) {
  const Truth truth = make_truth();
  Result result = make_result(truth, {vector(0, 0, 0), vector(0, 0, 0), vector(0, 0, 0.0062)});
  EstimatedTransform pair;
  pair.parent = "left";
  pair.child = "right";
  pair.T_parent_child = result.camera_to_robot[0].T_parent_child.inverse() * result.camera_to_robot[2].T_parent_child;
  result.camera_to_camera = {pair};
  const auto found = explain_failures(compare(result, truth), tight_budget());
  ASSERT_TRUE(found);
  EXPECT_EQ(worded(found->cause), "right is 0.62 cm too high");
}

TEST(Explanation, ThereMayBeNone) {
  const Truth truth = make_truth();
  EXPECT_FALSE(explain(truth, {vector(0, 0, 0), vector(0, 0, 0), vector(0, 0, 0)}));
  EXPECT_FALSE(explain(truth, {vector(0.03, 0, 0), vector(0, -0.04, 0), vector(0, 0, 0.02, 0.02)}));
  Result partial = make_result(truth, {vector(0.03, 0, 0), vector(0, 0, 0), vector(0, 0, 0)});
  partial.camera_to_robot.pop_back();
  EXPECT_FALSE(explain_failures(compare(partial, truth), tight_budget()));
}

}  // namespace
}  // namespace rigproof
