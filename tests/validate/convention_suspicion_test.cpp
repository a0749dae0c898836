#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "rigproof/core/conventions.h"
#include "rigproof/validate/body_angles.h"
#include "rigproof/validate/validate.h"
#include "synthetic.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

using namespace testing_support;

struct Slip {
  const char* name;
  std::function<Rigid3(const Rigid3&)> apply;
  Finding convention;
  const char* words;  // that its sentence must hold
};

Rigid3 with_coefficients(const Rigid3& T, const std::array<int, 4>& order) {
  const Eigen::Vector4d q = T.rotation.coeffs();
  const auto at = [&](std::size_t i) { return q[order[i]]; };
  return Rigid3(Eigen::Quaterniond(at(3), at(0), at(1), at(2)), T.translation);
}

Rigid3 mirrored(const Rigid3& T, const Eigen::Vector3d& robot, const Eigen::Vector3d& camera) {
  const Eigen::Matrix3d R = robot.asDiagonal() * T.rotation_matrix() * camera.asDiagonal();
  return Rigid3(Eigen::Quaterniond(R), robot.cwiseProduct(T.translation));
}

std::vector<Slip> all_slips() {
  const auto optical_body = Rigid3(optical_from_body(), Eigen::Vector3d::Zero());
  return {
      {"inverse", [](const Rigid3& T) { return T.inverse(); }, Finding("convention.inverted"), "only when inverted"},
      {"body axes", [=](const Rigid3& T) { return T * optical_body; },
       Finding("convention.camera_axes", {{"frame", "body"}}), "body axes"},
      {"turned twice", [=](const Rigid3& T) { return T * optical_body.inverse(); }, Finding("convention.optical_twice"),
       "once too often"},
      {"robot optical", [=](const Rigid3& T) { return optical_body * T; },
       Finding("convention.robot_axes", {{"frame", "optical"}}), "robot's axes are optical"},
      {"OpenGL",
       [](const Rigid3& T) {
         return T * Rigid3(Eigen::Quaterniond(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX())), {0.0, 0.0, 0.0});
       },
       Finding("convention.camera_axes", {{"frame", "opengl"}}), "OpenGL"},
      {"north-east-down",
       [](const Rigid3& T) {
         return Rigid3(Eigen::Quaterniond(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX())), {0.0, 0.0, 0.0}) * T;
       },
       Finding("convention.robot_axes", {{"frame", "z_down"}}), "y right, z down"},
      {"millimetres", [](const Rigid3& T) { return Rigid3(T.rotation, 1e3 * T.translation); },
       Finding("convention.unit", {{"unit", "millimetres"}}), "millimetres"},
      {"centimetres", [](const Rigid3& T) { return Rigid3(T.rotation, 1e2 * T.translation); },
       Finding("convention.unit", {{"unit", "centimetres"}}), "centimetres"},
      {"thousandth", [](const Rigid3& T) { return Rigid3(T.rotation, 1e-3 * T.translation); },
       Finding("convention.divided", {{"by", 1000}}), "divided by 1000"},
      {"wxyz",
       [](const Rigid3& T) {
         return with_coefficients(T, {3, 0, 1, 2});  // written w x y z, read as x y z w
       },
       Finding("convention.quaternion_order"), "w x y z"},
      {"yzwx",
       [](const Rigid3& T) {
         return with_coefficients(T, {1, 2, 3, 0});
       },
       Finding("convention.quaternions_reordered"), "y z w x"},
      {"degrees", [](const Rigid3& T) { return Rigid3(so3_exp(rad_to_deg(1.0) * so3_log(T.rotation)), T.translation); },
       Finding("convention.degrees_as_radians"), "in degrees and read as radians"},
      {"degrees, roll pitch yaw",
       [](const Rigid3& T) {
         return Rigid3(from_roll_pitch_yaw(rad_to_deg(1.0) * roll_pitch_yaw(T.rotation)), T.translation);
       },
       Finding("convention.degrees_as_radians"), "in degrees and read as radians"},
      {"radians", [](const Rigid3& T) { return Rigid3(so3_exp(deg_to_rad(1.0) * so3_log(T.rotation)), T.translation); },
       Finding("convention.radians_as_degrees", {{"angles", "rotation_vector"}}), "in radians and read as degrees"},
      {"mirrored y",
       [](const Rigid3& T) {
         return mirrored(T, {1, -1, 1}, {-1, 1, 1});
       },
       Finding("convention.left_handed", {{"robot_axis", "y"}, {"camera_axis", "x"}}), "mirrored"},
      {"translation mirrored",
       [](const Rigid3& T) { return Rigid3(T.rotation, T.translation.cwiseProduct(Eigen::Vector3d(-1, 1, 1))); },
       Finding("convention.translations_mirrored", {{"axis", "x"}}), "x axis of the translations is mirrored"},
      {"inverse in millimetres",
       [](const Rigid3& T) { return Rigid3(T.inverse().rotation, 1e3 * T.inverse().translation); },
       Finding("convention.unit", {{"unit", "millimetres"}}).by({Finding("convention.inverted")}), "millimetres"},
  };
}

// A realistic estimate: a few millimetres and hundredths of a degree off.
Result noisy_result(const Truth& truth, std::uint64_t seed, double metres, double radians) {
  RandomStream random(seed, "suspicion");
  std::vector<Vector6d> errors(truth.cameras.size());
  for (Vector6d& error : errors)
    for (Eigen::Index i = 0; i < 6; ++i) error[i] = (i < 3 ? metres : radians) * random.normal();
  return make_result(truth, errors);
}

TEST(ConventionSuspicion, EverySlipIsNamed) {
  const Truth truth = make_truth();
  for (const Slip& slip : all_slips()) {
    Result result = noisy_result(truth, 1, 0.003, 0.002);
    for (EstimatedTransform& estimate : result.camera_to_robot)
      estimate.T_parent_child = slip.apply(estimate.T_parent_child);
    const auto suspicion = compare(result, truth).suspicion;
    ASSERT_TRUE(suspicion) << slip.name;
    EXPECT_EQ(suspicion->convention, slip.convention) << slip.name;
    EXPECT_THAT(worded(suspicion->convention), testing::HasSubstr(slip.words)) << slip.name;
    // Five of the errors' standard deviations along three axes.
    EXPECT_LT(suspicion->error_if_corrected_m, 0.026) << slip.name;
    EXPECT_LT(suspicion->error_if_corrected_rad, 0.018) << slip.name;
  }
}

TEST(ConventionSuspicion, ExchangedNamesAreNamed) {
  const Truth truth = make_truth();
  Result result = noisy_result(truth, 2, 0.003, 0.002);
  std::swap(result.camera_to_robot[0].T_parent_child, result.camera_to_robot[2].T_parent_child);
  const auto suspicion = compare(result, truth).suspicion;
  ASSERT_TRUE(suspicion);
  EXPECT_TRUE(suspicion->convention.is("convention.names_exchanged"));
  EXPECT_THAT(suspicion->convention.because,
              testing::ElementsAre(Finding("convention.name", {{"called", "left"}, {"is", "right"}}),
                                   Finding("convention.name", {{"called", "right"}, {"is", "left"}})));
}

TEST(ConventionSuspicion, OneCameraAloneIsEnough) {
  Truth truth = make_truth();
  truth.cameras.resize(1);
  for (const Slip& slip : all_slips()) {
    Result result = noisy_result(truth, 3, 0.003, 0.002);
    result.camera_to_robot[0].T_parent_child = slip.apply(result.camera_to_robot[0].T_parent_child);
    EXPECT_TRUE(compare(result, truth).suspicion) << slip.name;
  }
}

const auto kTrials = static_cast<std::uint64_t>(Trials(250, 2000).count());

TEST(ConventionSuspicion, HonestErrorsOfAnySizeAreNotAccusedOverTrials) {
  const Truth truth = make_truth();
  for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
    // From a tenth of a millimetre to ten metres, from a thousandth of a degree to any rotation.
    RandomStream random(seed, "size");
    const double size = std::pow(10.0, random.uniform(-4.0, 1.0));
    const auto suspicion = compare(noisy_result(truth, seed, size, std::min(1.5, size)), truth).suspicion;
    EXPECT_FALSE(suspicion) << "seed " << seed << ", size " << size << ": " << worded(suspicion->convention);
  }
}

TEST(ConventionSuspicion, RandomPosesAreNotAccusedOverTrials) {
  Truth truth = make_truth();
  truth.cameras.resize(1);  // a single camera is the easiest to match by chance
  int accused = 0;
  for (std::uint64_t seed = 0; seed < kTrials; ++seed)
    if (compare(noisy_result(truth, seed, 0.4, 1.5), truth).suspicion) ++accused;
  // Some 150 conventions and pairs of them each hit a random pose with a chance of about 1e-6.
  EXPECT_LE(accused, 2);
}

}  // namespace
}  // namespace rigproof
