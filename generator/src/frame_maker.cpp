#include "frame_maker.h"

#include "rigproof/core/files.h"

namespace rigproof {
namespace {

const char* const kRecordingPrefix = "recording/";

RenderOptions render_options(const Scenario& scenario, int device) {
  RenderOptions options;
  options.device = device;
  options.psf_sigma_px = scenario.config.render.psf_sigma_px;
  options.board_at_double = scenario.config.render.board_at_double;
  options.whole_at_double = scenario.config.render.whole_at_double;
  options.depth = false;
  for (const RigCamera& camera : scenario.rig.rig.cameras) options.depth = options.depth || camera.depth.has_value();
  return options;
}

}  // namespace

FrameMaker::FrameMaker(const Scenario& scenario, const std::filesystem::path& run, int device)
    : scenario_(scenario),
      run_{run},
      renderer_(*scenario.world, render_options(scenario, device)),
      png_(static_cast<int>(scenario.config.png_level),
           scenario.config.sensor_noise == "none" ? PngContent::kClean : PngContent::kNoisy) {
  for (std::size_t i = 0; i < scenario.camera_count(); ++i) {
    sensors_.emplace_back(scenario.sensors[i]);
    if (scenario.config.clouds == "none") continue;
    clouds_.emplace_back(scenario.rig.rig.cameras[i].camera, static_cast<int>(scenario.config.cloud_stride_px));
  }
}

FileEntries FrameMaker::make(std::size_t frame) {
  const std::size_t stop = frame / scenario_.camera_count(), camera = frame % scenario_.camera_count();
  const CameraFrame& files = scenario_.recording.frames[camera][stop];
  const auto stream = [&](const char* purpose) {
    return RandomStream(scenario_.truth.seed, purpose, static_cast<std::int64_t>(stop),
                        static_cast<std::int32_t>(camera));
  };
  scenario_.world->place_robot(scenario_.T_scene_robot[stop]);
  renderer_.render(camera, &view_);
  FileEntries entries;
  sensors_[camera].sense_color(stream("image noise"), &view_.color);
  write(files.color_file, png_.encode(view_.color), &entries);
  if (files.depth_file.empty()) return entries;
  const double unit_m = scenario_.rig.rig.cameras[camera].depth->unit_m;
  sensors_[camera].sense_depth(view_.depth_m, unit_m, stream("depth noise"), &depth_);
  write(files.depth_file, png_.encode(depth_), &entries);
  if (files.cloud_file.empty()) return entries;
  write(files.cloud_file, encode_pcd(clouds_[camera].points(depth_, unit_m)), &entries);
  return entries;
}

void FrameMaker::write(const std::string& file_in_recording, std::string_view bytes, FileEntries* entries) {
  write_file_atomically_unsynced(run_.recording() / file_in_recording, bytes);
  (*entries)[kRecordingPrefix + file_in_recording] = {bytes.size(), sha256_hex(bytes)};
}

std::vector<std::string> files_of_frame(const Scenario& scenario, std::size_t frame) {
  const std::size_t cameras = scenario.camera_count();
  const CameraFrame& files = scenario.recording.frames[frame % cameras][frame / cameras];
  std::vector<std::string> paths;
  for (const std::string& file : {files.color_file, files.depth_file, files.cloud_file}) {
    if (!file.empty()) paths.push_back(kRecordingPrefix + file);
  }
  return paths;
}

}  // namespace rigproof
