#include "rigproof/core/exclusions.h"

#include <gtest/gtest.h>

namespace rigproof {
namespace {

TEST(Exclusions, StampsWithoutOdometryAreNoMissingBoard) {
  const std::vector<Exclusion> all = {{0, -1, "left/0.png", "odometry gap of 2.00 s (0.000 to 2.000 s)"},
                                      {0, -1, "left/1.png", "odometry gap of 2.00 s (2.000 to 4.000 s)"},
                                      {0, -1, "left/2.png", "no odometry (at 4.500 s; it covers 0.000 to 4.000 s)"},
                                      {0, 1, "left/depth/1.png", "depth: truncated PNG"},
                                      {1, 2, "right/2.png", "no board"}};
  EXPECT_EQ(why_no_view(all, 0),
            "none of its 3 images is used (2: odometry gap of 2.00 s, 1: no odometry); give stamps in seconds of the "
            "odometry's clock, and odometry beside them");
  EXPECT_EQ(why_no_view(all, 1), "none of its 1 images is used (1: no board); let it see the whole board");
  EXPECT_EQ(why_no_view(all, 2), "the board is in none of its images");
}

TEST(Exclusions, TheMostFrequentReasonOfDepthIsGivenInFull) {
  const std::vector<Exclusion> all = {{0, 0, "d/0.png", "depth: truncated PNG"},
                                      {0, 1, "d/1.png", "depth: too far (8.0 m)"},
                                      {0, 2, "d/2.png", "depth: too far (9.0 m)"},
                                      {0, 3, "c/3.png", "no board"}};
  EXPECT_EQ(why_no_depth(all, 0), ": depth of 3 images is left out, as of d/1.png: too far (8.0 m)");
  EXPECT_EQ(why_no_depth(all, 1), "");
}

TEST(Exclusions, ReasonsThatDifferInBracketsAreOne) {
  const std::vector<ReasonGroup> groups = by_reason(
      {{0, 4, "", "no board"}, {0, 5, "", "residual (2 px)"}, {0, 6, "", "residual (3 px)"}, {0, 7, "", "cut (1)"}});
  ASSERT_EQ(groups.size(), 3U);
  EXPECT_EQ(groups[0].reason, "residual");
  EXPECT_EQ(groups[0].stops, (std::vector<int>{5, 6}));
  EXPECT_EQ(groups[1].reason, "cut (1)");
  EXPECT_EQ(groups[2].reason, "no board");
}

}  // namespace
}  // namespace rigproof
