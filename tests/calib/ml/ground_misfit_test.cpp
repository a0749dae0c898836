// Ground planes that are off by more than noise and floor explain never pass in silence; uneven floors are no fault.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/geometric/geometric.h"
#include "worded.h"

namespace rigproof {
namespace {

constexpr int kOff = 1;

GeometricConfig drive_of(int seed) {
  GeometricConfig config;
  config.seed = static_cast<std::uint64_t>(seed);
  config.stops = 20;
  return config;
}

// A camera's planes are those of a floor that lies higher and lower by turns, and slopes to all four sides.
void put_off(double height_m, double tilt_rad, Observations* observations) {
  int planes = 0;
  for (PlaneObservation& plane : observations->ground_planes) {
    if (plane.camera != kOff) continue;
    const int turn = planes++;
    const Eigen::Vector3d normal = plane.inverse_depth_plane.normalized(), x = normal.unitOrthogonal();
    const Eigen::Vector3d axis = turn % 2 == 0 ? x : normal.cross(x);
    const double tilt = turn % 4 < 2 ? tilt_rad : -tilt_rad, off_m = turn % 8 < 4 ? height_m : -height_m;
    const double height = 1.0 / plane.inverse_depth_plane.norm() + off_m;
    plane.inverse_depth_plane = Eigen::AngleAxisd(tilt, axis) * normal / height;
  }
}

std::vector<const Finding*> told(const std::vector<Finding>& findings) {
  std::vector<const Finding*> all;
  for (const Finding& finding : findings)
    if (finding.is("ground.off") || finding.is("ground.off_slightly")) all.push_back(&finding);
  return all;
}

TEST(MlGroundMisfit, PlanesThatScatterBeyondSensorAndFloorAreSuspectedWithTheirCamera) {
  for (const int seed : {1, 2, 3}) {
    Observations observations = draw_geometric_run(drive_of(seed)).observations;
    put_off(0.01, 0.01, &observations);
    const Result result = estimate_maximum_likelihood(observations).result;
    EXPECT_EQ(result.status, ResultStatus::kSolved) << seed;
    const std::vector<const Finding*> findings = told(result.notes);
    ASSERT_EQ(findings.size(), 1U) << seed;
    EXPECT_TRUE(findings.front()->is("ground.off_slightly"));
    EXPECT_EQ(findings.front()->severity, Severity::kSuspect);
    EXPECT_EQ(findings.front()->cameras, std::vector{observations.cameras[kOff].name});
    const auto value = [&](const char* name) { return std::get<double>(findings.front()->find(name)->value); };
    EXPECT_GT(value("sigmas"), 4.0 * value("explained"));
  }
}

TEST(MlGroundMisfit, PlanesThatContradictEachOtherAreRefused) {
  for (const int seed : {1, 2, 3}) {
    Observations observations = draw_geometric_run(drive_of(seed)).observations;
    put_off(0.029, 0.05, &observations);
    const Result result = estimate_maximum_likelihood(observations).result;
    EXPECT_EQ(result.status, ResultStatus::kRefused) << seed;
    const std::vector<const Finding*> findings = told(result.reasons);
    ASSERT_EQ(findings.size(), 1U) << seed << worded(result.reasons).front();
    EXPECT_TRUE(findings.front()->is("ground.off"));
    EXPECT_EQ(findings.front()->cameras, std::vector{observations.cameras[kOff].name});
  }
}

// On a floor of waves the robot stands as unevenly as its cameras see it: each plane is that of another spot.
TEST(MlGroundMisfit, UnevenFloorsAreNoFault) {
  for (const double unevenness_m : {0.0, 0.001, 0.005})
    for (const int seed : {1, 2, 3}) {
      GeometricConfig config = drive_of(seed);
      config.suspension_height_sigma_m = unevenness_m;
      config.suspension_tilt_sigma_rad = 3.0 * unevenness_m;
      Observations observations = draw_geometric_run(config).observations;
      put_off(unevenness_m, 3.0 * unevenness_m, &observations);
      const Result result = estimate_maximum_likelihood(observations).result;
      EXPECT_EQ(result.status, ResultStatus::kSolved) << seed;
      EXPECT_TRUE(told(result.notes).empty()) << unevenness_m << " m, seed " << seed;
    }
}

}  // namespace
}  // namespace rigproof
