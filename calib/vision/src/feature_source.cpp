#include "rigproof/calib/vision/feature_source.h"

#include <algorithm>
#include <limits>
#include <opencv2/features2d.hpp>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

// OpenCV doubles the image about the corners of its pixels and halves places about their centres, so that all of them
// come out a quarter of a pixel too far right and down (its issue 23123).
constexpr double kSiftShift_px = 0.25;

class SiftFeatures : public FeatureSource {
 public:
  explicit SiftFeatures(int max_features) : max_features_(max_features) {}

  ImageFeatures detect(const Image8& grey) const override {
    ImageFeatures features;
    if (grey.empty()) return features;
    const cv::Mat image(grey.height, grey.width, CV_8U, const_cast<std::uint8_t*>(grey.pixels.data()));
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    // A detector of its own: it keeps state while it works.
    cv::SIFT::create(max_features_)->detectAndCompute(image, cv::noArray(), points, descriptors);
    for (const cv::KeyPoint& point : points)
      features.pixels.emplace_back(static_cast<double>(point.pt.x) - kSiftShift_px,
                                   static_cast<double>(point.pt.y) - kSiftShift_px);
    features.descriptors.resize(descriptors.rows, descriptors.cols);
    for (int r = 0; r < descriptors.rows; ++r)
      for (int c = 0; c < descriptors.cols; ++c) features.descriptors(r, c) = descriptors.at<float>(r, c);
    return features;
  }

  std::string identity() const override { return "sift, shift mended, " + std::to_string(max_features_); }

 private:
  int max_features_;
};

struct Nearest {
  Eigen::Index index = -1;
  float distance = std::numeric_limits<float>::infinity(), second = std::numeric_limits<float>::infinity();
};

// Squared distances of all pairs at once, as |a|^2 + |b|^2 - 2 a.b.
Eigen::MatrixXf squared_distances(const ImageFeatures& a, const ImageFeatures& b) {
  Eigen::MatrixXf distances = -2.0F * a.descriptors * b.descriptors.transpose();
  distances.colwise() += a.descriptors.rowwise().squaredNorm();
  distances.rowwise() += b.descriptors.rowwise().squaredNorm().transpose();
  return distances;
}

}  // namespace

std::unique_ptr<FeatureSource> sift_features(int max_features) { return std::make_unique<SiftFeatures>(max_features); }

std::unique_ptr<FeatureSource> feature_source_by_name(const std::string& name) {
  static const std::string kOnnx = "onnx:";
  if (name == "sift") return sift_features();
  if (name.rfind(kOnnx, 0) == 0 && name.size() > kOnnx.size()) return dnn_features(name.substr(kOnnx.size()));
  throw Error("features: \"" + for_message(name) + "\": must be sift or onnx:FILE, a keypoint network");
}

std::vector<std::pair<std::size_t, std::size_t>> match_features(const ImageFeatures& a, const ImageFeatures& b,
                                                                double max_ratio) {
  std::vector<std::pair<std::size_t, std::size_t>> matches;
  if (a.pixels.empty() || b.pixels.empty() || a.descriptors.cols() != b.descriptors.cols()) return matches;
  const Eigen::MatrixXf distances = squared_distances(a, b);
  std::vector<Nearest> of_a(a.pixels.size());
  std::vector<Nearest> of_b(b.pixels.size());
  for (Eigen::Index j = 0; j < distances.cols(); ++j) {
    for (Eigen::Index i = 0; i < distances.rows(); ++i) {
      const float distance = std::max(0.0F, distances(i, j));
      Nearest &in_b = of_a[static_cast<std::size_t>(i)], &in_a = of_b[static_cast<std::size_t>(j)];
      in_b.second = std::min(in_b.second, std::max(in_b.distance, distance));
      if (distance < in_b.distance) in_b.distance = distance, in_b.index = j;
      if (distance < in_a.distance) in_a.distance = distance, in_a.index = i;
    }
  }
  const auto ratio = static_cast<float>(max_ratio * max_ratio);
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    const Nearest& nearest = of_a[i];
    const auto j = static_cast<std::size_t>(nearest.index);
    if (of_b[j].index == static_cast<Eigen::Index>(i) && nearest.distance < ratio * nearest.second)
      matches.emplace_back(i, j);
  }
  return matches;
}

}  // namespace rigproof
