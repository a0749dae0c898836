// A gyro whose bias turns the odometry while time passes: found, named with its rate, and healthy drives are not
// blamed.
#include "yaw_drift.h"

#include <gtest/gtest.h>

#include <cmath>

#include "faults.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/geometric/geometric.h"
#include "trials.h"

namespace rigproof {
namespace {

const Trials kTrials(6, 40);

GeometricRun healthy(int seed, bool along_way) {
  GeometricConfig config;
  config.seed = static_cast<std::uint64_t>(seed);
  config.stops = 30;
  config.lambda = 0.3;
  config.along_way = along_way;
  config.declare_odometry_model = config.declare_odometry_sigmas = !along_way && seed % 2 == 0;
  return draw_geometric_run(config);
}

// To undo a drift the other way is to drift.
GeometricRun drifting(int seed, bool along_way, double deg_s) {
  GeometricRun run = healthy(seed, along_way);
  ml::odometry_drifting(run.observations, deg_to_rad(-deg_s)).undo(&run.observations);
  return run;
}

const Finding* find(const std::vector<Finding>& findings, const char* code) {
  for (const Finding& finding : findings)
    if (finding.is(code)) return &finding;
  return nullptr;
}

TEST(YawDrift, UndoneIsWhatItWas) {
  for (const bool along_way : {false, true}) {
    const GeometricRun run = healthy(1, along_way);
    Observations there = run.observations;
    ml::odometry_drifting(there, 0.003).undo(&there);
    EXPECT_GT(std::abs(wrap_angle(there.stops.back().yaw_rad - run.observations.stops.back().yaw_rad)), 0.1);
    ml::odometry_drifting(there, -0.003).undo(&there);
    for (std::size_t i = 0; i < there.stops.size(); ++i) {
      const Stop &a = run.observations.stops[i], &b = there.stops[i];
      EXPECT_NEAR(a.x_m, b.x_m, 1e-9);
      EXPECT_NEAR(a.y_m, b.y_m, 1e-9);
      EXPECT_NEAR(wrap_angle(a.yaw_rad - b.yaw_rad), 0.0, 1e-9);
      for (std::size_t k = 0; k < a.way.size(); ++k) EXPECT_LT((a.way[k] - b.way[k]).head<2>().norm(), 1e-9);
    }
  }
}

TEST(YawDrift, AGyrosBiasIsNamedWithItsRate) {
  for (const bool along_way : {false, true})
    for (const double deg_s : {0.4, -1.0}) {
      const Result result = estimate_maximum_likelihood(drifting(2, along_way, deg_s).observations).result;
      std::vector<Finding> all = result.reasons;
      all.insert(all.end(), result.notes.begin(), result.notes.end());
      const Finding* finding = find(all, "odometry.yaw_drifts");
      if (finding == nullptr) finding = find(all, "odometry.yaw_drifts_slightly");
      ASSERT_NE(finding, nullptr) << along_way << " " << deg_s;
      EXPECT_NEAR(std::get<double>(finding->find("drift_deg_s")->value), deg_s, 0.15) << along_way;
    }
}

// Two-sided probabilities of Student's t, as tables have them: 5.4e-4, 3.9e-3, 5.7e-7.
TEST(YawDrift, IsAsUnlikelyAsSoManyDeviationsOfAGaussian) {
  const auto deviations = [](double t, double redundancy) { return ml::YawDrift{-t, 1.0, redundancy}.deviations(); };
  EXPECT_NEAR(deviations(5.0, 10.0), 3.46, 0.02);
  EXPECT_NEAR(deviations(6.0, 4.0), 2.89, 0.03);
  EXPECT_NEAR(deviations(5.0, 1e6), 5.0, 1e-3);
  EXPECT_EQ(ml::YawDrift().deviations(), 0.0);
}

TEST(YawDrift, HealthyDrivesAreNotBlamedOverTrials) {
  for (int i = 0; i < kTrials.count(); ++i) {
    const Result result = estimate_maximum_likelihood(healthy(10 + i, i % 2 == 1).observations).result;
    EXPECT_EQ(find(result.reasons, "odometry.yaw_drifts"), nullptr) << i;
    EXPECT_EQ(find(result.notes, "odometry.yaw_drifts_slightly"), nullptr) << i;
  }
}

}  // namespace
}  // namespace rigproof
