// What Kalibr says of how cameras stand is compared with what the robot's calibration finds.
#include "rigproof/study/workflow/chain_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "rigproof/core/conventions.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::ElementsAre;

const Rigid3 kRightInLeft(so3_exp({0.02, 0.3, -0.01}), {0.4, 0.01, 0.1});

Result result_of(const Rigid3& T_left_right) {
  EstimatedTransform pair;
  pair.parent = "left";
  pair.child = "right";
  pair.T_parent_child = T_left_right;
  pair.covariance = 1e-8 * Matrix6d::Identity();
  Result result;
  result.status = ResultStatus::kSolved;
  result.camera_to_camera = {pair};
  return result;
}

FrameTree chain_of(const Rigid3& T_left_right) {
  FrameTree chain;
  chain.add("left", "right", T_left_right);
  return chain;
}

// The only finding's code, where the estimate is off by this in the chart of transform_error().
std::string code_of(const Vector6d& off) {
  const auto findings = compare_with_chain(result_of(apply_transform_error(kRightInLeft, off)), chain_of(kRightInLeft));
  EXPECT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings.at(0).cameras, ElementsAre("left", "right"));
  EXPECT_NEAR(std::get<double>(findings[0].find("off_mm")->value), 1e3 * off.head<3>().norm(), 1e-6);
  EXPECT_NEAR(std::get<double>(findings[0].find("off_deg")->value), rad_to_deg(off.tail<3>().norm()), 1e-6);
  return findings[0].code;
}

TEST(ChainCheck, AChainThatAgreesIsANoteAndOneThatDoesNotIsSuspected) {
  Vector6d off = Vector6d::Zero();
  EXPECT_EQ(code_of(off), "cameras.as_in_chain");
  off << 0.002, -0.002, 0.002, 0.001, 0.001, -0.001;
  EXPECT_EQ(code_of(off), "cameras.as_in_chain");
  off << 0.02, 0.0, 0.0, 0.0, 0.0, 0.0;
  EXPECT_EQ(code_of(off), "cameras.other_than_in_chain");
  off << 0.0, 0.0, 0.0, 0.0, deg_to_rad(1.0), 0.0;
  EXPECT_EQ(code_of(off), "cameras.other_than_in_chain");
}

TEST(ChainCheck, WhatTheResultDoesNotKnowItDoesNotCompare) {
  Vector6d off = Vector6d::Zero();
  off[0] = 0.02;
  Result result = result_of(apply_transform_error(kRightInLeft, off));
  *result.camera_to_camera[0].covariance *= 1e4;  // a centimetre
  EXPECT_TRUE(has_code(compare_with_chain(result, chain_of(kRightInLeft)), "cameras.as_in_chain"));
  result.camera_to_camera[0].observable[2] = false;
  EXPECT_TRUE(compare_with_chain(result, chain_of(kRightInLeft)).empty());
  result = result_of(kRightInLeft);
  result.camera_to_camera[0].covariance.reset();
  EXPECT_TRUE(compare_with_chain(result, chain_of(kRightInLeft)).empty());
  result = result_of(kRightInLeft);
  result.camera_to_camera[0].child = "rear";
  EXPECT_TRUE(compare_with_chain(result, chain_of(kRightInLeft)).empty());
}

// A camchain is as long as its board's squares, which nobody measured better.
TEST(ChainCheck, FarCamerasMayBeOffByMore) {
  const Rigid3 far(kRightInLeft.rotation, {4.0, 0.0, 0.0}), longer(kRightInLeft.rotation, {4.02, 0.0, 0.0});
  EXPECT_TRUE(has_code(compare_with_chain(result_of(longer), chain_of(far)), "cameras.as_in_chain"));
}

TEST(ChainCheck, TheChainOfARecordingStandsBesideIt) {
  const TempFolder folder;
  EXPECT_TRUE(load_chain(folder.path()).empty());
  folder.write("camchain.json", frame_tree_text(chain_of(kRightInLeft.inverse())));
  EXPECT_TRUE(
      has_code(compare_with_chain(result_of(kRightInLeft), load_chain(folder.path())), "cameras.other_than_in_chain"))
      << "the wrong way round";
  const auto refused = [&](const std::string& text) {
    const std::string file = folder.write("camchain.json", text).string();
    return error_text([&] { load_chain(folder.path()); }).find(file) == 0;
  };
  EXPECT_TRUE(refused("{\"transforms\": 3}"));
  const std::string text = frame_tree_text(chain_of(kRightInLeft));
  EXPECT_TRUE(refused(text.substr(0, text.size() / 2))) << "cut short";
  const auto joined = [](const std::string& parent, const std::string& child) {
    return "{\"parent\": \"" + parent + "\", \"child\": \"" + child +
           "\", \"translation_m\": [0, 0, 0], \"quaternion_xyzw\": [0, 0, 0, 1]}";
  };
  const auto transforms = [](const std::string& all) { return "{\"transforms\": [" + all + "]}"; };
  EXPECT_FALSE(refused(transforms(joined("left", "right"))));
  EXPECT_TRUE(refused(transforms(joined("left", "right") + ", " + joined("right", "left"))));
  EXPECT_TRUE(refused(transforms(joined("left", "right") + ", " + joined("rear", "right"))));
  EXPECT_TRUE(
      refused("{\"transforms\": [{\"parent\": \"left\", \"child\": \"right\", \"translation_m\": [.nan, 0, 0], "
              "\"quaternion_xyzw\": [0, 0, 0, 1]}]}"));
}

}  // namespace
}  // namespace rigproof
