#include "rigproof/words/sentences.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "worded.h"

namespace rigproof {
namespace {

using testing::ElementsAre;

const std::vector<std::string> kCameras = {"left", "center", "right"}, kPair = {"left", "right"};

Finding straight(const std::string& camera) { return Finding("motion.straight").along({"x", "y"}).of(camera); }

TEST(Sentences, CamerasStandBefore) {
  EXPECT_EQ(worded(straight("left")),
            "left: x, y unobservable: the robot drove straight and never turned; add stops with other headings");
}

TEST(Sentences, ASuspicionNamesItsCamera) {
  const Finding finding("prior.strained",
                        {{"quantity", "lens_residual_px"}, {"value", 0.4}, {"prior", 0.1}, {"deviations", 4.0}});
  EXPECT_THAT(words::sentence_of(finding.of("rear")),
              testing::StartsWith("rear: lens_residual_px is estimated at 0.4,"));
  EXPECT_THAT(words::sentence_of(finding), testing::StartsWith("lens_residual_px is estimated at 0.4,"));
}

TEST(Sentences, WhatIsTheSameOfSeveralCamerasIsSaidOnce) {
  const std::string what =
      "x, y unobservable: the robot drove straight and never turned; add stops with other headings";
  EXPECT_THAT(words::sentences_of({straight("left"), straight("right")}, kCameras),
              ElementsAre("left, right: " + what));
  EXPECT_THAT(
      words::sentences_of({straight("left"), straight("right"), straight("center"), straight("left")}, kCameras),
      ElementsAre("all cameras: " + what));
  EXPECT_THAT(words::sentences_of({straight("left").of(kCameras)}, kCameras), ElementsAre("all cameras: " + what));
}

TEST(Sentences, NoneIsSaidTwice) {
  EXPECT_THAT(words::sentences_of({Finding("odometry.mostly_outliers"), Finding("odometry.mostly_outliers")}),
              testing::SizeIs(1));
}

TEST(Sentences, CausesThatExplainAsMuchAreOneSentence) {
  const std::vector<Finding> causes = {Finding("odometry.yaw_sign", {{"undone_mm", 1.25}, {"undone_deg", 0.1}}),
                                       Finding("frames.swapped", {{"joined_by", "or"}}).of(kPair).at({3}),
                                       Finding("frames.swapped", {{"joined_by", "and"}})
                                           .of(std::vector<std::string>{"left", "center"})
                                           .at({1, 2, 3, 4, 5, 6, 7, 8, 9})};
  EXPECT_THAT(words::sentences_of(causes),
              ElementsAre("Most likely cause: the odometry's yaw has the wrong sign; or frames of left and right are "
                          "swapped at stop 3, frames of left and center are swapped at stops 1, 2, 3, 4, 5, 6, 7, 8, "
                          "... Undone, the odometry agrees with the cameras to 1.2 mm and 0.10 deg."));
}

TEST(Sentences, OffsetsSayWhereTo) {
  EXPECT_EQ(worded(Finding("errors.one_axis", {{"z_cm", 0.62}}).of("right")), "right is 0.62 cm too high");
  EXPECT_EQ(worded(Finding("errors.one_axis", {{"yaw_deg", -12.3}}).of("right")),
            "right is 12 deg turned too far right");
  EXPECT_EQ(worded(Finding("errors.one_camera", {{"x_cm", -0.0996}, {"pitch_deg", 0.171}}).of("left")),
            "only left is wrong: 0.10 cm too far back, 0.17 deg pitched too far down");
  EXPECT_EQ(worded(Finding("errors.one_camera").of("left")), "only left is wrong");
  const auto shifted = [](const FindingValues& by) { return worded(Finding("proof.corners_shifted", by).of("left")); };
  EXPECT_EQ(shifted({{"x_px", 0.51}, {"y_px", -0.98}}), "left: corners are half a pixel to the right and one pixel up");
  EXPECT_EQ(shifted({{"y_px", 0.123}}), "left: corners are .12 px down");
}

TEST(Sentences, WhatCamerasShareSaysWhereItComesFrom) {
  EXPECT_EQ(worded(Finding("errors.shared")), "The cameras share this error.");
  EXPECT_EQ(worded(Finding("errors.shared", {{"source", "odometry and ground"}})),
            "The cameras share this error (odometry and ground).");
  EXPECT_EQ(worded(Finding("errors.shared_axis", {{"deviations", 10.5}, {"x_cm", 2.1}})),
            "all cameras share this error, far more than the data allow: they are 2.1 cm too far forward");
}

TEST(Sentences, OneSlipComesWithAnother) {
  EXPECT_EQ(
      worded(Finding("convention.unit", {{"unit", "millimetres"}}).by({Finding("convention.quaternion_order")})),
      "the translations are in millimetres, not metres; moreover the quaternions are in the order w x y z, not x y "
      "z w");
  EXPECT_EQ(
      worded(Finding("proof.images_mirrored", {{"flipped", "x"}})
                 .by({Finding("proof.corners_shifted", {{"x_px", -0.5}, {"y_px", 0.3}})})
                 .of("left")),
      "left: the images are mirrored left to right (x axis flipped); moreover corners are half a pixel to the left "
      "and .30 px down");
  const auto name = [](const char* called, const char* is) {
    return Finding("convention.name", {{"called", called}, {"is", is}});
  };
  EXPECT_EQ(worded(Finding("convention.names_exchanged").by({name("left", "right"), name("right", "left")})),
            "the camera names are exchanged: what it calls left is right, what it calls right is left");
}

TEST(Sentences, FactorsAreSaidAsInTables) {
  EXPECT_EQ(worded(Finding("proof.depth_unit", {{"times", 4.0}, {"side", "long"}, {"along", "ray"}})),
            "depth is the distance along the ray, and 4.0 times too long: the depth unit is wrong by that factor");
  EXPECT_EQ(worded(Finding("proof.depth_scale", {{"off_percent", 0.872}, {"side", "short"}})),
            "depth is .87 % too short (depth scale)");
}

TEST(Sentences, OptionalPartsNeedTheirValues) {
  const Finding unit("depth.unit_of_all", {{"factor", 1000.0}});
  const std::string what =
      "Most likely cause: the depth is in another unit: the board looks 1e+03 times as far by depth as by its corners";
  EXPECT_EQ(worded(unit), what + ".");
  EXPECT_EQ(worded(unit.with({{"odometry_mm", 98.04}})), what + "; by the odometry 98.0 mm.");
  EXPECT_EQ(worded(Finding("board.scale_on_trust", {{"stated_mm", 100.0}})),
            "Scale rests on the board: no depth on it checks the 100.0 mm of its squares.");
  EXPECT_EQ(worded(Finding("moved.ambiguous", {{"with_rig", 1}}).of(kPair)),
            "One of these moved, and the images do not tell which: left, right, the whole rig.");
}

TEST(Sentences, ACauseSaysOfWhichCameraItIs) {
  const Finding all("frames.misordered", {{"order", "backwards"}});
  EXPECT_EQ(words::sentence_of(all),
            "Most likely cause: the frames do not come in the order of their stamps, but backwards.");
  EXPECT_EQ(words::sentence_of(Finding(all).of("left")),
            "Most likely cause: the frames of left do not come in the order of their stamps, but backwards.");
}

TEST(Sentences, WordsGoByNumber) {
  const auto poses = [](int count) { return worded(Finding("motion.too_few_poses", {{"poses", count}}).along({"x"})); };
  EXPECT_THAT(poses(0), testing::HasSubstr("only 0 usable poses,"));
  EXPECT_THAT(poses(1), testing::HasSubstr("only 1 usable pose,"));
  EXPECT_THAT(poses(2), testing::HasSubstr("only 2 usable poses,"));
}

TEST(Sentences, AxesAreGivenWithTheirSigmasAndLimits) {
  const Finding finding("pose.too_uncertain",
                        {{"x_cm", 1.23}, {"x_limit_cm", 1.0}, {"tilt_y_deg", 0.5}, {"tilt_y_limit_deg", 0.25}});
  EXPECT_EQ(worded(finding.along({"x", "tilt_y"}).of("left")),
            "left: too uncertain to be of use: x +-1.2 cm (limit 1.0 cm), tilt about y +-0.50 deg (limit 0.25 deg)");
}

// A sigma of kilometres is no number to people, and nan to nobody.
TEST(Sentences, WhatNothingIsKnownOfHasNoSigma) {
  const Finding finding("pose.too_uncertain", {{"x_limit_cm", 1.0}, {"yaw_deg", 3.0}, {"yaw_limit_deg", 2.0}});
  EXPECT_EQ(worded(finding.along({"x", "yaw"}).of("left")),
            "left: too uncertain to be of use: x unknown (limit 1.0 cm), yaw +-3.00 deg (limit 2.00 deg)");
}

TEST(Sentences, ACodeOfANewerProgramIsGivenAsItIs) {
  Finding finding;
  finding.code = "camera.tired";
  finding.cameras = {"left"};
  finding.values = {{"hours", 7}};
  EXPECT_EQ(worded(finding), "left: camera.tired (hours 7)");
}

TEST(Sentences, AnErrorThatIsAFindingIsWorded) {
  const FindingError error("suggest", Finding("rig.no_camera"));
  EXPECT_STREQ(error.what(), "suggest: rig.no_camera");
  EXPECT_EQ(words::message_of(error), "suggest: There is no camera: nothing can be calibrated.");
  EXPECT_EQ(words::message_of(Error("bad")), "bad");
}

TEST(Sentences, FramesAreGroupedByWhatTheyHaveInCommon) {
  const auto residual = [](double px) { return Finding("view.residual", {{"residual_px", px}}); };
  const auto groups = words::by_reason({{0, 4, "", Finding("board.not_found")},
                                        {0, 5, "", residual(2.0)},
                                        {0, 6, "", residual(3.0)},
                                        {0, 7, "", Finding("board.blurred", {{"edge_px", 4.04}})}});
  ASSERT_EQ(groups.size(), 3U);
  EXPECT_EQ(groups[0].reason, "residual");
  EXPECT_EQ(words::sentence_of(residual(0.0432)), "residual 0.043 px") << "no reason is 0.0 px";
  EXPECT_EQ(words::sentence_of(residual(123.4)), "residual 123 px");
  EXPECT_EQ(groups[0].stops, (std::vector<int>{5, 6}));
  EXPECT_EQ(groups[1].reason, "blurred (edges 4.0 px wide)");
  EXPECT_EQ(groups[2].reason, "no board");
}

}  // namespace
}  // namespace rigproof
