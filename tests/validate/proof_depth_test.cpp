#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "bent_face.h"
#include "rigproof/core/error.h"
#include "rigproof/validate/proof.h"
#include "synthetic.h"
#include "temp_folder.h"
#include "worded.h"

namespace rigproof {
namespace {

using namespace testing_support;
using testing::HasSubstr;

class ProofOfDepth : public testing::Test {
 protected:
  Proof prove_with(const DepthFaults& faults) {
    const Recording recording = make_depth_recording(truth_, folder_.path(), faults);
    return prove(recording, make_observations(truth_, 0.02), truth_);
  }

  Truth truth_ = make_truth(6);
  const TempFolder folder_;
};

TEST_F(ProofOfDepth, CleanDataPass) {
  const Proof proof = prove_with({});
  EXPECT_TRUE(proof.passed) << testing::PrintToString(worded(proof.problems));
  for (const CameraProof& camera : proof.cameras) {
    EXPECT_GT(camera.depth_pixels, 1000U) << camera.camera;
    EXPECT_LE(camera.depth_max_mm, 0.5 + 1e-9);  // rounding to millimetres, nothing else
    EXPECT_NEAR(camera.depth_rms_mm, 1.0 / std::sqrt(12.0), 0.03);
  }
}

// Before an exact depth camera, what a sheet bends is a dozen times the noise.
TEST_F(ProofOfDepth, ABentBoardIsExpectedBent) {
  constexpr double kBow_m = 0.06;
  DepthFaults faults;
  faults.bow_m = kBow_m;
  EXPECT_FALSE(prove_with(faults).passed) << "as the truth does not tell of it";
  for (Eigen::Vector3d corner : truth_.board.corners()) {
    corner.z() = bowed_z_m(truth_.board, kBow_m, corner.x());
    truth_.printed_corners.push_back(corner);
  }
  const Proof proof = prove_with(faults);
  EXPECT_TRUE(proof.passed) << testing::PrintToString(worded(proof.problems));
  for (const CameraProof& camera : proof.cameras) EXPECT_NEAR(camera.depth_rms_mm, 1.0 / std::sqrt(12.0), 0.03);
}

// A ray that passes by far off would meet the paraboloid again.
TEST(BentFace, IsBentOnTheBoardAlone) {
  TrueBoard board;
  EXPECT_EQ(BentFace(board).z_m(0.1, 0.1), 0.0) << "nothing bends it";
  for (Eigen::Vector3d corner : board.board.corners()) {
    corner.z() = bowed_z_m(board.board, 0.002, corner.x());
    board.printed_corners.push_back(corner);
  }
  const BentFace face(board);
  for (const double x : {-0.1, 0.03, 0.15, 0.4})
    EXPECT_NEAR(face.z_m(x, 0.1), bowed_z_m(board.board, 0.002, x), 1e-9) << x;
  EXPECT_LT(std::abs(face.z_m(50.0, -30.0)), 0.002);
}

// The stated noise at 6 m is 7 cm; data without noise must not hide furniture behind it. A foot within the rounding of
// a millimetre and five spreads of the clean data (some millimetres far away) cannot be told from the ground.
TEST_F(ProofOfDepth, FurnitureIsNoDepthErrorAndItsShareIsTold) {
  DepthFaults faults;
  faults.furniture = true;
  const Proof proof = prove_with(faults);
  EXPECT_TRUE(proof.passed) << testing::PrintToString(worded(proof.problems));
  const Proof clean = prove_with({});
  for (std::size_t i = 0; i < proof.cameras.size(); ++i) {
    EXPECT_LT(std::abs(proof.cameras[i].depth_bias_mm), 0.1);
    EXPECT_LT(proof.cameras[i].depth_rms_mm, 0.5);
    EXPECT_LT(proof.cameras[i].depth_max_mm, 10.0);
    EXPECT_NEAR(clean.cameras[i].depth_ground_share, 1.0, 0.02);
    EXPECT_NEAR(proof.cameras[i].depth_ground_share, 0.75, 0.15);
  }
}

TEST_F(ProofOfDepth, NoiseAsStatedPasses) {
  DepthFaults faults;
  faults.noise_sigmas = 1.0;
  const Proof proof = prove_with(faults);
  EXPECT_TRUE(proof.passed) << testing::PrintToString(worded(proof.problems));
  for (const CameraProof& camera : proof.cameras) {
    // The largest hundredth is left out, which takes 4 % from a normal distribution; hundreds of pixels give the rest.
    EXPECT_NEAR(camera.depth_rms_sigmas, 0.96, 0.1) << camera.camera;
  }
}

TEST_F(ProofOfDepth, RealisedNoiseIsToldAndKept) {
  DepthFaults faults;
  faults.noise_sigmas = 1.3;
  const Proof proof = prove_with(faults);
  for (const CameraProof& camera : proof.cameras) {
    EXPECT_FALSE(camera.depth_noise.empty());
    EXPECT_GT(camera.depth_valid_share, 0.99);
    for (const RealisedDepthNoise& noise : camera.depth_noise) {
      // A spread from the median of n distances has the standard error 1.17 / sqrt(n); four of them.
      const double tolerance = 4.0 * 1.17 / std::sqrt(static_cast<double>(noise.pixels));
      EXPECT_NEAR(noise.sigma_mm / noise.stated_sigma_mm, 1.3, 1.3 * tolerance + 0.05) << noise.z_m;
      EXPECT_NEAR(noise.bias_mm / noise.sigma_mm, 0.0, tolerance) << noise.z_m;
    }
  }
}

TEST_F(ProofOfDepth, DistanceAlongTheRayIsNamed) {
  DepthFaults faults;
  faults.along_ray = true;
  const std::vector<Finding> problems = prove_with(faults).problems;
  ASSERT_FALSE(problems.empty());
  EXPECT_THAT(problems, testing::Each(testing::Field(&Finding::code, "proof.depth_along_ray")));
  EXPECT_THAT(worded(problems), testing::Contains(HasSubstr("distance along the ray, not z")));
}

TEST_F(ProofOfDepth, AWrongUnitIsNamed) {
  DepthFaults faults;
  faults.factor = 4.0;  // counts of 0.25 mm read as millimetres
  const std::vector<Finding> problems = prove_with(faults).problems;
  ASSERT_FALSE(problems.empty());
  EXPECT_TRUE(problems[0].is("proof.depth_unit"));
  EXPECT_EQ(*problems[0].find("times"), FindingValue("times", 4.0));
  EXPECT_THAT(worded(problems), testing::Contains(HasSubstr("4.0 times too long: the depth unit is wrong")));
}

TEST_F(ProofOfDepth, AScaleErrorIsNamed) {
  DepthFaults faults;
  faults.factor = 1.03;
  const std::vector<Finding> problems = prove_with(faults).problems;
  ASSERT_FALSE(problems.empty());
  EXPECT_TRUE(problems[0].is("proof.depth_scale"));
  EXPECT_NEAR(std::get<double>(problems[0].find("off_percent")->value), 3.0, 0.05);
  EXPECT_THAT(worded(problems), testing::Contains(HasSubstr("3.0 % too long (depth scale)")));
}

TEST_F(ProofOfDepth, TheTrueScaleIsExpected) {
  DepthFaults faults;
  faults.factor = 1.03;
  for (TrueCamera& camera : truth_.cameras) camera.depth_scale = 1.03;
  const Proof proof = prove_with(faults);
  EXPECT_TRUE(proof.passed) << testing::PrintToString(worded(proof.problems));
}

TEST_F(ProofOfDepth, MirroredDepthIsNamed) {
  DepthFaults faults;
  faults.mirrored_y = true;
  const std::vector<Finding> problems = prove_with(faults).problems;
  ASSERT_FALSE(problems.empty());
  EXPECT_EQ(problems[0], Finding("proof.depth_mirrored", {{"flipped", "y"}}).of("left"));
  EXPECT_THAT(worded(problems), testing::Contains(HasSubstr("mirrored top to bottom")));
}

TEST_F(ProofOfDepth, UnreadableImagesAreErrors) {
  const Recording recording = make_depth_recording(truth_, folder_.path(), {});
  { std::ofstream(folder_ / recording.frames[0][0].depth_file) << "not an image"; }
  EXPECT_THROW(prove(recording, make_observations(truth_, 0.02), truth_), Error);
}

}  // namespace
}  // namespace rigproof
