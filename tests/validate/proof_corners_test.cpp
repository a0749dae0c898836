#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "rigproof/core/error.h"
#include "rigproof/core/yaml.h"
#include "rigproof/validate/body_angles.h"
#include "rigproof/validate/proof.h"
#include "synthetic.h"
#include "temp_folder.h"
#include "worded.h"

namespace rigproof {
namespace {

using namespace testing_support;
using testing::HasSubstr;

constexpr double kSigmaPx = 0.02;

Recording no_images(const Observations& observations) {
  Recording recording;
  recording.rig.board = observations.board;
  recording.rig.cameras = observations.cameras;
  recording.frames.resize(observations.cameras.size());
  return recording;
}

Proof prove_corners_only(const Observations& observations, const Truth& truth) {
  return prove(no_images(observations), observations, truth);
}

void move_corners(Observations* observations, const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& move) {
  for (BoardView& view : observations->board_views)
    for (CornerObservation& corner : view.corners) corner.pixel = move(corner.pixel);
}

// The same code, and these values among others.
testing::Matcher<const Finding&> like(const Finding& expected) {
  return testing::Truly([expected](const Finding& finding) {
    return finding.is(expected.code.c_str()) &&
           std::all_of(expected.values.begin(), expected.values.end(), [&](const FindingValue& value) {
             const FindingValue* found = finding.find(value.name);
             return found != nullptr && *found == value;
           });
  });
}

TEST(ProofOfCorners, CleanDataPass) {
  const Truth truth = make_truth(30);
  const Observations observations = make_observations(truth, kSigmaPx);
  const Proof proof = prove_corners_only(observations, truth);
  EXPECT_TRUE(proof.passed) << testing::PrintToString(worded(proof.problems));
  for (const CameraProof& camera : proof.cameras) {
    ASSERT_GT(camera.views, 5U) << camera.camera;
    EXPECT_EQ(camera.corners, 12 * camera.views);
    // The rms of n draws has the relative error 1/sqrt(2 n), n >= 60: five of them.
    EXPECT_NEAR(camera.corner_rms_px.x(), kSigmaPx, 0.5 * kSigmaPx);
  }
}

TEST(ProofOfCorners, HalfAPixelIsNamed) {
  const Truth truth = make_truth(30);
  Observations observations = make_observations(truth, kSigmaPx);
  move_corners(&observations, [](const Eigen::Vector2d& p) { return Eigen::Vector2d(p.x() + 0.5, p.y() + 0.5); });
  const Proof proof = prove_corners_only(observations, truth);
  EXPECT_FALSE(proof.passed);
  EXPECT_EQ(worded(proof.problems.front()), "left: corners are half a pixel to the right and half a pixel down");
  for (const Finding& problem : proof.problems) {
    EXPECT_TRUE(problem.is("proof.corners_shifted"));
    for (const char* axis : {"x_px", "y_px"})
      EXPECT_NEAR(std::get<double>(problem.find(axis)->value), 0.5, 0.02) << axis;
  }
}

TEST(ProofOfCorners, SmallShiftsAreMeasured) {
  const Truth truth = make_truth(30);
  Observations observations = make_observations(truth, kSigmaPx);
  move_corners(&observations, [](const Eigen::Vector2d& p) { return Eigen::Vector2d(p.x(), p.y() - 0.12); });
  const Proof proof = prove_corners_only(observations, truth);
  EXPECT_EQ(proof.problems.size(), 3U);
  for (const Finding& problem : proof.problems) {
    EXPECT_THAT(worded(problem), testing::ContainsRegex("corners are [.]1[123] px up"));
    EXPECT_EQ(problem.find("x_px"), nullptr);
  }
}

TEST(ProofOfCorners, WrongConventionsAreNamed) {
  const Truth truth = make_truth(30);
  const Rigid3 optical_body(optical_from_body(), Eigen::Vector3d::Zero());
  struct Case {
    Finding problem;  // of some camera
    std::string words;
    std::function<void(Truth*, Observations*)> spoil;
  };
  const std::vector<Case> cases = {
      {Finding("proof.images_mirrored", {{"flipped", "x"}}), "mirrored left to right",
       [](Truth*, Observations* o) {
         move_corners(o, [](const Eigen::Vector2d& p) { return Eigen::Vector2d(639.0 - p.x(), p.y()); });
       }},
      {Finding("proof.images_mirrored", {{"flipped", "y"}}), "mirrored top to bottom",
       [](Truth*, Observations* o) {
         move_corners(o, [](const Eigen::Vector2d& p) { return Eigen::Vector2d(p.x(), 359.0 - p.y()); });
       }},
      {Finding("proof.camera_pose", {{"way", "inverted"}}), "pose is inverted (robot in camera)",
       [](Truth* t, Observations*) {
         for (TrueCamera& camera : t->cameras) camera.T_robot_camera = camera.T_robot_camera.inverse();
       }},
      {Finding("proof.camera_pose", {{"way", "body"}}), "body axes (x forward)",
       [=](Truth* t, Observations*) {
         for (TrueCamera& camera : t->cameras) camera.T_robot_camera = camera.T_robot_camera * optical_body;
       }},
      {Finding("proof.robot_poses_inverted"), "world in robot",
       [](Truth* t, Observations*) {
         for (TrueStop& stop : t->stops) stop.T_world_robot = stop.T_world_robot.inverse();
       }},
      {Finding("proof.board_pose_inverted"), "world in board",
       [](Truth* t, Observations*) { t->T_world_board = t->T_world_board.inverse(); }},
      {Finding("proof.board_flipped", {{"flipped", "xy"}}), "opposite end",
       [](Truth*, Observations* o) {
         for (BoardView& view : o->board_views)
           for (CornerObservation& corner : view.corners) corner.id = 11 - corner.id;
       }},
      {Finding("proof.board_flipped", {{"flipped", "x"}}), "x axis is flipped",
       [](Truth*, Observations* o) {
         for (BoardView& view : o->board_views)
           for (CornerObservation& corner : view.corners) corner.id = 4 * (corner.id / 4) + 3 - corner.id % 4;
       }},
      {Finding("proof.cameras_exchanged", {{"images_of", "right"}}), "cameras exchanged",
       [](Truth* t, Observations*) { std::swap(t->cameras[0].name, t->cameras[2].name); }},
      {Finding("proof.focal_length"), "% too large",
       [](Truth* t, Observations*) {
         for (TrueCamera& camera : t->cameras) camera.camera.fx_px = camera.camera.fy_px = 318.0;
       }},
      {Finding("proof.images_one_stop_off", {{"side", "late"}}), "against the poses",
       [](Truth* t, Observations*) {
         for (std::size_t i = 0; i + 1 < t->stops.size(); ++i)
           t->stops[i].T_world_robot = t->stops[i + 1].T_world_robot;
         t->stops.pop_back();
       }},
  };
  for (const Case& test : cases) {
    Truth spoilt = truth;
    Observations observations = make_observations(truth, kSigmaPx);
    test.spoil(&spoilt, &observations);
    const Proof proof = prove_corners_only(observations, spoilt);
    EXPECT_FALSE(proof.passed) << test.words;
    EXPECT_THAT(worded(proof.problems), testing::Contains(HasSubstr(test.words)));
    EXPECT_THAT(proof.problems, testing::Contains(like(test.problem)));
  }
}

TEST(ProofOfCorners, MissingDistortionIsNamed) {
  Truth truth = make_truth(30);
  const Observations observations = make_observations(truth, kSigmaPx);
  for (TrueCamera& camera : truth.cameras) {
    camera.camera.lens = Lens::kBrownConrady;
    camera.camera.distortion = {-0.1, 0.02, 0.001, -0.001, 0.0};
  }
  const Proof proof = prove_corners_only(observations, truth);
  EXPECT_THAT(worded(proof.problems), testing::Each(HasSubstr("no lens distortion")));
  EXPECT_THAT(proof.problems, testing::Each(like(Finding("proof.no_distortion"))));
}

TEST(ProofOfCorners, FewBadViewsAreListed) {
  const Truth truth = make_truth(30);
  Observations observations = make_observations(truth, kSigmaPx);
  for (CornerObservation& corner : observations.board_views[4].corners) corner.pixel.x() += 5.0;
  const Proof proof = prove_corners_only(observations, truth);
  ASSERT_EQ(proof.problems.size(), 1U);
  EXPECT_THAT(proof.problems[0],
              like(Finding("proof.few_views", {{"off", 1}, {"file", observations.board_views[4].file}})));
  EXPECT_THAT(worded(proof.problems[0]),
              testing::AllOf(HasSubstr("1 of "), HasSubstr(observations.board_views[4].file)));
}

TEST(ProofOfCorners, NothingSeenProvesNothing) {
  const Truth truth = make_truth();
  Observations observations = make_observations(truth, kSigmaPx);
  observations.board_views.clear();
  const Proof proof = prove_corners_only(observations, truth);
  EXPECT_FALSE(proof.passed);
  EXPECT_THAT(proof.problems, testing::ElementsAre(Finding("proof.nothing_seen")));
  EXPECT_THAT(worded(proof.problems), testing::ElementsAre(HasSubstr("nothing is proved")));
}

TEST(ProofOfCorners, UnknownCamerasAndStampsAreErrors) {
  const Truth truth = make_truth();
  Observations observations = make_observations(truth, kSigmaPx);
  for (BoardView& view : observations.board_views) view.stamp_s += 1000.0;
  EXPECT_THAT(prove_corners_only(observations, truth).problems, testing::Contains(like(Finding("proof.stamps"))));
  observations.cameras[0].name = "rear";
  EXPECT_THROW(prove_corners_only(observations, truth), Error);
}

TEST(ProofFile, HoldsWhatWasProved) {
  const TempFolder folder;
  const Truth truth = make_truth();
  Proof proof = prove_corners_only(make_observations(truth, kSigmaPx), truth);
  proof.problems = {Finding("proof.few_views", {{"file", "\"quoted\", with: colon"}}).of("left"),
                    Finding("proof.no_view")};
  save_proof(proof, folder / "proof.yaml", words::sentence_of);
  const YamlTree file = read_yaml_file(folder / "proof.yaml");
  EXPECT_EQ(file.find("passed")->scalar, proof.passed ? "true" : "false");
  const YamlTree& problem = file.find("problems")->items.at(0);
  EXPECT_EQ(problem.find("code")->scalar, "proof.few_views");
  EXPECT_EQ(problem.find("cameras")->items.at(0).scalar, "left");
  EXPECT_EQ(problem.find("values")->find("file")->scalar, "\"quoted\", with: colon");
  EXPECT_EQ(problem.find("sentence")->scalar, worded(proof.problems[0]));
  const std::vector<YamlTree>& cameras = file.find("cameras")->items;
  ASSERT_EQ(cameras.size(), proof.cameras.size());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    EXPECT_EQ(cameras[i].find("camera")->scalar, proof.cameras[i].camera);
    EXPECT_EQ(cameras[i].find("corners")->scalar, std::to_string(proof.cameras[i].corners));
    EXPECT_EQ(parse_number(cameras[i].find("corner_max_px")->scalar), proof.cameras[i].corner_max_px);
  }
}

}  // namespace
}  // namespace rigproof
