// A recording of our own without a run around it.
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/formats/format.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

const char* const kMarker = "rig.yaml";

bool is_recording(const fs::path& folder) { return has_file(folder, kMarker); }

Input read_recording(const fs::path& folder) {
  Input input;
  input.recording = load_recording(folder);
  return input;
}

std::size_t image_count(const Recording& recording) {
  std::size_t count = 0;
  for (const auto& frames : recording.frames) count += frames.size();
  return count;
}

// Copies of every image, depth image and cloud that the frames name, and nothing else.
ConvertReport write_recording(const WriteJob& job) {
  Recording copy = job.recording;
  copy.folder = job.folder;
  ConvertReport report;
  const std::size_t total = image_count(copy);
  for (const std::vector<CameraFrame>& frames : copy.frames) {
    for (const CameraFrame& frame : frames) {
      for (const std::string* file : {&frame.color_file, &frame.depth_file, &frame.cloud_file})
        if (!file->empty()) copy_file_into(path_inside(job.recording.folder, *file), job.folder / *file);
      report.clouds += !frame.cloud_file.empty();
      job.step(++report.images, total);
    }
  }
  for (const RigCamera& camera : copy.rig.cameras) create_folder(job.folder / camera.folder);
  save_recording(copy);
  return report;
}

}  // namespace

Format recording_format() {
  Format format;
  format.name = "recording";
  format.several_boards = true;
  format.what = format.given_as = "a recording";
  format.marker = kMarker;
  format.detect = is_recording;
  format.read = read_recording;
  format.write = write_recording;
  return format;
}

}  // namespace rigproof
