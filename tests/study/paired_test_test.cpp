// The statistics of a sweep's summary against values worked out by hand.
#include "paired_test.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rigproof/core/random.h"

namespace rigproof {
namespace {

TEST(SignedRank, CountsSignPatternsExactly) {
  // All of five the same way: 2 of 32 patterns are as extreme.
  EXPECT_DOUBLE_EQ(*signed_rank_p({1, 2, 3, 4, 5}), 2.0 / 32.0);
  EXPECT_DOUBLE_EQ(*signed_rank_p({-1, -2, -3, -4, -5}), 2.0 / 32.0);
  // The smallest one against: rank sums 1 and 14; patterns with a sum of at most 1 are two.
  EXPECT_DOUBLE_EQ(*signed_rank_p({-1, 2, 3, 4, 5}), 4.0 / 32.0);
  // n = 10, sum of negative ranks 3 + 5 = 8: 25 patterns of 1024 have a sum of at most 8.
  EXPECT_DOUBLE_EQ(*signed_rank_p({1, 2, -3, 4, -5, 6, 7, 8, 9, 10}), 2.0 * 25.0 / 1024.0);
  EXPECT_FALSE(signed_rank_p({}).has_value());
  EXPECT_FALSE(signed_rank_p({0.0, 0.0}).has_value());
  EXPECT_DOUBLE_EQ(*signed_rank_p({0.0, 1, 2, 3, 4, 5}), 2.0 / 32.0) << "zeros count for nothing";
}

TEST(SignedRank, SharesRanksOfEqualSizes) {
  // Ranks 1.5, 1.5, 3: patterns with a sum of at most 1.5 are {}, {a}, {b}.
  EXPECT_DOUBLE_EQ(*signed_rank_p({-1, 1, 2}), 2.0 * 3.0 / 8.0);
}

TEST(SignedRank, TheApproximationForManyMeetsTheExactOne) {
  RandomStream random(1, "signed rank");
  std::vector<double> fifty, more;
  for (int i = 0; i < 50; ++i) fifty.push_back(random.normal(0.3, 1.0));
  more = fifty;
  more.push_back(1e-9);  // the smallest rank changes next to nothing
  const double exact = *signed_rank_p(fifty), approximate = *signed_rank_p(more);
  EXPECT_NEAR(std::log(approximate / exact), 0.0, 0.15);
}

TEST(SignedRank, KeepsItsLevelWhereNothingDiffers) {
  int significant = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    RandomStream random(2, "signed rank level", trial);
    std::vector<double> differences;
    for (int i = 0; i < 12; ++i) differences.push_back(random.normal());
    significant += *signed_rank_p(differences) < 0.05;
  }
  EXPECT_NEAR(significant, 47, 22) << "of 1000 at 5 % (exact level 4.7 %)";
}

TEST(Bootstrap, CoversTheMean) {
  int covered = 0;
  for (int trial = 0; trial < 300; ++trial) {
    RandomStream random(3, "bootstrap", trial);
    std::vector<double> values;
    for (int i = 0; i < 30; ++i) values.push_back(random.normal(2.0, 1.0));
    const auto interval = bootstrap_mean(values, static_cast<std::uint64_t>(trial));
    ASSERT_TRUE(interval);
    covered += interval->low < 2.0 && interval->high > 2.0;
  }
  EXPECT_NEAR(covered, 280, 17);
  EXPECT_FALSE(bootstrap_mean({1.0}, 0).has_value());
}

TEST(Holm, StepsDown) {
  const std::vector<double> corrected = holm_corrected({0.01, 0.04, 0.03, 0.5});
  EXPECT_DOUBLE_EQ(corrected[0], 0.04);
  EXPECT_DOUBLE_EQ(corrected[2], 0.09);
  EXPECT_DOUBLE_EQ(corrected[1], 0.09) << "never below one of a smaller p";
  EXPECT_DOUBLE_EQ(corrected[3], 0.5);
}

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(quantile_of({1, 2, 3, 5}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile_of({1, 2, 3, 5}, 1.0), 5.0);
  EXPECT_DOUBLE_EQ(quantile_of({7}, 0.95), 7.0);
}

}  // namespace
}  // namespace rigproof
