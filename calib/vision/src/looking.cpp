#include "looking.h"

#include <set>
#include <vector>

#include "finding_bytes.h"
#include "rigproof/calib/vision/checkerboard.h"
#include "rigproof/calib/vision/ground_plane.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/marked_board.h"
#include "rigproof/core/files.h"
#include "smooth_image.h"

namespace rigproof {
namespace detection {
namespace {

constexpr std::uint32_t kFormat = 1;

// Of a side, read forwards or backwards: depth that seems not to belong to its images is tried the other way round.
std::set<int> sampled_places(int side, int stride) {
  std::set<int> places;
  for (int at = stride / 2; at < side; at += stride) places.insert({at, side - 1 - at});
  return places;
}

template <typename Use>
void for_each_sampled(int width, int height, const Use& use) {
  const int stride = sampling_stride(width, height, kDepthPoints);
  const std::set<int> columns = sampled_places(width, stride);
  for (const int y : sampled_places(height, stride))
    for (const int x : columns) use(x, y);
}

constexpr auto kDepthParts = [](auto& archive, auto& depth) {
  archive.number(depth.width);
  archive.number(depth.height);
  archive.size(depth.pixels, sizeof(std::uint16_t));
  for (auto& count : depth.pixels) archive.number(count);
};

// The sampled counts, row by row.
Image16 samples_of(const Image16& depth) {
  Image16 samples;
  samples.width = depth.width;
  samples.height = depth.height;
  for_each_sampled(depth.width, depth.height, [&](int x, int y) { samples.pixels.push_back(depth.at(x, y)); });
  return samples;
}

std::string depth_key(const std::string& content) {
  Writer key(kFormat);
  key.kind("depth");
  key.text(content);
  key.number(kDepthPoints);
  return sha256_hex(key.bytes());
}

}  // namespace

Finding wrong_size(const char* code, int width, int height, const Camera& rig) {
  return Finding(code,
                 {{"width", width}, {"height", height}, {"rig_width", rig.width_px}, {"rig_height", rig.height_px}});
}

std::vector<Board> others_than(const Rig& rig, int board) {
  std::vector<Board> others;
  for (int b = 0; b < rig.boards(); ++b)
    if (b != board) others.push_back(rig.board_at(b));
  return others;
}

void search_image(const Image8& grey, const Camera& camera, const Board& board, std::vector<Board> others,
                  Sight* sight) {
  sight->wrong_size = grey.width != camera.width_px || grey.height != camera.height_px;
  if (sight->wrong_size) {
    sight->why_not = wrong_size("image.wrong_size", grey.width, grey.height, camera);
    return;
  }
  sight->readable = true;
  CheckerboardOptions options;
  options.others = std::move(others);
  BoardDetection detection = detect_board(grey, board, options);
  if (auto* missing = std::get_if<BoardNotFound>(&detection))
    sight->why_not = missing->why;
  else
    sight->corners = std::move(std::get<std::vector<CornerObservation>>(detection));
}

std::optional<Image16> recall_depth(PictureMemory* memory, const std::string& content) {
  if (content.empty()) return std::nullopt;
  const std::optional<std::string> bytes = memory->recall(PictureMemory::Finding::kDepths, depth_key(content));
  Image16 samples;
  if (!bytes || !read_parts(kFormat, *bytes, &samples, kDepthParts)) return std::nullopt;
  const auto possible = [](int side) { return side > 0 && side <= kMaxImageSide; };
  if (!possible(samples.width) || !possible(samples.height)) return std::nullopt;
  std::size_t wanted = 0, next = 0;
  for_each_sampled(samples.width, samples.height, [&](int, int) { ++wanted; });
  if (wanted != samples.pixels.size()) return std::nullopt;
  Image16 depth(samples.width, samples.height);
  for_each_sampled(depth.width, depth.height, [&](int x, int y) { depth.at(x, y) = samples.pixels[next++]; });
  return depth;
}

}  // namespace detection

void look_at(const Recording& recording, const FrameInMemory& frame, PictureMemory* memory) {
  using Found = PictureMemory::Finding;
  const Camera& camera = recording.rig.cameras[frame.camera].camera;
  const std::string content = memory->content_of(frame.files.color_file);
  for (int b = 0; b < recording.rig.boards(); ++b) {
    const Board& board = recording.rig.board_at(b);
    detection::Sight sight;
    const std::vector<Board> others = detection::others_than(recording.rig, b);
    detection::search_image(detection::to_grey(frame.color), camera, board, others, &sight);
    memory->keep(Found::kCorners, detection::corners_key(content, camera, board, others), detection::bytes_of(sight));
  }
  if (frame.depth.empty()) return;
  memory->keep(
      Found::kDepths, detection::depth_key(memory->content_of(frame.files.depth_file)),
      detection::bytes_of_parts(detection::kFormat, detection::samples_of(frame.depth), detection::kDepthParts));
}

}  // namespace rigproof
