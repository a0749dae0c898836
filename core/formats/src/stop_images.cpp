#include "stop_images.h"

#include <fmt/core.h>

#include "rigproof/core/files.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

std::string copied(const WriteJob& job, const std::string& file, std::size_t stop, const std::string& folder) {
  const fs::path image = path_inside(job.recording.folder, file);
  std::string name = folder + "/" + stop_number(stop) + image.extension().string();
  copy_file_into(image, job.folder / name);
  return name;
}

}  // namespace

std::string stop_number(std::size_t stop) { return fmt::format("{:04}", stop); }

std::vector<std::string> copy_stop_images(const WriteJob& job, std::size_t camera, const std::string& folder,
                                          std::size_t* images) {
  std::size_t total = 0;
  for (const StopFrames& stop : job.stops)
    for (const int frame : stop.frames) total += frame >= 0;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < job.stops.size(); ++i) {
    names.emplace_back();
    const int frame = job.stops[i].frames[camera];
    if (frame < 0) continue;
    names.back() = copied(job, job.recording.frames[camera][static_cast<std::size_t>(frame)].color_file, i, folder);
    job.step(++*images, total);
  }
  return names;
}

std::vector<std::string> copy_board_images(const WriteJob& job, const Observations& observations, std::size_t camera,
                                           const std::string& folder, std::size_t* images) {
  std::vector<std::string> names;
  for (const BoardView& view : observations.board_views) {
    if (static_cast<std::size_t>(view.camera) != camera) continue;
    names.push_back(copied(job, view.file, static_cast<std::size_t>(view.stop), folder));
    job.step(++*images, observations.board_views.size());
  }
  return names;
}

}  // namespace rigproof
