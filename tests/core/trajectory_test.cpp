// Trajectories of other programs: layouts, units, axes, and what is wrong with them.
#include "rigproof/formats/trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// A quarter turn to the left at (1, 2, 0.5).
void expect_quarter_turn(const TrajectoryPose& pose, double stamp_s) {
  EXPECT_NEAR(pose.stamp_s, stamp_s, 1e-6);
  EXPECT_NEAR((pose.T_world_body.translation - Eigen::Vector3d(1, 2, 0.5)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(yaw_of(pose.T_world_body), 1.5707963267948966, 1e-7);
}

TEST(Trajectories, TumEurocAndKittiSayTheSame) {
  const TempFolder scratch;
  const auto tum = read_trajectory(scratch.write("tum.txt",
                                                 "# stamp tx ty tz qx qy qz qw\r\n1700000000.5 1 2 0.5 0 0 0.70710678 "
                                                 "0.70710678\r\n1700000001 0 0 0 0 0 0 1\r\n"));
  ASSERT_EQ(tum.size(), 2U);
  expect_quarter_turn(tum[0], 1700000000.5);
  const auto euroc = read_trajectory(scratch.write(
      "data.csv",
      "#timestamp, p_x, p_y, p_z, q_w, q_x, q_y, q_z, v_x\n1700000000500000000,1,2,0.5,0.70710678,0,0,0.70710678,9\n"));
  ASSERT_EQ(euroc.size(), 1U);
  expect_quarter_turn(euroc[0], 1700000000.5);
  // The camera's axes: x right, y down, z forward. Left is -x, up is -y; the turn is about -y.
  scratch.write("kitti/times.txt", "0.0\n0.5\n");
  const auto kitti =
      read_trajectory(scratch.write("kitti/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n0 0 -1 -2 0 1 0 -0.5 1 0 0 1\n"));
  ASSERT_EQ(kitti.size(), 2U);
  expect_quarter_turn(kitti[1], 0.5);
}

TEST(Trajectories, EveryMistakeHasItsLine) {
  const TempFolder scratch;
  const auto failure = [&](const std::string& name, const std::string& text) {
    const auto file = scratch.write(name, text);
    return error_text([&] { read_trajectory(file); });
  };
  EXPECT_THAT(failure("a.txt", "1 0 0 0 0 0 0 1\n2 0 0 nan 0 0 0 1\n3 0 0 0 0 0 0\n4 0 0 0 0 0 0 2\n"),
              AllOf(HasSubstr("a.txt:2"), HasSubstr("nan"), HasSubstr("a.txt:3"), HasSubstr("has 7 numbers"),
                    HasSubstr("a.txt:4"), HasSubstr("norm 2")));
  EXPECT_THAT(failure("b.txt", "2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), HasSubstr("stamps must increase"));
  EXPECT_THAT(failure("c.txt", "1 2 3\n"), AllOf(HasSubstr("tum"), HasSubstr("kitti"), HasSubstr("euroc")));
  EXPECT_THAT(failure("d.txt", ""), HasSubstr("is no trajectory"));
  EXPECT_THAT(failure("e/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("times.txt"));
  scratch.write("e/times.txt", "0\n1\n");
  EXPECT_THAT(failure("e/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("2 stamps for 1 poses"));
  EXPECT_THAT(failure("e/poses.txt", "2 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("no rotation"));
}

}  // namespace
}  // namespace rigproof
