// Keypoints of a network through OpenCV's dnn module.
#include <algorithm>
#include <cmath>

#include "onnx_network.h"
#include "rigproof/calib/vision/feature_source.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"

namespace rigproof {
namespace {

constexpr int kCell = 8;
constexpr int kScoreChannels = kCell * kCell + 1;

struct Keypoint {
  int x, y;
  float score;
};

// A plane of a 1 x C x H x W blob.
const float* plane(const cv::Mat& blob, int channel) { return blob.ptr<float>(0, channel); }

int rounded_up(int size) { return (size + kCell - 1) / kCell * kCell; }

class DnnFeatures : public FeatureSource {
 public:
  DnnFeatures(const std::filesystem::path& file, const DnnFeatureOptions& options)
      : options_(options), network_(file), content_(sha256_hex_of_file(file)) {
    try {
      detect(Image8(4 * kCell, 4 * kCell));
    } catch (const Error& error) {
      throw Error(file.string() + ": " + error.what());
    }
  }

  ImageFeatures detect(const Image8& grey) const override {
    const int width = rounded_up(grey.width), height = rounded_up(grey.height);
    cv::Mat input = cv::Mat::zeros(height, width, CV_32F);
    for (int y = 0; y < grey.height; ++y)
      for (int x = 0; x < grey.width; ++x) input.at<float>(y, x) = static_cast<float>(grey.at(x, y)) / 255.0F;
    const std::vector<cv::Mat> blobs = network_.forward(cv::dnn::blobFromImage(input));
    const cv::Mat *scores = nullptr, *descriptors = nullptr;
    for (const cv::Mat& blob : blobs) {
      const bool fits = blob.dims == 4 && blob.size[2] == height / kCell && blob.size[3] == width / kCell;
      if (fits && blob.size[1] == kScoreChannels && scores == nullptr)
        scores = &blob;
      else if (fits)
        descriptors = &blob;
    }
    if (scores == nullptr || descriptors == nullptr)
      throw Error("needs one output of 65 channels and one of descriptors, both at an eighth of the image's size");
    std::vector<Keypoint> points = keypoints(*scores, grey.width, grey.height);
    suppress(grey.width, grey.height, &points);
    return describe(points, *descriptors);
  }

  std::string identity() const override {
    return "onnx " + content_ + " " + std::to_string(options_.min_score) + " " +
           std::to_string(options_.suppression_px) + " " + std::to_string(options_.max_features);
  }

 private:
  // Softmax over the cell's pixels and "none".
  std::vector<Keypoint> keypoints(const cv::Mat& scores, int width, int height) const {
    std::vector<Keypoint> points;
    const int rows = scores.size[2], columns = scores.size[3];
    for (int cell = 0; cell < rows * columns; ++cell) {
      float largest = plane(scores, 0)[cell], sum = 0.0F;
      for (int c = 1; c < kScoreChannels; ++c) largest = std::max(largest, plane(scores, c)[cell]);
      for (int c = 0; c < kScoreChannels; ++c) sum += std::exp(plane(scores, c)[cell] - largest);
      for (int c = 0; c + 1 < kScoreChannels; ++c) {
        const int x = cell % columns * kCell + c % kCell, y = cell / columns * kCell + c / kCell;
        const float score = std::exp(plane(scores, c)[cell] - largest) / sum;
        if (static_cast<double>(score) > options_.min_score && x < width && y < height) points.push_back({x, y, score});
      }
    }
    return points;
  }

  // Best first; neighbours of a better one go.
  void suppress(int width, int height, std::vector<Keypoint>* points) const {
    std::stable_sort(points->begin(), points->end(),
                     [](const Keypoint& a, const Keypoint& b) { return a.score > b.score; });
    Image8 taken(width, height);
    std::vector<Keypoint> kept;
    for (const Keypoint& point : *points) {
      if (taken.at(point.x, point.y) != 0 || static_cast<int>(kept.size()) >= options_.max_features) continue;
      kept.push_back(point);
      const int r = options_.suppression_px;
      for (int y = std::max(0, point.y - r); y <= std::min(height - 1, point.y + r); ++y)
        for (int x = std::max(0, point.x - r); x <= std::min(width - 1, point.x + r); ++x) taken.at(x, y) = 1;
    }
    points->swap(kept);
  }

  // Descriptors stand for the centres of cells; between them they are interpolated, then made unit vectors.
  static ImageFeatures describe(const std::vector<Keypoint>& points, const cv::Mat& descriptors) {
    const int channels = descriptors.size[1], rows = descriptors.size[2], columns = descriptors.size[3];
    ImageFeatures features;
    features.descriptors.resize(static_cast<Eigen::Index>(points.size()), channels);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto position = [](int pixel, int cells) {
        return std::clamp((static_cast<float>(pixel) + 0.5F) / kCell - 0.5F, 0.0F, static_cast<float>(cells - 1));
      };
      const float u = position(points[i].x, columns), v = position(points[i].y, rows);
      const int u0 = static_cast<int>(u), v0 = static_cast<int>(v);
      const int u1 = std::min(u0 + 1, columns - 1), v1 = std::min(v0 + 1, rows - 1);
      const float du = u - static_cast<float>(u0), dv = v - static_cast<float>(v0);
      auto row = features.descriptors.row(static_cast<Eigen::Index>(i));
      for (int c = 0; c < channels; ++c) {
        const float* p = plane(descriptors, c);
        row(c) = (1 - dv) * ((1 - du) * p[v0 * columns + u0] + du * p[v0 * columns + u1]) +
                 dv * ((1 - du) * p[v1 * columns + u0] + du * p[v1 * columns + u1]);
      }
      row /= std::max(1e-12F, row.norm());
      features.pixels.emplace_back(points[i].x, points[i].y);
    }
    return features;
  }

  DnnFeatureOptions options_;
  rivals::OnnxNetwork network_;
  std::string content_;
};

}  // namespace

std::unique_ptr<FeatureSource> dnn_features(const std::filesystem::path& onnx_file, const DnnFeatureOptions& options) {
  return std::make_unique<DnnFeatures>(onnx_file, options);
}

}  // namespace rigproof
