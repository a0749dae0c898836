#include "rigproof/calib/vision/image_files.h"

#include <string>
#include <variant>

#include "rigproof/calib/vision/image_io.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"

namespace rigproof::rivals {

FramesByStop frames_by_stop(const Observations& observations, const Recording& recording) {
  std::vector<std::map<std::string, const CameraFrame*>> by_file(recording.frames.size());
  for (std::size_t k = 0; k < recording.frames.size(); ++k)
    for (const CameraFrame& frame : recording.frames[k]) by_file[k][frame.color_file] = &frame;
  FramesByStop frames;
  const auto add = [&](int stop, int camera, const std::string& file) {
    if (stop < 0 || camera < 0 || static_cast<std::size_t>(camera) >= by_file.size()) return;
    const auto& files = by_file[static_cast<std::size_t>(camera)];
    const auto found = files.find(file);
    if (found != files.end()) frames.emplace(std::make_pair(stop, camera), found->second);
  };
  for (const BoardView& view : observations.board_views) add(view.stop, view.camera, view.file);
  // An image without a board is told by the reason for leaving it out.
  for (const Exclusion& exclusion : observations.exclusions)
    if (!exclusion.depth) add(exclusion.stop, exclusion.camera, exclusion.file);
  return frames;
}

const CameraFrame* frame_of(const FramesByStop& frames, int stop, int camera) {
  const auto found = frames.find({stop, camera});
  return found == frames.end() ? nullptr : found->second;
}

std::optional<Image8> readable_image(const Recording& recording, const CameraFrame& frame, const Camera& camera) {
  try {
    auto read = read_grey_image(path_inside(recording.folder, frame.color_file));
    auto* image = std::get_if<Image8>(&read);
    if (image == nullptr || image->width != camera.width_px || image->height != camera.height_px) return std::nullopt;
    return std::move(*image);
  } catch (const Error& failure) {
    if (failure.exit_code() == ExitCode::kTryAgain) throw;
    return std::nullopt;
  }
}

}  // namespace rigproof::rivals
