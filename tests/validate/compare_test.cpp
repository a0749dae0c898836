#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "pose_near.h"
#include "rigproof/core/error.h"
#include "rigproof/validate/body_angles.h"
#include "rigproof/validate/statistics.h"
#include "rigproof/validate/validate.h"
#include "synthetic.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using namespace testing_support;

// Errors pass through a few products of poses of size 1: 1e-12 is some thousand roundings.
constexpr double kRounding = 1e-12;

Vector6d vector(double tx, double ty, double tz, double rx, double ry, double rz) {
  Vector6d v;
  v << tx, ty, tz, rx, ry, rz;
  return v;
}

std::vector<Vector6d> three_errors() {
  return {vector(0.01, -0.02, 0.003, 0.001, -0.002, 0.004), vector(-0.005, 0.001, 0.0, 0.02, 0.01, -0.03),
          vector(0.1, 0.2, 0.3, -0.1, 0.2, 0.3)};
}

TEST(Compare, RecoversKnownErrors) {
  const Truth truth = make_truth();
  const std::vector<Vector6d> errors = three_errors();
  const Comparison comparison = compare(make_result(truth, errors), truth);
  ASSERT_EQ(comparison.camera_to_robot.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(comparison.camera_to_robot[i].child, truth.cameras[i].name);
    EXPECT_LT((comparison.camera_to_robot[i].error - errors[i]).norm(), kRounding);
  }
  EXPECT_TRUE(comparison.missing_cameras.empty());
  EXPECT_FALSE(comparison.suspicion);
}

TEST(Compare, ComposesCameraToCamera) {
  const Truth truth = make_truth();
  const Result result = make_result(truth, three_errors());
  const Comparison comparison = compare(result, truth);
  ASSERT_EQ(comparison.camera_to_camera.size(), 3U);
  EXPECT_EQ(comparison.camera_to_camera[1].name(), "left-right");
  const Rigid3 T_true = truth.cameras[0].T_robot_camera.inverse() * truth.cameras[2].T_robot_camera;
  const Rigid3 T_estimate =
      result.camera_to_robot[0].T_parent_child.inverse() * result.camera_to_robot[2].T_parent_child;
  EXPECT_LT((comparison.camera_to_camera[1].error - transform_error(T_estimate, T_true)).norm(), kRounding);
  EXPECT_FALSE(comparison.camera_to_camera[1].sigma);
}

TEST(Compare, PrefersStatedCameraToCamera) {
  const Truth truth = make_truth();
  Result result = exact_result(truth);
  const Vector6d error = vector(0.001, 0.002, -0.003, 0.01, 0.0, 0.02);
  const Rigid3 T_true = truth.cameras[0].T_robot_camera.inverse() * truth.cameras[1].T_robot_camera;
  EstimatedTransform pair;
  pair.parent = "left";
  pair.child = "center";
  pair.T_parent_child = apply_transform_error(T_true, error);
  pair.covariance = Matrix6d(1e-6 * Matrix6d::Identity());
  result.camera_to_camera = {pair};
  const Comparison comparison = compare(result, truth);
  EXPECT_LT((comparison.camera_to_camera[0].error - error).norm(), kRounding);
  EXPECT_NEAR(*comparison.camera_to_camera[0].z(0), 1.0, 1e-9);
}

TEST(Compare, ReversedStatementsAreTheSameStatements) {
  const Truth truth = make_truth();
  RandomStream random(3, "reversed");
  Result forward = make_result(truth, three_errors());
  for (EstimatedTransform& estimate : forward.camera_to_robot)
    estimate.covariance = Matrix6d(random_covariance(Vector6d::Constant(1e-3), random));
  Result reversed = forward;
  for (EstimatedTransform& estimate : reversed.camera_to_robot) {
    const Matrix6d J = inverse_error_jacobian(estimate.T_parent_child);
    estimate.covariance = Matrix6d(J * *estimate.covariance * J.transpose());
    estimate.T_parent_child = estimate.T_parent_child.inverse();
    std::swap(estimate.parent, estimate.child);
  }
  const Comparison a = compare(forward, truth), b = compare(reversed, truth);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((a.camera_to_robot[i].error - b.camera_to_robot[i].error).norm(), kRounding);
    EXPECT_LT((*a.camera_to_robot[i].sigma - *b.camera_to_robot[i].sigma).norm(), kRounding);
    EXPECT_NEAR(a.camera_nees[i].nees, b.camera_nees[i].nees, 1e-6 * a.camera_nees[i].nees);
  }
}

TEST(Compare, ReversedPairsAndForeignOrderAreUnderstood) {
  const Truth truth = make_truth();
  Result result = exact_result(truth);
  std::swap(result.camera_to_robot[0], result.camera_to_robot[2]);
  EstimatedTransform pair;
  pair.parent = "right";
  pair.child = "left";
  pair.T_parent_child = truth.cameras[2].T_robot_camera.inverse() * truth.cameras[0].T_robot_camera;
  result.camera_to_camera = {pair};
  const Comparison comparison = compare(result, truth);
  EXPECT_EQ(comparison.camera_to_robot[0].child, "left");
  EXPECT_EQ(comparison.camera_to_camera[1].name(), "left-right");
  EXPECT_LT(comparison.camera_to_camera[1].error.norm(), kRounding);
}

TEST(Compare, UnknownNamesAreNamed) {
  const Truth truth = make_truth();
  Result result = exact_result(truth);
  result.camera_to_robot[1].child = "centre";
  EXPECT_THAT(
      error_text([&] { compare(result, truth, "theirs.yaml"); }),
      testing::AllOf(testing::StartsWith("theirs.yaml: base_footprint -> centre: "),
                     testing::HasSubstr("left, center, right"), testing::HasSubstr("did you mean \"center\"?")));
  result = exact_result(truth);
  result.camera_to_robot[1].parent = "base_link";
  EXPECT_THROW(compare(result, truth), Error);
  result = exact_result(truth);
  result.camera_to_robot.push_back(result.camera_to_robot[0]);
  EXPECT_THROW(compare(result, truth), Error);
}

TEST(Compare, MissingCamerasAreToldAndTheRestIsCompared) {
  const Truth truth = make_truth();
  Result result = exact_result(truth);
  result.camera_to_robot.erase(result.camera_to_robot.begin() + 1);
  const Comparison comparison = compare(result, truth);
  EXPECT_THAT(comparison.missing_cameras, testing::ElementsAre("center"));
  EXPECT_EQ(comparison.camera_to_camera.size(), 1U);
}

TEST(Compare, UnobservableDegreesCountNeitherAsErrorNorAsZ) {
  const Truth truth = make_truth();
  Result result = exact_result(truth);
  EstimatedTransform& left = result.camera_to_robot[0];
  // x, y and yaw unknown: another yaw about the robot's z axis, another place, roll and pitch right.
  left.T_parent_child = Rigid3(rotation_z(1.2) * left.T_parent_child.rotation, Eigen::Vector3d(5.0, 6.0, 0.62));
  left.observable = {false, false, true, true, true, false};
  left.covariance = Matrix6d(1e-6 * Matrix6d::Identity());
  const Comparison comparison = compare(result, truth);
  EXPECT_LT(comparison.camera_to_robot[0].error.norm(), kRounding);
  EXPECT_FALSE(comparison.camera_to_robot[0].z(0));
  EXPECT_TRUE(comparison.camera_to_robot[0].z(2));
  // Pairs with that camera cannot be composed, and it has no NEES of six degrees.
  ASSERT_EQ(comparison.camera_to_camera.size(), 1U);
  EXPECT_EQ(comparison.camera_to_camera[0].name(), "center-right");
  EXPECT_TRUE(comparison.camera_nees.empty());
}

// Of a camera without a heading roll and pitch are known about its own axes, whichever way it was estimated to look.
TEST(Compare, TiltOfACameraWithoutAHeadingIsJudgedInItsOwnAxes) {
  const Truth truth = make_truth();
  const Rigid3& T_true = truth.cameras[0].T_robot_camera;
  const double true_yaw_rad = roll_pitch_yaw(T_true.rotation * optical_from_body()).z();
  Vector6d in_heading = vector(0.0, 0.0, 0.001, 0.004, 0.0002, 0.0);
  Vector6d sigma = vector(1.0, 1.0, 0.001, 0.004, 0.0002, 1.0);
  for (const double wrong_yaw_rad : {0.0, 1.2, -2.5}) {
    Vector6d error = in_heading;
    error.tail<3>() = rotation_z(true_yaw_rad) * Eigen::Vector3d(in_heading.tail<3>());
    Result result = exact_result(truth);
    EstimatedTransform& left = result.camera_to_robot[0];
    left.T_parent_child = apply_transform_error(T_true, error);
    left.T_parent_child.rotation = rotation_z(wrong_yaw_rad) * left.T_parent_child.rotation;
    left.observable = {false, false, true, true, true, false};
    Matrix6d turn = Matrix6d::Identity();
    turn.bottomRightCorner<3, 3>() = rotation_z(true_yaw_rad + wrong_yaw_rad).toRotationMatrix();
    left.covariance = turn * sigma.cwiseAbs2().asDiagonal() * turn.transpose();
    const auto expect_one_sigma = [&](const Result& judged) {
      const TransformError of_left = compare(judged, truth).camera_to_robot[0];
      for (const int axis : {2, 3, 4}) EXPECT_NEAR(of_left.z(axis).value(), 1.0, 1e-2) << axis;
    };
    expect_one_sigma(result);
    const TempFolder folder;
    result.status = ResultStatus::kPartial;
    save_result(result, folder / "left.yaml");
    expect_one_sigma(load_result(folder / "left.yaml"));
  }
}

// Draws all cameras from one joint covariance and compares.
class JointDraws {
 public:
  JointDraws() : truth_(make_truth()), random_(11, "joint") {
    Eigen::VectorXd sigmas(18);
    for (Eigen::Index i = 0; i < 18; ++i) sigmas[i] = i % 6 < 3 ? 2e-3 : 1e-3;
    covariance_ = random_covariance(sigmas, random_);
  }

  Comparison next() {
    const Eigen::VectorXd e = draw(covariance_, random_);
    Result result = make_result(truth_, {e.segment<6>(0), e.segment<6>(6), e.segment<6>(12)});
    result.joint_covariance = covariance_;
    for (Eigen::Index i = 0; i < 3; ++i)
      result.camera_to_robot[static_cast<std::size_t>(i)].covariance = Matrix6d(covariance_.block<6, 6>(6 * i, 6 * i));
    return compare(result, truth_);
  }

 private:
  Truth truth_;
  RandomStream random_;
  Eigen::MatrixXd covariance_;
};

TEST(Compare, NeesAndZScoresHaveTheirStatistics) {
  constexpr int kDraws = 1500;
  JointDraws draws;
  double joint = 0.0, single = 0.0, z_robot = 0.0, z_pairs = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const Comparison comparison = draws.next();
    ASSERT_EQ(comparison.nees_degrees_of_freedom, 18);
    joint += *comparison.nees / kDraws;
    for (const CameraNees& camera : comparison.camera_nees) single += camera.nees / (3.0 * kDraws);
    for (const TransformError& error : comparison.camera_to_robot)
      for (int axis = 0; axis < 6; ++axis) z_robot += *error.z(axis) * *error.z(axis) / (18.0 * kDraws);
    for (const TransformError& error : comparison.camera_to_camera)
      for (int axis = 0; axis < 6; ++axis) z_pairs += *error.z(axis) * *error.z(axis) / (18.0 * kDraws);
  }
  // Standard deviations of the means: sqrt(36 / 1500) = 0.155, sqrt(12 / 4500) = 0.052 and, for correlated axes, at
  // most sqrt(2 / 1500) = 0.037; four of each.
  EXPECT_NEAR(joint, 18.0, 0.62);
  EXPECT_NEAR(single, 6.0, 0.21);
  EXPECT_NEAR(z_robot, 1.0, 0.15);
  EXPECT_NEAR(z_pairs, 1.0, 0.15);
}

TEST(BodyAngles, RoundTripAndZeroForALevelForwardCamera) {
  RandomStream random(2, "angles");
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d angles(random.uniform(-3.1, 3.1), random.uniform(-1.5, 1.5), random.uniform(-3.1, 3.1));
    EXPECT_LT((roll_pitch_yaw(from_roll_pitch_yaw(angles)) - angles).norm(), 1e-10);  // up to 1/cos(1.5) roundings
  }
  const Rigid3 forward = looking({0.0, 0.0, 1.0}, 0.0, 0.0);
  EXPECT_LT((forward.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), kRounding);
  EXPECT_LT((forward.rotation * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitY()).norm(), kRounding);
}

TEST(BodyAngles, ErrorIsTheDifferenceOfAngles) {
  const Rigid3 a = looking({0.0, 0.0, 1.0}, 40.0, 12.0, 3.0), b = looking({0.0, 0.0, 1.0}, 39.0, 12.5, 2.8);
  const Eigen::Vector3d error = roll_pitch_yaw_error(a, b, false);
  EXPECT_NEAR(rad_to_deg(error.x()), 0.2, 1e-9);
  EXPECT_NEAR(rad_to_deg(error.y()), -0.5, 1e-9);
  EXPECT_NEAR(rad_to_deg(error.z()), 1.0, 1e-9);
}

}  // namespace
}  // namespace rigproof
