#include "onnx_network.h"

#include <opencv2/core/utils/logger.hpp>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"

namespace rigproof::rivals {
namespace {

constexpr std::uintmax_t kMaxNetworkBytes = 1U << 30U;

namespace logging = cv::utils::logging;

/// OpenCV prints what it throws as well; the exception is enough.
class QuietOpenCv {
 public:
  QuietOpenCv() : before_(logging::setLogLevel(logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { logging::setLogLevel(before_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  logging::LogLevel before_;
};

}  // namespace

OnnxNetwork::OnnxNetwork(const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = read_binary_file(file, kMaxNetworkBytes);
  const QuietOpenCv quiet;
  try {
    network_ = cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    outputs_ = network_.getUnconnectedOutLayersNames();
  } catch (const cv::Exception& error) {
    throw Error(file.string() + ": is no network that OpenCV can read: " + error.err);
  }
}

std::vector<cv::Mat> OnnxNetwork::forward(const cv::Mat& blob) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const QuietOpenCv quiet;
  try {
    network_.setInput(blob);
    std::vector<cv::Mat> outputs, copies;
    network_.forward(outputs, outputs_);
    for (const cv::Mat& output : outputs) copies.push_back(output.clone());
    return copies;
  } catch (const cv::Exception& error) {
    throw Error("the network does not take such an image: " + error.err);
  }
}

}  // namespace rigproof::rivals
