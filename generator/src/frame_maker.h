// One frame of one camera: rendered or taken from the cache, sensed, encoded, written. Lives in a render process.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "clean_cache.h"
#include "jpeg_encoder.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/generator/generate.h"
#include "rigproof/generator/point_cloud.h"
#include "rigproof/generator/sensors.h"
#include "rigproof/png/png_encoder.h"
#include "rigproof/sim/renderer.h"
#include "scenario.h"

namespace rigproof {

/// Where clean frames come from.
struct FrameSource {
  int device = -2;                                 ///< as RenderOptions::device
  bool may_render = true;                          ///< false: the cache holds every frame, no context is made
  const CleanCache* cache = nullptr;               ///< null = everything is rendered and nothing kept
  std::vector<std::string> keys;                   ///< of every frame; empty without a cache
  std::function<void(const FramePictures&)> look;  ///< as GenerateOptions::look
};

class FrameMaker {
 public:
  /// Makes the EGL context, unless nothing may be rendered. The scenario and the source outlive this.
  FrameMaker(const Scenario& scenario, const std::filesystem::path& run, const FrameSource& source);

  /// Writes the files of a frame (whole or not at all, not yet synced), or has them looked at, and tells their sizes
  /// and hashes, by path relative to the run.
  FileEntries make(std::size_t frame);

  /// Whether the last frame was rendered, instead of taken from the cache.
  bool rendered() const { return rendered_; }

  /// Empty if nothing is rendered.
  std::string gl_renderer() const { return renderer_ ? renderer_->gl_renderer() : ""; }

 private:
  void take_clean_frame(std::size_t frame, const FrameJob& job);
  void render(const FrameJob& job);
  std::string_view encoded_color(const Image8& image);
  FileEntries encode(const FrameJob& job, double unit_m);
  void keep(const std::string& file_in_recording, std::string_view bytes, FileEntries* entries);
  void show(const FrameJob& job, const FileEntries& entries);

  const Scenario& scenario_;
  const FrameSource& source_;
  RunFolder run_;
  std::uint64_t seed_;
  bool rendered_ = false;
  std::unique_ptr<Renderer> renderer_;
  CleanFrame clean_;
  RenderedView view_;
  Image16 depth_;
  PngEncoder png_;
  JpegEncoder jpeg_;
  std::string_view jpeg_bytes_;  ///< of the last image; empty where it is no JPEG
  std::vector<Sensor> sensors_;
  std::vector<CloudMaker> clouds_;
};

/// Paths, relative to the run, of the files of a frame.
std::vector<std::string> files_of_frame(const Scenario& scenario, std::size_t frame);

/// Keys of all frames in a cache: the hash of everything that rendering of a frame depends on. Moves the robot.
std::vector<std::string> clean_frame_keys(const Scenario& scenario);

}  // namespace rigproof
