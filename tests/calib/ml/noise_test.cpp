#include "rigproof/calib/estimate/noise.h"

#include <gtest/gtest.h>

#include "rigproof/core/random.h"

namespace rigproof::ml {
namespace {

class Moments : public testing::TestWithParam<int> {};

TEST_P(Moments, EqualTheirMonteCarloMeans) {
  const int d = GetParam();
  RandomStream random(1, "moments test", d);
  const CauchyLoss loss;
  double weight = 0.0, weighted = 0.0, slope = 0.0, square = 0.0;
  constexpr int kSamples = 200000;
  for (int i = 0; i < kSamples; ++i) {
    double s = 0.0;
    for (int k = 0; k < d; ++k) {
      const double r = random.normal();
      s += r * r;
    }
    const double w = loss.weight(s);
    weight += w / kSamples;
    weighted += w * s / d / kSamples;
    square += w * w * s / d / kSamples;
    // Divergence of w(r) r over the dimensions: E[psi'].
    slope += (w - 2.0 * s * w * w / (loss.c2 * d)) / kSamples;
  }
  // 200,000 samples of variance below one: 0.01 is four standard deviations.
  EXPECT_NEAR(cauchy_moments(d).weight, weight, 0.01);
  EXPECT_NEAR(cauchy_moments(d).weighted_square, weighted, 0.01);
  EXPECT_NEAR(cauchy_moments(d).efficiency, slope * slope / square, 0.01);
}

TEST_P(Moments, TheLossKeepsNearlyAllInformation) { EXPECT_GT(cauchy_moments(GetParam()).efficiency, 0.95); }

INSTANTIATE_TEST_SUITE_P(Dimensions, Moments, testing::Values(1, 2, 3));

TEST(CauchyLoss, IsQuadraticForSmallResidualsAndSlowForLargeOnes) {
  const CauchyLoss loss;
  EXPECT_NEAR(loss.cost(1e-6), 1e-6, 1e-12);
  EXPECT_LT(loss.cost(1e6), 110.0);
}

}  // namespace
}  // namespace rigproof::ml
