#include "shared_ground_error.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "random_values.h"
#include "trials.h"

namespace rigproof::ml {
namespace {

// Lower factor of a covariance whose directions are of very different size, as those of ground planes are.
Eigen::Matrix3d stated_factor() {
  Eigen::Matrix3d factor;
  factor << 2e-3, 0.0, 0.0, 5e-4, 3e-5, 0.0, -1e-3, 1e-4, 8e-4;
  return factor;
}

/// Planes of one camera whose errors, in units of the stated ones, are `own` times as large in each direction as
/// stated.
Observations planes_with(int count, const Eigen::Vector3d& own, RandomStream* random) {
  Observations observations;
  observations.cameras.resize(1);
  const Eigen::Matrix3d factor = stated_factor();
  for (int stop = 0; stop < count; ++stop) {
    PlaneObservation plane;
    plane.stop = stop;
    const double size = random->uniform(0.7, 1.4);
    const Eigen::Vector3d error(random->normal(), random->normal(), random->normal());
    plane.inverse_depth_plane = Eigen::Vector3d(0.01, 1.4, 0.4) + size * factor * own.cwiseProduct(error);
    plane.covariance_per_m2 = size * size * factor * factor.transpose();
    observations.ground_planes.push_back(plane);
  }
  return observations;
}

// In units of what one plane states.
Eigen::Matrix3d whitened(const Eigen::Matrix3d& shared) {
  const Eigen::Matrix3d inverse = stated_factor().inverse();
  return inverse * shared * inverse.transpose();
}

TEST(SharedGroundError, IsFoundInTheDirectionThatRepeats) {
  RandomStream random(1, "shared ground error");
  for (int trial = 0; trial < 20; ++trial) {
    const auto shared = shared_ground_errors(planes_with(20, {1.0, 0.05, 1.0}, &random));
    ASSERT_EQ(shared.size(), 1U) << "trial " << trial;
    const Eigen::Matrix3d share = whitened(shared.front());
    EXPECT_GT(share(1, 1), 0.7) << "trial " << trial;
    EXPECT_LT(share(1, 1), 1.6) << "planes of 0.7 to 1.4 times the size";
    EXPECT_LT(share(0, 0), 0.05) << "trial " << trial;
    EXPECT_LT(share(2, 2), 0.05) << "trial " << trial;
    EXPECT_GT(shared.front().llt().matrixL().determinant(), 0.0) << "a prior must have an inverse";
  }
}

TEST(SharedGroundError, OneWildPlaneHidesNothing) {
  RandomStream random(2, "shared ground error");
  for (int trial = 0; trial < 100; ++trial) {
    Observations observations = planes_with(20, {1.0, 0.05, 1.0}, &random);
    observations.ground_planes[7].inverse_depth_plane += stated_factor() * Eigen::Vector3d(0.0, 30.0, 0.0);
    const auto shared = shared_ground_errors(observations);
    ASSERT_EQ(shared.size(), 1U) << "trial " << trial;
    EXPECT_GT(whitened(shared.front())(1, 1), 0.7) << "trial " << trial;
  }
}

TEST(SharedGroundError, IsNotSeenInNoiseAsStatedOverTrials) {
  RandomStream random(3, "shared ground error");
  for (const int planes : {1, 2, 3, 4, 5, 8, 20, 100})
    for (int trial = 0; trial < Trials(150, 1000).count(); ++trial)
      ASSERT_TRUE(shared_ground_errors(planes_with(planes, {1.0, 1.0, 1.0}, &random)).empty()) << planes << " planes";
}

// Noise laws of sensors are not known better. Once in a thousand is what the limit is made for; of 300 trials, as many
// as there were, one would say little.
TEST(SharedGroundError, IsHardlyEverSeenInThreeQuartersOfTheStatedNoise) {
  RandomStream random(4, "shared ground error");
  int seen = 0;
  for (int trial = 0; trial < 20000; ++trial)
    seen += !shared_ground_errors(planes_with(20, {0.75, 0.75, 0.75}, &random)).empty();
  EXPECT_LE(seen, 20);
}

}  // namespace
}  // namespace rigproof::ml
