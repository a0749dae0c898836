#include "rigproof/core/exclusions.h"

#include <gtest/gtest.h>

#include "worded.h"

namespace rigproof {
namespace {

Finding gap(double from_s) {
  return Finding("odometry.gap", {{"gap_s", 2.0}, {"from_s", from_s}, {"to_s", from_s + 2.0}});
}
Finding unreadable(const char* text) { return Finding("depth.unreadable", {{"text", text}}); }
Finding residual(double px) { return Finding("view.residual", {{"residual_px", px}}); }

std::string lack_of_views(const std::vector<Exclusion>& all, int camera) {
  return worded(with_lack_of_views(Finding("camera.no_pose"), all, camera));
}

TEST(Exclusions, StampsWithoutOdometryAreNoMissingBoard) {
  const Finding outside("odometry.not_covering", {{"stamp_s", 4.5}, {"first_s", 0.0}, {"last_s", 4.0}});
  const std::vector<Exclusion> all = {{0, -1, "left/0.png", gap(0.0)},
                                      {0, -1, "left/1.png", gap(2.0)},
                                      {0, -1, "left/2.png", outside},
                                      {0, 1, "left/depth/1.png", unreadable("truncated PNG"), true},
                                      {1, 2, "right/2.png", Finding("board.not_found")}};
  EXPECT_EQ(lack_of_views(all, 0),
            "it has no pose: none of its 3 images is used (2: odometry gap, 1: no odometry); give stamps in seconds on "
            "the odometry's clock, and odometry that covers them");
  EXPECT_EQ(lack_of_views(all, 1),
            "it has no pose: none of its 1 images is used (1: no board); let it see the whole board");
  EXPECT_EQ(lack_of_views(all, 2), "it has no pose: the board is in none of its images");
}

TEST(Exclusions, ReasonsAreCountedByCodeAndTextWithoutFiguresThatDiffer) {
  const std::vector<Finding> reasons = counted({unreadable("truncated PNG"), residual(2.0), residual(3.0), gap(0.0),
                                                unreadable("file is empty"), residual(2.0), gap(0.0)});
  ASSERT_EQ(reasons.size(), 4U);
  EXPECT_EQ(reasons[0], Finding("view.residual", {{"count", 3}}));
  EXPECT_EQ(reasons[1], gap(0.0).with({{"count", 2}}));
}

TEST(Exclusions, TheMostFrequentReasonOfDepthIsGivenInFull) {
  const auto far_away = [](int points) { return Finding("plane.too_few_points", {{"points", points}}); };
  const std::vector<Exclusion> all = {{0, 0, "d/0.png", unreadable("truncated PNG"), true},
                                      {0, 1, "d/1.png", far_away(8), true},
                                      {0, 2, "d/2.png", far_away(9), true},
                                      {0, 3, "c/3.png", Finding("board.not_found")}};
  const Finding unseen = Finding("ground.unseen").along({"z"});
  EXPECT_EQ(worded(with_lack_of_depth(unseen, all, 0)),
            "z unobservable: no ground seen: the depth of 3 images is left out, for example d/1.png: only 8 points in "
            "the sensor's range; add depth images that show the floor");
  EXPECT_EQ(with_lack_of_depth(unseen, all, 1), unseen);
}

// What repeats an image that is left out is left out for the same.
TEST(Exclusions, RepeatedDepthLacksWhatItRepeats) {
  const Finding level("plane.not_level");
  const auto repeats = [](const char* file) { return Finding("depth.repeats", {{"file", file}}); };
  const std::vector<Exclusion> all = {{0, 0, "d/0.png", unreadable("truncated PNG"), true},
                                      {0, 1, "d/1.png", repeats("d/0.png"), true},
                                      {0, 2, "d/2.png", repeats("d/0.png"), true},
                                      {0, 3, "d/3.png", level, true},
                                      {0, 4, "d/4.png", level, true},
                                      {0, 5, "d/5.png", repeats("d/used.png"), true}};
  const auto example = [](const std::vector<Exclusion>& of) {
    return worded(with_lack_of_depth(Finding("ground.unseen").along({"z"}), of, 0));
  };
  EXPECT_EQ(example(all),
            "z unobservable: no ground seen: the depth of 6 images is left out, for example d/0.png: "
            "truncated PNG; add depth images that show the floor");
  EXPECT_EQ(example({all.back()}),
            "z unobservable: no ground seen: the depth of 1 images is left out, for example "
            "d/5.png: the same depth image as another (d/used.png); add depth images that show "
            "the floor");
  // As files of observations may hold it.
  const Exclusion number = {0, 5, "d/5.png", Finding("depth.repeats", {{"file", 7}}), true};
  EXPECT_EQ(example({number, number, all[3]}),
            "z unobservable: no ground seen: the depth of 3 images is left out, for example "
            "d/5.png: the same depth image as another (7); add depth images that show the floor");
}

}  // namespace
}  // namespace rigproof
