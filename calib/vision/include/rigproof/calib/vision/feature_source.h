// Keypoints of an image with descriptors, from an exchangeable source, and their matches.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rigproof/core/image.h"

namespace rigproof {

struct ImageFeatures {
  std::vector<Eigen::Vector2d> pixels;  ///< in the image as it is, distorted
  /// One row a feature; near descriptors in the Euclidean sense are alike.
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> descriptors;
};

/// Where features come from. Implementations may be called from several threads at once.
class FeatureSource {
 public:
  virtual ~FeatureSource() = default;
  /// Deterministic. An image in which nothing is found gives no features.
  virtual ImageFeatures detect(const Image8& grey) const = 0;
  /// Equal only for sources that find the same in every image; empty: its findings must not be cached.
  virtual std::string identity() const { return {}; }
};

/// Lowe's SIFT, as in OpenCV.
std::unique_ptr<FeatureSource> sift_features(int max_features = 3000);

struct DnnFeatureOptions {
  double min_score = 0.015;  ///< probability of a keypoint
  int suppression_px = 4;    ///< no two keypoints nearer than this
  int max_features = 3000;
};

/// A keypoint network in ONNX through OpenCV's dnn module, laid out as SuperPoint: input 1 x 1 x H x W, grey in [0, 1],
/// H and W multiples of 8; one output of 65 channels (64 pixels of a cell and "none", before softmax), another one of
/// descriptors, both at an eighth of the size. Throws Error if the file is no such network.
std::unique_ptr<FeatureSource> dnn_features(const std::filesystem::path& onnx_file,
                                            const DnnFeatureOptions& options = {});

/// "sift" or "onnx:FILE". Throws Error for anything else, and as dnn_features().
std::unique_ptr<FeatureSource> feature_source_by_name(const std::string& name);

/// Indices into a and b of features that are each other's nearest and clearly nearer than the second nearest.
/// @param max_ratio of the distances to the nearest and the second nearest
std::vector<std::pair<std::size_t, std::size_t>> match_features(const ImageFeatures& a, const ImageFeatures& b,
                                                                double max_ratio = 0.8);

}  // namespace rigproof
