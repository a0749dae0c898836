#include "rigproof/core/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "rigproof/core/distribution.h"

namespace rigproof {
namespace {

using Words = std::array<std::uint32_t, 4>;

// The vectors that the authors of Random123 publish with their library (kat_vectors, philox4x32 10).
TEST(Random, PhiloxKnownAnswers) {
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox4x32({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

// A run is only reproducible if streams never change: these numbers are a promise to every data set that exists.
TEST(Random, StreamsNeverChange) {
  RandomStream stream(42, "odometry", 7, 2);
  EXPECT_EQ(stream.next_u32(), 753565788U);
  RandomStream other(42, "odometry");
  EXPECT_EQ(other.next_u32(), 3833827943U);
}

TEST(Random, StreamsDoNotDependOnEachOther) {
  RandomStream a(1, "depth", 3, 0), b(1, "depth", 4, 0);
  const std::uint32_t a0 = a.next_u32(), b0 = b.next_u32(), a1 = a.next_u32();
  RandomStream b_again(1, "depth", 4, 0), a_again(1, "depth", 3, 0);
  EXPECT_EQ(b_again.next_u32(), b0);
  EXPECT_EQ(a_again.next_u32(), a0);
  EXPECT_EQ(a_again.next_u32(), a1);
}

TEST(Random, EveryPartOfTheKeyCounts) {
  std::set<std::uint32_t> first;
  std::size_t streams = 0;
  for (const std::uint64_t seed : {0ULL, 1ULL, 1ULL << 63U})
    for (const char* purpose : {"", "a", "b", "ab"})
      for (const std::int64_t frame : {-1LL, 0LL, 1LL, 1LL << 40U})
        for (const std::int32_t camera : {-1, 0, 1}) {
          first.insert(RandomStream(seed, purpose, frame, camera).next_u32());
          ++streams;
        }
  EXPECT_EQ(first.size(), streams);
}

TEST(Random, FillGivesTheSameWordsAsSingleDraws) {
  for (const std::size_t before : {0U, 1U, 3U, 4U, 5U})
    for (const std::size_t count : {0U, 1U, 7U, 8U, 9U, 64U, 1001U}) {
      RandomStream one(5, "fill"), many(5, "fill");
      for (std::size_t i = 0; i < before; ++i) EXPECT_EQ(one.next_u32(), many.next_u32());
      std::vector<std::uint32_t> words(count);
      many.fill(words.data(), count);
      for (const std::uint32_t word : words) ASSERT_EQ(word, one.next_u32());
      EXPECT_EQ(one.next_u32(), many.next_u32());
    }
}

struct Moments {
  double mean = 0.0, variance = 0.0, skewness = 0.0, kurtosis = 0.0;
};

template <typename Draw>
Moments moments_of(int count, const Draw& draw) {
  std::vector<double> values(static_cast<std::size_t>(count));
  Moments m;
  for (double& value : values) m.mean += (value = draw()) / count;
  for (const double value : values) m.variance += (value - m.mean) * (value - m.mean) / count;
  for (const double value : values) {
    const double z = (value - m.mean) / std::sqrt(m.variance);
    m.skewness += z * z * z / count;
    m.kurtosis += z * z * z * z / count;
  }
  return m;
}

constexpr int kCount = 200000;
// Five standard errors of each moment over kCount draws; the stream is fixed, so the test never flickers.
const double kFive = 5.0 / std::sqrt(static_cast<double>(kCount));

TEST(Random, UniformMoments) {
  RandomStream random(3, "uniform");
  const Moments m = moments_of(kCount, [&] { return random.uniform(); });
  EXPECT_NEAR(m.mean, 0.5, kFive * std::sqrt(1.0 / 12.0));
  EXPECT_NEAR(m.variance, 1.0 / 12.0, kFive * std::sqrt(1.0 / 180.0));
  EXPECT_NEAR(m.kurtosis, 1.8, kFive * 5.0);
}

TEST(Random, NormalMoments) {
  RandomStream random(4, "normal");
  const Moments m = moments_of(kCount, [&] { return random.normal(2.0, 3.0); });
  EXPECT_NEAR(m.mean, 2.0, kFive * 3.0);
  EXPECT_NEAR(m.variance, 9.0, kFive * 9.0 * std::sqrt(2.0));
  EXPECT_NEAR(m.skewness, 0.0, kFive * std::sqrt(6.0));
  EXPECT_NEAR(m.kurtosis, 3.0, kFive * std::sqrt(24.0));
}

TEST(Random, BelowIsUniformWithoutBias) {
  RandomStream random(6, "below");
  std::vector<int> counts(7, 0);
  for (int i = 0; i < kCount; ++i) ++counts[random.below(7)];
  // Five standard deviations of a binomial with p = 1/7.
  for (const int count : counts) EXPECT_NEAR(count, kCount / 7.0, 5.0 * std::sqrt(kCount * 6.0 / 49.0));
  EXPECT_EQ(random.below(1), 0U);
}

TEST(Distribution, SamplesStayWithinTheirBounds) {
  const std::vector<Distribution> kinds = {0.5, Distribution::Kind(Distribution::Uniform{-1.0, 2.0}),
                                           Distribution::Kind(Distribution::Normal{1.0, 0.5}),
                                           Distribution::Kind(Distribution::Choice{{3.0, 1.0, 2.0}})};
  RandomStream random(8, "distribution");
  for (const Distribution& kind : kinds) {
    const Moments m = moments_of(20000, [&] {
      const double value = kind.sample(random);
      EXPECT_GE(value, kind.lowest());
      EXPECT_LE(value, kind.highest());
      return value;
    });
    // The widest has a standard deviation of 0.87: five standard errors over 20000 draws.
    EXPECT_NEAR(m.mean, kind.mean(), 0.03);
  }
}

}  // namespace
}  // namespace rigproof
