#include "rigproof/validate/budget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "error_text.h"
#include "paths.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/validate/format.h"
#include "synthetic.h"
#include "temp_folder.h"
#include "worded.h"

namespace rigproof {
namespace {

using namespace testing_support;
using testing::HasSubstr;

class BudgetTest : public testing::Test {
 protected:
  Budget load(const std::string& text) {
    write_file_atomically(folder_ / "ci.yaml", text);
    return load_budget(folder_ / "ci.yaml");
  }
  std::string message_of(const std::string& text) {
    return error_text([&] { load(text); });
  }

  const TempFolder folder_;
};

TEST_F(BudgetTest, ReadsUnitsAndPrecedence) {
  const Budget budget = load(
      "camera_to_robot: {tx_cm: 1, distance_cm: 2, angle_deg: 0.1, rz_deg: 0.5}\n"
      "camera_to_camera: {tz_cm: 0.3}\nmax_z: 5\n");
  EXPECT_NEAR((*budget.camera_to_robot)[0], 0.01, 1e-15);
  EXPECT_NEAR((*budget.camera_to_robot)[1], 0.02, 1e-15);
  EXPECT_NEAR((*budget.camera_to_robot)[3], deg_to_rad(0.1), 1e-15);
  EXPECT_NEAR((*budget.camera_to_robot)[5], deg_to_rad(0.5), 1e-15);
  EXPECT_TRUE(std::isinf((*budget.camera_to_camera)[0]));
  EXPECT_NEAR((*budget.camera_to_camera)[2], 0.003, 1e-15);
  EXPECT_EQ(budget.max_z, 5.0);
  EXPECT_EQ(budget.name, "ci.yaml");
}

TEST_F(BudgetTest, ShippedBudgetsRead) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_path("config/budgets"))) {
    EXPECT_NO_THROW(load_budget(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 3U);
}

TEST_F(BudgetTest, BadFilesSayWhatIsWrong) {
  EXPECT_THAT(message_of("camera_to_robot: {tx_mm: 1}\n"), testing::AllOf(HasSubstr("ci.yaml:1"), HasSubstr("tx_cm")));
  EXPECT_THAT(message_of("max_z: -1\n"), HasSubstr("max_z"));
  EXPECT_THAT(message_of("max_z: many\n"), HasSubstr("many"));
  EXPECT_THAT(message_of("camera_to_robot: 3\n"), HasSubstr("camera_to_robot"));
  EXPECT_THAT(message_of(""), HasSubstr("at least one limit"));
  EXPECT_THAT(message_of("camera_to_robot: {tx_cm: .nan}\n"), HasSubstr("tx_cm"));
  EXPECT_THROW(load_budget(folder_ / "absent.yaml"), Error);
}

TEST_F(BudgetTest, DescribesItself) {
  EXPECT_EQ(describe(default_budget()), "4 sigma");
  EXPECT_EQ(describe(load("camera_to_robot: {tx_cm: 1, ty_cm: 1, tz_cm: 0.2, angle_deg: 0.1}\n")),
            "1 cm, 1 cm, 0.2 cm, 0.1 deg");
  EXPECT_EQ(describe(load("camera_to_camera: {distance_cm: 0.5}\nmax_z: 4\n")), "between cameras 0.5 cm; 4 sigma");
}

Vector6d along(int axis, double value) {
  Vector6d error = Vector6d::Zero();
  error[axis] = value;
  return error;
}

TEST(Gate, ChecksEveryAxisOnce) {
  const Truth truth = make_truth();
  Result result = exact_result(truth);
  Budget budget;
  budget.camera_to_robot = Vector6d::Constant(0.01);
  budget.camera_to_camera = Vector6d::Constant(0.01);
  const Gate gate = apply_budget(compare(result, truth), budget);
  EXPECT_EQ(gate.checks.size(), 36U);
  EXPECT_TRUE(gate.passed());
  EXPECT_EQ(gate.checks[2].name, "left in robot: tz");
  EXPECT_EQ(gate.checks[18].name, "left-center: tx");
}

TEST(Gate, NamesWhatFails) {
  const Truth truth = make_truth();
  const Result result = make_result(truth, {along(2, 0.0063), Vector6d::Zero(), Vector6d::Zero()});
  Budget budget;
  budget.camera_to_robot = Vector6d::Constant(0.002);
  const Gate gate = apply_budget(compare(result, truth), budget);
  ASSERT_EQ(gate.failures(), 1U);
  EXPECT_FALSE(gate.checks[2].passed);
  EXPECT_EQ(gate.checks[2].message(), "0.63 cm, allowed 0.2 cm");
}

TEST(Gate, MissingCamerasAndRefusedDegreesFail) {
  const Truth truth = make_truth();
  Result result = exact_result(truth);
  result.camera_to_robot.pop_back();
  result.camera_to_robot[0].observable[5] = false;
  Budget budget;
  budget.camera_to_robot = Vector6d::Constant(0.002);
  const Gate gate = apply_budget(compare(result, truth), budget);
  ASSERT_EQ(gate.failures(), 2U);
  EXPECT_EQ(gate.checks[0].name, "right in robot: pose");
  EXPECT_EQ(gate.checks[6].name, "left in robot: rz");
  EXPECT_THAT(gate.checks[6].message(words::sentence_of), HasSubstr("do not determine"));
}

TEST(Gate, CameraToCameraMethodsOweNoPoseInTheRobotUnlessItIsLimited) {
  const Truth truth = make_truth();
  Result result = exact_result(truth);
  result.camera_to_robot.clear();
  const Rigid3 &left = truth.cameras[0].T_robot_camera, &center = truth.cameras[1].T_robot_camera;
  result.camera_to_camera = {
      {truth.cameras[0].name, truth.cameras[1].name, left.inverse() * center, Matrix6d(1e-6 * Matrix6d::Identity())}};
  const Gate gate = apply_budget(compare(result, truth), default_budget());
  EXPECT_TRUE(gate.passed());
  EXPECT_EQ(gate.checks.size(), 6U);
  EXPECT_EQ(gate.notes, std::vector<Finding>{Finding("gate.pairs_only")});
  Budget limits_robot = default_budget();
  limits_robot.camera_to_robot = Vector6d::Constant(0.002);
  EXPECT_EQ(apply_budget(compare(result, truth), limits_robot).failures(), truth.cameras.size());
  result.status = ResultStatus::kPartial;
  EXPECT_FALSE(apply_budget(compare(result, truth), default_budget()).passed());
}

TEST(Gate, SigmasGateOnlyWhatStatesThem) {
  const Truth truth = make_truth();
  Result result = make_result(truth, {along(0, 0.0041), Vector6d::Zero(), Vector6d::Zero()});
  result.camera_to_robot[0].covariance = Matrix6d(1e-6 * Matrix6d::Identity());
  const Gate gate = apply_budget(compare(result, truth), default_budget());
  EXPECT_EQ(gate.checks.size(), 6U);
  ASSERT_EQ(gate.failures(), 1U);
  EXPECT_EQ(gate.checks[0].message(), "4.1 sigma, allowed 4 sigma");
}

TEST(Gate, SuspicionsFailWhereSomebodyAskedForAGate) {
  const Truth truth = make_truth();
  Result result = make_result(truth, {along(0, 0.001), Vector6d::Zero(), Vector6d::Zero()});
  result.camera_to_robot[0].covariance = Matrix6d(1e-6 * Matrix6d::Identity());
  result.notes = {Finding("odometry.noise"), Finding("prior.strained").of("left")};
  TempFolder folder;
  folder.write("limits.yaml", "max_z: 4\n");
  EXPECT_TRUE(load_budget(folder / "limits.yaml").nothing_suspected);
  EXPECT_FALSE(default_budget().nothing_suspected);
  Gate gate = apply_budget(compare(result, truth), default_budget());
  EXPECT_TRUE(gate.passed());
  add_suspicions(result.notes, &gate);
  ASSERT_EQ(gate.failures(), 1U);
  EXPECT_EQ(gate.checks.back().subject, "left");
  EXPECT_EQ(gate.checks.back().reason->code, "prior.strained");
  EXPECT_THAT(format_verdict(compare(result, truth), gate, default_budget()), HasSubstr("checks: left suspected"));
}

TEST(Gate, NothingCheckedIsNotPassed) {
  const Truth truth = make_truth();
  const Gate gate = apply_budget(compare(exact_result(truth), truth), default_budget());
  EXPECT_TRUE(gate.checks.empty());
  EXPECT_FALSE(gate.passed());
  EXPECT_FALSE(gate.notes.empty());
}

}  // namespace
}  // namespace rigproof
