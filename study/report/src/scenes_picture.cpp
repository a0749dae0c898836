// The picture that shows what places there are.
#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/study/report/check_scene.h"

namespace rigproof {
namespace {

constexpr int kTileWidth = 352, kTileHeight = 198, kGap = 6, kCaption = 22;
constexpr int kScenesInARow = 2, kPicturesOfAScene = 2;
constexpr std::size_t kMostBytes = 300000;

cv::Mat tile_of(const Image8& image) {
  if (image.pixels.empty()) return cv::Mat(kTileHeight, kTileWidth, CV_8UC3, cv::Scalar(235, 235, 235));
  cv::Mat bgr, small;
  cv::cvtColor(cv::Mat(image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.pixels.data())), bgr,
               cv::COLOR_RGB2BGR);
  cv::resize(bgr, small, cv::Size(kTileWidth, kTileHeight), 0, 0, cv::INTER_AREA);
  return small;
}

cv::Mat picture_of(const std::vector<SceneCheck>& checks) {
  const int columns = std::min<int>(kScenesInARow, static_cast<int>(checks.size()));
  const int rows = (static_cast<int>(checks.size()) + kScenesInARow - 1) / kScenesInARow;
  const int scene_width = kPicturesOfAScene * kTileWidth + 2 * kGap, scene_height = kTileHeight + kCaption + kGap;
  cv::Mat picture(rows * scene_height + kGap, columns * scene_width + kGap, CV_8UC3, cv::Scalar(255, 255, 255));
  for (std::size_t i = 0; i < checks.size(); ++i) {
    const int x = kGap + static_cast<int>(i) % kScenesInARow * scene_width;
    const int y = kGap + static_cast<int>(i) / kScenesInARow * scene_height;
    cv::putText(picture, checks[i].name, {x + 2, y + kCaption - 7}, cv::FONT_HERSHEY_SIMPLEX, 0.5,
                cv::Scalar(40, 36, 32), 1, cv::LINE_AA);
    tile_of(checks[i].towards_board).copyTo(picture(cv::Rect(x, y + kCaption, kTileWidth, kTileHeight)));
    tile_of(checks[i].straight_ahead)
        .copyTo(picture(cv::Rect(x + kTileWidth + 1, y + kCaption, kTileWidth, kTileHeight)));
  }
  return picture;
}

}  // namespace

void write_scenes_picture(const std::vector<SceneCheck>& checks, const std::filesystem::path& file) {
  if (checks.empty()) throw Error(file.string() + ": there is no scene to show");
  const cv::Mat picture = picture_of(checks);
  std::vector<std::uint8_t> bytes;
  if (file.extension() == ".png") {
    cv::imencode(".png", picture, bytes);
  } else if (file.extension() == ".jpg" || file.extension() == ".jpeg") {
    int quality = 90;
    do {
      cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
      quality -= 4;
    } while (bytes.size() > kMostBytes && quality > 10);
  } else {
    throw Error(file.string() + ": the extension must be .jpg or .png");
  }
  write_file_atomically(file, bytes);
}

}  // namespace rigproof
