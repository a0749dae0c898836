#include <openssl/evp.h>

#include <algorithm>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "inspect_pictures.h"
#include "page_parts.h"
#include "rigproof/core/error.h"
#include "rigproof/words/sentences.h"

namespace rigproof::page_detail {
namespace {

using inspect_detail::index_in_truth;

constexpr int kThumbWidth_px = 360, kCropSide_px = 320;
constexpr int kThumbQuality = 68, kCropQuality = 80;

// `most` of `count` indices, or all of them.
std::vector<std::size_t> spread(std::size_t count, std::size_t most) {
  std::vector<std::size_t> indices;
  const std::size_t chosen = std::min(count, most);
  for (std::size_t i = 0; i < chosen; ++i) indices.push_back(i * count / chosen);
  return indices;
}

// The board with some room around it.
std::optional<cv::Rect> board_area(const BoardView& view, const Camera& camera) {
  if (view.corners.empty()) return std::nullopt;
  Eigen::Vector2d low = view.corners[0].pixel, high = low;
  for (const CornerObservation& corner : view.corners) {
    low = low.cwiseMin(corner.pixel);
    high = high.cwiseMax(corner.pixel);
  }
  const double room = 0.3 * (high - low).maxCoeff() + 4.0;
  const cv::Point first(static_cast<int>(low.x() - room), static_cast<int>(low.y() - room));
  const cv::Point last(static_cast<int>(high.x() + room), static_cast<int>(high.y() + room));
  const cv::Rect area = cv::Rect(first, last) & cv::Rect(0, 0, camera.width_px, camera.height_px);
  return area.empty() ? std::nullopt : std::optional<cv::Rect>(area);
}

// Corners as the truth projects them; empty where it does not know the view.
std::vector<Eigen::Vector2d> true_corners(const InspectInput& input, const BoardView& view) {
  if (!input.truth || view.board >= input.truth->boards()) return {};
  const Truth& truth = *input.truth;
  const auto camera = index_in_truth(truth, input.observations.cameras[static_cast<std::size_t>(view.camera)].name);
  const auto stop = camera ? stop_at(truth.stops_of(*camera), view.stamp_s) : std::nullopt;
  if (!stop) return {};
  std::vector<Eigen::Vector2d> pixels;
  for (const CornerObservation& corner : view.corners) {
    Eigen::Vector2d pixel = Eigen::Vector2d::Constant(std::nan(""));
    truth.project_corner(*camera, truth.stops_of(*camera)[*stop], truth.board_at(view.board), corner.id,
                         corner.pixel.y(), &pixel);
    pixels.push_back(pixel);
  }
  return pixels;
}

Json corners_json(const BoardView& view) {
  Json list = Json::array();
  for (const CornerObservation& corner : view.corners) {
    list.push_back(corner.id);
    for (const double value : {corner.pixel.x(), corner.pixel.y()}) list.push_back(rounded(value, 3));
    const Eigen::Matrix2d& covariance = corner.covariance_px2;
    for (const double value : {covariance(0, 0), covariance(0, 1), covariance(1, 1)}) list.push_back(rounded(value, 8));
  }
  return list;
}

std::string jpeg_base64(const cv::Mat& picture, int quality) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, quality, cv::IMWRITE_JPEG_OPTIMIZE, 1});
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(), static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

cv::Mat no_larger(const cv::Mat& picture, double scale) {
  if (scale >= 1.0) return picture;
  cv::Mat small;
  cv::resize(picture, small, {}, scale, scale, cv::INTER_AREA);
  return small;
}

std::string pictures_of(const InspectInput& input, const Frame& frame) {
  const cv::Mat picture = inspect_detail::read_color(input.input.recording->folder, frame.file);
  if (picture.empty()) return "null";
  std::string text =
      "[\"" + jpeg_base64(no_larger(picture, static_cast<double>(kThumbWidth_px) / picture.cols), kThumbQuality) +
      "\",";
  const Camera& camera = input.observations.cameras[static_cast<std::size_t>(frame.camera)].camera;
  const auto area = frame.view != nullptr ? board_area(*frame.view, camera) : std::nullopt;
  const cv::Rect inside = area ? *area & cv::Rect(0, 0, picture.cols, picture.rows) : cv::Rect();
  if (!area || inside != *area) return text + "null," + ground_json(input, frame) + "]";
  const double scale = static_cast<double>(kCropSide_px) / std::max(inside.width, inside.height);
  return text + "\"" + jpeg_base64(no_larger(picture(inside), scale), kCropQuality) + "\"," +
         ground_json(input, frame) + "]";
}

}  // namespace

std::vector<Frame> frames_of(const Observations& observations, std::size_t most) {
  std::vector<Frame> frames;
  for (const BoardView& view : observations.board_views)
    frames.push_back({view.camera, view.stop, view.file, &view, std::nullopt});
  for (const Exclusion& exclusion : observations.exclusions)
    if (!exclusion.depth) frames.push_back({exclusion.camera, exclusion.stop, exclusion.file, nullptr, exclusion.why});
  std::stable_sort(frames.begin(), frames.end(), [](const Frame& a, const Frame& b) {
    return std::tie(a.camera, a.stop) < std::tie(b.camera, b.stop);
  });
  if (frames.size() <= most) return frames;
  std::vector<Frame> chosen;
  for (const std::size_t i : spread(frames.size(), most)) chosen.push_back(frames[i]);
  return chosen;
}

Json frames_json(const InspectInput& input, const std::vector<Frame>& frames) {
  Json list = Json::array();
  for (const Frame& frame : frames) {
    Json json = {{"camera", frame.camera}, {"stop", frame.stop}, {"file", frame.file}};
    if (frame.left_out)
      json["left_out"] = {{"code", frame.left_out->code}, {"sentence", words::sentence_of(*frame.left_out)}};
    if (frame.view != nullptr) {
      const Camera& camera = input.observations.cameras[static_cast<std::size_t>(frame.camera)].camera;
      json["corners"] = corners_json(*frame.view);
      if (const auto area = board_area(*frame.view, camera))
        json["crop"] = {area->x, area->y, area->width, area->height};
      const std::vector<Eigen::Vector2d> expected = true_corners(input, *frame.view);
      for (const Eigen::Vector2d& pixel : expected)
        for (const double value : {pixel.x(), pixel.y()}) json["true"].push_back(rounded(value, 3));
    }
    list.push_back(std::move(json));
  }
  return list;
}

std::string images_json(const InspectInput& input, const std::vector<Frame>& frames, const PageOptions& options) {
  const bool readable = input.input.recording && !input.input.recording->folder.empty();
  const std::vector<std::size_t> chosen = spread(frames.size(), readable ? options.max_images : 0);
  std::vector<std::string> pictures(frames.size(), "null");
  std::mutex counting;
  std::size_t done = 0;
  bool go_on = true;
  const auto count_one = [&] {
    const std::lock_guard<std::mutex> lock(counting);
    go_on = go_on && (!options.progress || options.progress(++done, chosen.size()));
    return go_on;
  };
  const auto read = [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const std::size_t index = chosen[static_cast<std::size_t>(i)];
      if (!frames[index].file.empty()) pictures[index] = pictures_of(input, frames[index]);
      if (!count_one()) return;
    }
  };
  cv::parallel_for_(cv::Range(0, static_cast<int>(chosen.size())), read, options.threads > 0 ? options.threads : -1.0);
  if (!go_on) throw Error("interrupted", ExitCode::kTryAgain);
  std::string text = "[";
  for (std::size_t i = 0; i < pictures.size(); ++i) text += (i == 0 ? "\n" : ",\n") + pictures[i];
  return text + "]";
}

}  // namespace rigproof::page_detail
