#include "texture_file.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "rigproof/core/error.h"

namespace rigproof {

std::vector<std::uint8_t> load_texture_file(const std::filesystem::path& file, int size_px) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw Error(file.string() + ": there is no such texture file");
  cv::Mat picture;
  try {
    picture = cv::imread(file.string(), cv::IMREAD_COLOR);
  } catch (const cv::Exception&) {
    picture.release();  // reported below, like any other file that cannot be decoded
  }
  if (picture.empty()) throw Error(file.string() + ": the texture is not an image that can be read (PNG, JPEG, ...)");
  cv::Mat resized;
  cv::resize(picture, resized, cv::Size(size_px, size_px), 0, 0, cv::INTER_AREA);
  cv::cvtColor(resized, resized, cv::COLOR_BGR2RGB);
  cv::flip(resized, resized, 0);
  return {resized.datastart, resized.dataend};
}

}  // namespace rigproof
