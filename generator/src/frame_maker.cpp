#include "frame_maker.h"

#include "exposures.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/pcd.h"
#include "rigproof/core/text.h"
#include "rigproof/generator/generator_version.h"
#include "sensing/resolve.h"

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

// Takes the image by swapping, so that both keep their memory.
template <typename T>
void take_pixels(Image<T>* from, Image<T>* to) {
  std::swap(from->pixels, to->pixels);
  to->width = from->width;
  to->height = from->height;
  to->channels = from->channels;
}

}  // namespace

FrameMaker::FrameMaker(const Scenario& scenario, const std::filesystem::path& run, const FrameSource& source)
    : scenario_(scenario),
      source_(source),
      run_{run},
      seed_(sensing_seed(scenario.config)),
      jpeg_(static_cast<int>(scenario.config.sensing.image.jpeg_quality)) {
  if (source.may_render)
    renderer_ = std::make_unique<Renderer>(*scenario.world, render_options(scenario, source.device));
  for (std::size_t i = 0; i < scenario.camera_count(); ++i) {
    const RigCamera& rig_camera = scenario.recording.rig.cameras[i];
    const Camera& camera = scenario.rig.rig.cameras[i].camera;
    sensors_.emplace_back(scenario.sensors[i], camera.width_px, camera.height_px,
                          FrameSeed{seed_, -1, static_cast<std::int32_t>(i)});
    if (scenario.config.clouds == "none") continue;
    // A driver makes its clouds with what it was told.
    const int stride = static_cast<int>(scenario.config.cloud_stride_px);
    if (rig_camera.depth && rig_camera.depth->own_camera)
      clouds_.emplace_back(rig_camera.depth->own_camera->camera, stride, rig_camera.depth->own_camera->T_color_depth);
    else
      clouds_.emplace_back(rig_camera.camera, stride);
  }
}

void FrameMaker::render(const FrameJob& job) {
  rendered_ = true;
  renderer_->render_moving(job.camera, color_exposure(scenario_, job), depth_exposure(scenario_, job), &view_);
  clean_.gl_renderer = renderer_->gl_renderer();
  take_pixels(&view_.color, &clean_.color);
  if (job.files.depth_file.empty())
    clean_.depth_m = ImageF();
  else
    take_pixels(&view_.depth_m, &clean_.depth_m);
  take_pixels(&view_.imager, &clean_.imager);
}

void FrameMaker::take_clean_frame(std::size_t frame, const FrameJob& job) {
  rendered_ = false;
  if (source_.cache == nullptr) return render(job);
  const std::string& key = source_.keys[frame];
  const bool held = source_.cache->load(key, &clean_);
  if (held && (!renderer_ || clean_.gl_renderer == renderer_->gl_renderer())) return;
  if (!renderer_)
    throw Error(source_.cache->file_of(key).string() + ": is damaged; remove it and render this frame again");
  render(job);
  source_.cache->save(key, clean_);
}

std::string_view FrameMaker::encoded_color(const Image8& image) {
  return scenario_.sensor_images_are_jpeg() ? jpeg_.encode(image) : png_.encode(image);
}

FileEntries FrameMaker::make(std::size_t frame) {
  const FrameJob& job = scenario_.frames[frame];
  const FrameSeed seed{seed_, static_cast<std::int64_t>(job.stop), static_cast<std::int32_t>(job.camera)};
  const Sensor& sensor = sensors_[job.camera];
  take_clean_frame(frame, job);
  const double unit_m = job.files.depth_file.empty() ? 1.0 : scenario_.rig.rig.cameras[job.camera].depth->unit_m;
  // Depth first: its sensor looks at the clean colours, or has a picture of its own.
  const Image8& looked_at = clean_.imager.empty() ? clean_.color : clean_.imager;
  if (!job.files.depth_file.empty()) sensor.sense_depth(clean_.depth_m, looked_at, unit_m, seed, &depth_);
  sensor.sense_color(seed, &clean_.color);
  FileEntries entries = encode(job, unit_m);
  if (source_.look) show(job, entries);
  return entries;
}

FileEntries FrameMaker::encode(const FrameJob& job, double unit_m) {
  FileEntries entries;
  keep(job.files.color_file, encoded_color(clean_.color), &entries);
  if (job.files.depth_file.empty()) return entries;
  keep(job.files.depth_file, png_.encode(depth_), &entries);
  if (job.files.cloud_file.empty()) return entries;
  keep(job.files.cloud_file, encode_pcd(clouds_[job.camera].points(depth_, unit_m)), &entries);
  return entries;
}

void FrameMaker::keep(const std::string& file_in_recording, std::string_view bytes, FileEntries* entries) {
  if (!source_.look) write_file_atomically_unsynced(run_.recording() / file_in_recording, bytes);
  if (source_.look && scenario_.sensor_images_are_jpeg() && entries->empty()) jpeg_bytes_ = bytes;
  (*entries)[kRecordingPrefix + file_in_recording] = {bytes.size(), sha256_hex(bytes)};
}

void FrameMaker::show(const FrameJob& job, const FileEntries& entries) {
  static const Image16 kNone;
  FramePictures pictures{
      job.files, job.camera, clean_.color, jpeg_bytes_, job.files.depth_file.empty() ? kNone : depth_, {}};
  for (const auto& [path, entry] : entries)
    pictures.sha256[path.substr(std::string(kRecordingPrefix).size())] = entry.sha256;
  source_.look(pictures);
}

std::vector<std::string> files_of_frame(const Scenario& scenario, std::size_t frame) {
  const CameraFrame& files = scenario.frames[frame].files;
  std::vector<std::string> paths;
  for (const std::string& file : {files.color_file, files.depth_file, files.cloud_file}) {
    if (!file.empty()) paths.push_back(kRecordingPrefix + file);
  }
  return paths;
}

namespace {

// Exact; nothing where one picture is the whole.
std::string exposure_text(const Exposure& exposure) {
  if (exposure.parts() == 1) return "";
  return " " + number_text(exposure.exposure_s) + " " + number_text(exposure.readout_s) + " " +
         number_text(exposure.gamma);
}

}  // namespace

std::vector<std::string> clean_frame_keys(const Scenario& scenario) {
  const RenderConfig& render = scenario.config.render;
  // The scene's fields are there for those that the renderer takes from its description beside the compiled world.
  // Sensors and rigs are no part of it: a camera's intrinsics and pose are hashed as they are.
  const std::string common = generator_version() + " " + number_text(render.psf_sigma_px) + " " +
                             std::to_string(render.board_at_double) + std::to_string(render.whole_at_double) + " " +
                             scenario.world->content_hash() + " " + scenario.scene_text;
  std::vector<std::string> keys;
  for (const FrameJob& job : scenario.frames) {
    std::string views;
    for (const Exposure& exposure : {color_exposure(scenario, job), depth_exposure(scenario, job)}) {
      views += exposure_text(exposure);
      for (const Rigid3& T_scene_robot : exposure.T_world_robot) {
        scenario.world->place_robot(T_scene_robot);
        views += " " + scenario.world->view_hash(job.camera);
      }
    }
    keys.push_back(sha256_hex(common + (job.files.depth_file.empty() ? " color " : " color+depth ") + views));
  }
  return keys;
}

}  // namespace rigproof
