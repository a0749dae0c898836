#include "rigproof/calib/vision/reference_corners.h"

#include <opencv2/imgproc.hpp>

#include "chessboard.h"
#include "rigproof/calib/vision/image_findings.h"
#include "rigproof/calib/vision/image_pairs.h"
#include "rigproof/calib/vision/recall.h"

namespace rigproof::rivals {
namespace {

struct Search {
  std::pair<int, int> at;  // stop, camera
  const CameraFrame* frame;
  bool read = false;
  std::optional<ChessboardCorners> corners = {};
};

void search(const MethodInput& input, Search* one) {
  const Observations& observations = input.observations;
  const Camera& camera = observations.cameras[static_cast<std::size_t>(one->at.second)].camera;
  const std::string content = detection::content_of(input.memory, one->frame->color_file);
  const std::string key = content.empty() ? content : chessboard_key(content, camera, observations.board);
  one->read = true;
  detection::recall_or(input.memory, PictureMemory::Finding::kChessboards, key, &one->corners, [&] {
    const std::optional<Image8> grey = readable_image(*input.recording, *one->frame, camera);
    one->read = grey.has_value();
    if (grey) one->corners = reference_corners(*grey, observations.board);
    return one->read;
  });
}

}  // namespace

std::optional<ChessboardCorners> reference_corners(const Image8& grey, const Board& board) {
  auto corners = detection::find_chessboard(grey, board);
  if (!corners) return std::nullopt;
  const cv::TermCriteria enough(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 30, 0.1);
  try {
    cv::cornerSubPix(detection::mat_over(grey), *corners, {11, 11}, {-1, -1}, enough);
  } catch (const cv::Exception&) {
    return std::nullopt;  // an image smaller than the window
  }
  ChessboardCorners list;
  for (const cv::Point2f& p : *corners) list.pixels.emplace_back(p.x, p.y);
  return list;
}

ChessboardViews reference_chessboards(const MethodInput& input, const FramesByStop& frames) {
  std::vector<Search> searches;
  for (const auto& [at, frame] : frames) searches.push_back({at, frame});
  for_each_image(input, searches.size(), [&](std::size_t i) { search(input, &searches[i]); });
  ChessboardViews views;
  for (Search& one : searches)
    if (one.read) views.emplace(one.at, std::move(one.corners));
  return views;
}

}  // namespace rigproof::rivals
