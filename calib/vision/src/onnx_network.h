// A network in ONNX, run by OpenCV's dnn module.
#pragma once

#include <filesystem>
#include <mutex>
#include <opencv2/dnn.hpp>
#include <vector>

namespace rigproof::rivals {

/// May be called from several threads at once; a network works on one image at a time.
class OnnxNetwork {
 public:
  /// Throws Error that names the file where it is no network that OpenCV can read.
  explicit OnnxNetwork(const std::filesystem::path& file);

  /// All outputs. Throws Error where the network does not take the input.
  std::vector<cv::Mat> forward(const cv::Mat& blob) const;

 private:
  mutable std::mutex mutex_;
  mutable cv::dnn::Net network_;
  std::vector<cv::String> outputs_;
};

}  // namespace rigproof::rivals
