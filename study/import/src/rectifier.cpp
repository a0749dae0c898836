#include "rectifier.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "rigproof/core/error.h"
#include "rigproof/core/rational_lens.h"

namespace rigproof {
namespace {

// The ray, by its distance from the axis, beyond which the lens folds back: pixels there would show twice.
double farthest_ray(const std::vector<double>& d) {
  constexpr double kStep = 0.01, kMost = 6.0;
  double before = 0.0, r = kStep;
  for (; r < kMost; r += kStep) {
    const double seen = rational_distorted(d, {r, 0.0}).x();
    if (!(seen > before)) break;
    before = seen;
  }
  return r - kStep;
}

}  // namespace

Rectifier::Rectifier(const Camera& camera, const std::vector<double>& d)
    : x_(camera.height_px, camera.width_px, CV_32FC1), y_(camera.height_px, camera.width_px, CV_32FC1) {
  const double farthest = farthest_ray(d);
  for (int v = 0; v < camera.height_px; ++v)
    for (int u = 0; u < camera.width_px; ++u) {
      const Eigen::Vector2d ray((u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px);
      const Eigen::Vector2d seen = rational_distorted(d, ray);
      const bool is_seen = ray.norm() < farthest;
      x_.at<float>(v, u) = is_seen ? static_cast<float>(camera.fx_px * seen.x() + camera.cx_px) : -10.0F;
      y_.at<float>(v, u) = is_seen ? static_cast<float>(camera.fy_px * seen.y() + camera.cy_px) : -10.0F;
    }
}

template <typename Pixel>
Image<Pixel> Rectifier::moved(const Image<Pixel>& image, int depth, int interpolation) const {
  if (image.width != x_.cols || image.height != x_.rows)
    throw Error("an image of " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                ", the intrinsics are of " + std::to_string(x_.cols) + "x" + std::to_string(x_.rows));
  Image<Pixel> result(image.width, image.height, image.channels);
  const int type = CV_MAKETYPE(depth, image.channels);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): a header over pixels that are only read
  const cv::Mat from(image.height, image.width, type, const_cast<Pixel*>(image.pixels.data()));
  cv::Mat to(image.height, image.width, type, result.pixels.data());
  cv::remap(from, to, x_, y_, interpolation, cv::BORDER_CONSTANT);
  return result;
}

Image8 Rectifier::color(const Image8& image) const { return moved(image, CV_8U, cv::INTER_LANCZOS4); }
Image16 Rectifier::color(const Image16& image) const { return moved(image, CV_16U, cv::INTER_LANCZOS4); }
Image16 Rectifier::depth(const Image16& image) const { return moved(image, CV_16U, cv::INTER_NEAREST); }

}  // namespace rigproof
