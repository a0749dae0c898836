// Horizon and vanishing point of a network through OpenCV's dnn module.
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "onnx_network.h"
#include "rigproof/calib/vision/horizon_source.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr int kInputSize = 512;

// From [-1, 1] between the image's edges to pixels, whose centres are whole numbers.
Eigen::Vector2d pixel(double x, double y, const Image8& image) {
  return {0.5 * (x + 1.0) * image.width - 0.5, 0.5 * (y + 1.0) * image.height - 0.5};
}

// Where a x + b y + c = 0 meets the two borders that it crosses more squarely; the left one first.
std::optional<std::array<Eigen::Vector2d, 2>> ends_of(const float* line, const Image8& image) {
  const double a = line[0], b = line[1], c = line[2];
  if (!(std::hypot(a, b) > 1e-9) || !std::isfinite(a + b + c)) return std::nullopt;
  if (std::abs(b) >= std::abs(a)) return {{pixel(-1.0, (a - c) / b, image), pixel(1.0, (-a - c) / b, image)}};
  std::array<Eigen::Vector2d, 2> ends = {pixel((b - c) / a, -1.0, image), pixel((-b - c) / a, 1.0, image)};
  if (ends[0].x() > ends[1].x()) std::swap(ends[0], ends[1]);
  return ends;
}

class DnnHorizon : public HorizonSource {
 public:
  explicit DnnHorizon(const std::filesystem::path& file) : network_(file) {
    try {
      look(Image8(kInputSize, kInputSize));
    } catch (const Error& error) {
      throw Error(file.string() + ": " + error.what());
    }
  }

  HorizonSight look(const Image8& grey) const override {
    const cv::Mat image(grey.height, grey.width, CV_8U, const_cast<std::uint8_t*>(grey.pixels.data()));
    cv::Mat stretched, color;
    cv::resize(image, stretched, cv::Size(kInputSize, kInputSize), 0.0, 0.0, cv::INTER_AREA);
    cv::cvtColor(stretched, color, cv::COLOR_GRAY2BGR);
    HorizonSight sight;
    bool answers = false;
    for (const cv::Mat& output : network_.forward(cv::dnn::blobFromImage(color, 1.0 / 255.0))) {
      const float* values = output.ptr<float>();
      if (output.total() == 2 && std::isfinite(values[0] + values[1]))
        sight.ahead_px = pixel(static_cast<double>(values[0]), static_cast<double>(values[1]), grey);
      if (output.total() == 3) sight.horizon_px = ends_of(values, grey);
      answers = answers || output.total() == 2 || output.total() == 3;
    }
    if (!answers) throw Error("needs an output of two numbers (vanishing point), of three (horizon), or both");
    return sight;
  }

 private:
  rivals::OnnxNetwork network_;
};

}  // namespace

std::unique_ptr<HorizonSource> dnn_horizon(const std::filesystem::path& onnx_file) {
  return std::make_unique<DnnHorizon>(onnx_file);
}

std::unique_ptr<HorizonSource> horizon_source_by_name(const std::string& name) {
  static const std::string kOnnx = "onnx:";
  if (name.rfind(kOnnx, 0) == 0 && name.size() > kOnnx.size()) return dnn_horizon(name.substr(kOnnx.size()));
  throw Error("horizon: \"" + for_message(name) + "\": must be onnx:FILE, a network that sees the horizon");
}

}  // namespace rigproof
