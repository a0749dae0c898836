#include "rigproof/calib/memroc.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pose_near.h"
#include "synthetic_drive.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

Result solve(const SyntheticDrive& drive, bool joint) {
  return solve_memroc(drive.observations, {drive.views, {}}, {joint});
}

std::string text(const std::vector<std::string>& sentences) {
  std::string all;
  for (const std::string& sentence : sentences) all += sentence + "\n";
  return all;
}

class BothMemrocs : public testing::TestWithParam<bool> {};

TEST_P(BothMemrocs, RecoverExactGeometryForAnyMounting) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    DriveOptions options;
    options.seed = seed;
    options.any_mounting = true;
    options.cameras = 1 + static_cast<int>(seed % 4);
    options.overlap = seed % 3 != 0;
    options.plane_sigma_per_m = 0.0;
    const SyntheticDrive drive = make_drive(options);
    const Result result = solve(drive, GetParam());
    ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
    for (std::size_t k = 0; k < drive.T_robot_camera.size(); ++k)
      EXPECT_TRUE(IsPoseNear(drive.T_robot_camera[k], result.camera_to_robot[k].T_parent_child, 1e-8, 1e-8));
    for (const EstimatedTransform& pair : result.camera_to_camera) EXPECT_TRUE(pair.fully_observable());
  }
}

INSTANTIATE_TEST_SUITE_P(Memroc, BothMemrocs, testing::Bool());

}  // namespace
}  // namespace rigproof
