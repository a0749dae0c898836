#include "rigproof/validate/format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "rigproof/core/conventions.h"
#include "rigproof/validate/published.h"
#include "synthetic.h"
#include "worded.h"

namespace rigproof {
namespace {

using namespace testing_support;
using testing::HasSubstr;
using testing::Not;

Vector6d in_cm_deg(double tx, double ty, double tz, double rx, double ry, double rz) {
  Vector6d v;
  v << 0.01 * tx, 0.01 * ty, 0.01 * tz, deg_to_rad(rx), deg_to_rad(ry), deg_to_rad(rz);
  return v;
}

// The errors of the example in the design, with its sigmas.
Result shared_error_result(const Truth& truth) {
  Result result = make_result(
      truth, {in_cm_deg(.071, -.14, .002, .001, .0002, .017), in_cm_deg(.074, -.15, .001, .001, .0001, .017),
              in_cm_deg(.078, -.15, .003, .0002, -.0002, .018)});
  const Vector6d sigma = in_cm_deg(.09, .13, .003, .0011, .0012, .024);
  for (EstimatedTransform& estimate : result.camera_to_robot)
    estimate.covariance = Matrix6d(sigma.cwiseAbs2().asDiagonal());
  return result;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Format, ErrorsWithSigmas) {
  const Truth truth = make_truth();
  const Comparison comparison = compare(shared_error_result(truth), truth);
  EXPECT_EQ(format_errors(comparison, nullptr, words::sentence_of),
            "error +- stated sigma  tx ty tz [cm]         rx ry rz [deg]\n"
            " left    +.07+-.09  -.14+-.13  +.002+-.003   +.0010+-.0011  +.0002+-.0012  +.017+-.024\n"
            " center  +.07+-.09  -.15+-.13  +.001+-.003   +.0010+-.0011  +.0001+-.0012  +.017+-.024\n"
            " right   +.08+-.09  -.15+-.13  +.003+-.003   +.0002+-.0011  -.0002+-.0012  +.018+-.024\n"
            " The cameras share this error. Between cameras: worst .012 cm, .0013 deg.\n");
}

TEST(Format, ErrorsWithoutSigmasAndWithAGate) {
  const Truth truth = make_truth();
  const Result result =
      make_result(truth, {in_cm_deg(.41, -.22, .012, .004, -.003, .061), in_cm_deg(.39, -.25, .010, .004, -.002, .060),
                          in_cm_deg(.40, -.24, .621, .003, -.003, .062)});
  const Comparison comparison = compare(result, truth);
  Budget budget;
  budget.name = "ci.yaml";
  budget.camera_to_robot = in_cm_deg(1, 1, .2, .1, .1, .1);
  budget.camera_to_camera = in_cm_deg(.4, .4, .4, .1, .1, .1);
  const std::string text =
      format_validation(comparison, apply_budget(comparison, budget), budget, "theirs.yaml", words::sentence_of);
  const std::vector<std::string> lines = lines_of(text);
  ASSERT_EQ(lines.size(), 8U) << text;
  EXPECT_EQ(lines[0],
            "theirs.yaml against truth, budget ci.yaml (1 cm, 1 cm, 0.2 cm, 0.1 deg; between cameras 0.4 cm, 0.1 deg)");
  EXPECT_THAT(lines[1],
              testing::AllOf(testing::StartsWith("FAIL  "), HasSubstr("right tz; left-right, center-right vertical")));
  EXPECT_THAT(lines[2], HasSubstr("right is 0.62 cm too high"));
  EXPECT_THAT(lines[4], testing::EndsWith("ok"));
  EXPECT_THAT(lines[6], testing::EndsWith("FAIL tz"));
  EXPECT_THAT(lines[7], HasSubstr("Between cameras: worst"));
}

TEST(Format, TheSameRunToldByOthersStandsBeside) {
  const Truth truth = make_truth();
  Result theirs = make_result(truth, {Vector6d::Zero(), Vector6d::Zero(), in_cm_deg(0, 0, .63, 0, 0, 0)});
  theirs.method = "theirs";
  Result ml = shared_error_result(truth),
         joint = make_result(truth, {Vector6d::Zero(), Vector6d::Zero(), in_cm_deg(0, 0, .012, 0, 0, 0)});
  ml.method = "ml";
  joint.method = "joint_memroc";
  Budget budget;
  budget.camera_to_robot = in_cm_deg(1, 1, .2, .1, .1, .1);
  const std::vector<Comparison> all = {compare(theirs, truth), compare(ml, truth), compare(joint, truth)};
  EXPECT_EQ(format_same_run(all[0], budget, all),
            "  The data allow .0030 cm (1 sigma of ml). Same run: ml +.0030, joint_memroc +.012 cm.\n");
  EXPECT_EQ(format_same_run(all[1], budget, all), "");
  EXPECT_EQ(format_same_run(all[0], budget, {}), "");
}

TEST(Format, VerdictTellsWhetherSigmasAreHonest) {
  const Truth truth = make_truth();
  Result result = shared_error_result(truth);
  const auto text_of = [&] {
    const Comparison comparison = compare(result, truth);
    return format_verdict(comparison, apply_budget(comparison, default_budget()), default_budget());
  };
  EXPECT_THAT(text_of(), testing::StartsWith("PASS  18/18 within 4 sigma; sigmas"));
  for (EstimatedTransform& estimate : result.camera_to_robot) *estimate.covariance *= 1e4;
  EXPECT_THAT(text_of(), HasSubstr("sigmas too large: NEES"));
  for (EstimatedTransform& estimate : result.camera_to_robot) *estimate.covariance *= 1e-6;
  EXPECT_THAT(text_of(), testing::AllOf(testing::StartsWith("FAIL"), HasSubstr("sigmas too small: NEES")));
}

TEST(Format, JointNeesHasItsInterval) {
  Comparison comparison;
  comparison.nees = 16.9;
  comparison.nees_degrees_of_freedom = 18;
  EXPECT_EQ(format_nees(comparison), "sigmas honest: NEES 16.9 (95 %: 8.2-31.5)");
  EXPECT_FALSE(are_sigmas_too_small(comparison));
  comparison.nees = 31.6;
  EXPECT_TRUE(are_sigmas_too_small(comparison));
  comparison.nees = 0.1;
  EXPECT_FALSE(are_sigmas_too_small(comparison)) << "too large is not too small";
}

TEST(Format, NeesOfEachCameraIsJudgedByTheOneThatIsTooHigh) {
  Comparison comparison;
  EXPECT_EQ(format_nees(comparison), "");
  EXPECT_FALSE(are_sigmas_too_small(comparison));
  comparison.camera_nees = {{"left", 0.3}, {"right", 20.0}};
  EXPECT_EQ(format_nees(comparison), "sigmas too small: NEES of each camera left .3, right 20.0 (95 %: 1.2-14.4)");
  EXPECT_TRUE(are_sigmas_too_small(comparison));
  comparison.camera_nees = {{"left", 0.3}, {"right", 6.0}};
  EXPECT_EQ(format_nees(comparison), "sigmas too large: NEES of each camera left .3, right 6.0 (95 %: 1.2-14.4)");
  EXPECT_FALSE(are_sigmas_too_small(comparison));
}

TEST(Format, NeitherZerosNorTooManyDigits) {
  const Truth truth = make_truth();
  for (const double size : {1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6}) {
    RandomStream random(4, "digits", static_cast<std::int64_t>(1e3 * std::log10(size)));
    std::vector<Vector6d> errors(3);
    for (Vector6d& error : errors)
      for (double& value : error) value = size * random.normal();
    const std::string text = format_errors(compare(make_result(truth, errors), truth));
    EXPECT_THAT(text, Not(testing::ContainsRegex("[ +-]0*[.]0+[ \n]"))) << text;
    EXPECT_THAT(text, Not(testing::ContainsRegex("[0-9][0-9.][0-9.][0-9.][0-9.][0-9.][0-9.][0-9]"))) << text;
    EXPECT_THAT(text, Not(testing::ContainsRegex(" \n"))) << text;
  }
}

TEST(Format, RefusedAndPartialResultsAreReadable) {
  const Truth truth = make_truth();
  Result refused;
  refused.method = "ml";
  refused.status = ResultStatus::kRefused;
  refused.reasons = {stated("All motions turn about one centre.", Severity::kRefusal)};
  const Comparison comparison = compare(refused, truth);
  EXPECT_EQ(format_errors(comparison, nullptr, words::sentence_of),
            "REFUSED\n All motions turn about one centre.\n No pose of left, center, right.\n");
  Result partial = shared_error_result(truth);
  partial.status = ResultStatus::kPartial;
  for (EstimatedTransform& estimate : partial.camera_to_robot)
    estimate.observable = {false, false, true, true, true, false};
  EXPECT_THAT(format_errors(compare(partial, truth)), HasSubstr("refused"));
}

TEST(Format, SuspicionSaysBothErrors) {
  const Truth truth = make_truth();
  Result result = shared_error_result(truth);
  for (EstimatedTransform& estimate : result.camera_to_robot) {
    estimate.T_parent_child = estimate.T_parent_child.inverse();
    estimate.covariance.reset();
  }
  const std::string text = format_suspicion(compare(result, truth), words::sentence_of);
  EXPECT_THAT(text, testing::StartsWith("CONVENTION  matches the truth only when inverted"));
  EXPECT_THAT(text, HasSubstr("corrected: "));
}

TEST(Format, PaperStandsBeside) {
  const Truth truth = make_truth();
  const std::string text = format_paper(compare(shared_error_result(truth), truth));
  EXPECT_THAT(text, HasSubstr("MEMROC"));
  EXPECT_THAT(text, HasSubstr("as roll, pitch, yaw"));
  EXPECT_THAT(text, testing::ContainsRegex("Joint-MEMROC +[.]66 +[.]16 +[.]14 +[.]14 +[.]14 +[.]15\n"));
  EXPECT_THAT(text, testing::ContainsRegex("SensorX2Car +- +- +- +[.]26 +[.]82 +1[.]22\n"));
}

TEST(Published, MeanAbsoluteErrorIsInCentimetresAndDegrees) {
  const Truth truth = make_truth();
  const Comparison comparison = compare(
      make_result(truth, {in_cm_deg(1, 0, 0, 0, 0, .3), in_cm_deg(-2, 0, 0, 0, 0, 0), in_cm_deg(0, 3, 0, 0, 0, 0)}),
      truth);
  const auto mean = mean_absolute_error(comparison.camera_to_robot, false);
  ASSERT_TRUE(mean);
  EXPECT_NEAR((*mean)[0], 1.0, 1e-9);
  EXPECT_NEAR((*mean)[1], 1.0, 1e-9);
  EXPECT_NEAR((*mean)[5], 0.1, 1e-9);
  // A turn about the robot's z axis is a change of yaw alone.
  EXPECT_NEAR((*mean_absolute_error(comparison.camera_to_robot, true))[5], 0.1, 1e-9);
}

}  // namespace
}  // namespace rigproof
