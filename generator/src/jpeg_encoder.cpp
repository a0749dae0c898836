#include "jpeg_encoder.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "rigproof/core/error.h"

namespace rigproof {

std::string_view JpegEncoder::encode(const Image8& image) {
  cv::Mat encoded(image.height, image.width, CV_8UC(image.channels));
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* in = image.row(y);
    std::uint8_t* out = encoded.ptr(y);
    if (image.channels != 3) {
      std::copy_n(in, image.row_length(), out);
      continue;
    }
    for (std::size_t i = 0; i < image.row_length(); i += 3) {  // OpenCV wants blue first
      out[i] = in[i + 2];
      out[i + 1] = in[i + 1];
      out[i + 2] = in[i];
    }
  }
  if (!cv::imencode(".jpg", encoded, bytes_, {cv::IMWRITE_JPEG_QUALITY, quality_}))
    throw Error("an image of " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                " px cannot be encoded as JPEG");
  return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()};
}

}  // namespace rigproof
