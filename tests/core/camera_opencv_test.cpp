// The cameras agree with OpenCV's projectPoints and fisheye::projectPoints.
#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "random_values.h"

namespace rigproof {
namespace {

cv::Point2d project_with_opencv(const Camera& camera, const Eigen::Vector3d& p) {
  const cv::Matx33d K(camera.fx_px, 0.0, camera.cx_px, 0.0, camera.fy_px, camera.cy_px, 0.0, 0.0, 1.0);
  const std::vector<cv::Point3d> points = {{p.x(), p.y(), p.z()}};
  const cv::Vec3d zero(0.0, 0.0, 0.0);
  std::vector<cv::Point2d> pixels;
  if (camera.lens == Lens::kKannalaBrandt) {
    const cv::Vec4d k(camera.distortion[0], camera.distortion[1], camera.distortion[2], camera.distortion[3]);
    cv::fisheye::projectPoints(points, pixels, zero, zero, K, k);
  } else {
    const std::vector<double> k(camera.distortion.begin(), camera.distortion.end());
    cv::projectPoints(points, zero, zero, K, k, pixels);
  }
  return pixels.front();
}

TEST(CameraOpenCv, ProjectionsAgree) {
  RandomStream random(1, "camera opencv");
  for (const Lens lens : {Lens::kPinhole, Lens::kBrownConrady, Lens::kKannalaBrandt})
    for (int i = 0; i < 300; ++i) {
      const Camera camera = random_camera(random, lens);
      const double z = random.uniform(0.3, 5.0);
      const Eigen::Vector3d p(z * random.uniform(-1.0, 1.0), z * random.uniform(-0.6, 0.6), z);
      Eigen::Vector2d pixel;
      if (!camera.project(p, &pixel)) continue;
      const cv::Point2d expected = project_with_opencv(camera, p);
      // One formula, two orders of evaluation: rounding at 1000 px is 1e-13 px, times some ten operations.
      EXPECT_NEAR(pixel.x(), expected.x, 1e-10) << lens_name(lens);
      EXPECT_NEAR(pixel.y(), expected.y, 1e-10) << lens_name(lens);
    }
}

}  // namespace
}  // namespace rigproof
