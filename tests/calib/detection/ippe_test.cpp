#include "ippe.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "pose_near.h"
#include "rigproof/core/random.h"

namespace rigproof::detection {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A plane in front of the camera, up to 70 degrees oblique and anywhere in a wide image.
Rigid3 random_pose(RandomStream* random) {
  const double tilt = random->uniform(0.05, 1.2), towards = random->uniform(-M_PI, M_PI);
  const Vector3d axis(std::cos(towards), std::sin(towards), 0.0);
  const Eigen::Quaterniond rotation = so3_exp(tilt * axis) * so3_exp({0.0, 0.0, random->uniform(-M_PI, M_PI)});
  const double depth = random->uniform(0.6, 5.0);
  return Rigid3(rotation, depth * Vector3d(random->uniform(-0.8, 0.8), random->uniform(-0.5, 0.5), 1.0));
}

std::vector<PlaneRay> rays_of(const Rigid3& T, double noise, RandomStream* random) {
  std::vector<PlaneRay> points;
  for (int i = 0; i < 12; ++i) {
    const Vector2d point(0.1 * (i % 4), 0.1 * (i / 4));
    const Vector3d p = T * Vector3d(point.x(), point.y(), 0.0);
    points.push_back({point, p.hnormalized() + noise * Vector2d(random->normal(), random->normal())});
  }
  return points;
}

std::vector<Rigid3> poses_of_opencv(const std::vector<PlaneRay>& points) {
  std::vector<cv::Point3d> plane;
  std::vector<cv::Point2d> rays;
  for (const PlaneRay& point : points) {
    plane.emplace_back(point.point_m.x(), point.point_m.y(), 0.0);
    rays.emplace_back(point.ray.x(), point.ray.y());
  }
  std::vector<cv::Mat> rotations, translations;
  cv::solvePnPGeneric(plane, rays, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rotations, translations, false,
                      cv::SOLVEPNP_IPPE);
  std::vector<Rigid3> poses;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const auto vector = [](const cv::Mat& m) { return Vector3d(m.at<double>(0), m.at<double>(1), m.at<double>(2)); };
    poses.emplace_back(so3_exp(vector(rotations[i])), vector(translations[i]));
  }
  return poses;
}

// Exact rays make both homographies exact: what is left is rounding, magnified by the distance over the board's size.
TEST(Ippe, FindsOpenCvsTwoPosesFromExactRays) {
  RandomStream random(1, "ippe");
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Rigid3 T = random_pose(&random);
    const std::vector<PlaneRay> points = rays_of(T, 0.0, &random);
    const std::vector<Rigid3> poses = ippe_poses(points), expected = poses_of_opencv(points);
    ASSERT_EQ(poses.size(), 2U);
    EXPECT_TRUE(IsPoseNear(T, poses[0], 1e-7, 1e-7));
    ASSERT_EQ(expected.size(), 2U);
    EXPECT_TRUE(IsPoseNear(expected[1], poses[1], 1e-7, 1e-7));
  }
}

// 0.1 px of a focal length of 640: the two linear fits weigh errors differently, and both are only starts.
TEST(Ippe, IsAsNearAsOpenCvWithNoise) {
  RandomStream random(2, "ippe");
  double own = 0.0, opencv = 0.0;
  for (int i = 0; i < 200; ++i) {
    const Rigid3 T = random_pose(&random);
    const std::vector<PlaneRay> points = rays_of(T, 0.1 / 640.0, &random);
    const std::vector<Rigid3> poses = ippe_poses(points), expected = poses_of_opencv(points);
    ASSERT_EQ(poses.size(), 2U);
    const auto nearest = [&T](const std::vector<Rigid3>& candidates) {
      return std::min(transform_error(candidates[0], T).tail<3>().norm(),
                      transform_error(candidates[1], T).tail<3>().norm());
    };
    own += nearest(poses);
    opencv += nearest(expected);
  }
  EXPECT_LT(own, 1.2 * opencv);
}

TEST(Ippe, FindsNothingWherePointsDetermineNoPlane) {
  RandomStream random(3, "ippe");
  const std::vector<PlaneRay> points = rays_of(random_pose(&random), 0.0, &random);
  EXPECT_TRUE(ippe_poses({}).empty());
  EXPECT_TRUE(ippe_poses({points[0], points[1], points[4]}).empty());
  EXPECT_TRUE(ippe_poses({points[0], points[1], points[2], points[3]}).empty());
  EXPECT_TRUE(ippe_poses(std::vector<PlaneRay>(12, points[0])).empty());
}

}  // namespace
}  // namespace rigproof::detection
