// One frame of one camera: rendered, sensed, encoded, written. Lives in a render process.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "rigproof/core/run_folder.h"
#include "rigproof/generator/png_encoder.h"
#include "rigproof/generator/point_cloud.h"
#include "rigproof/generator/sensors.h"
#include "rigproof/sim/renderer.h"
#include "scenario.h"

namespace rigproof {

using FileEntries = std::map<std::string, Manifest::Entry>;

/// Frames are numbered stop by stop: number = stop * cameras + camera.
class FrameMaker {
 public:
  /// Makes the EGL context. The scenario outlives this.
  FrameMaker(const Scenario& scenario, const std::filesystem::path& run, int device);

  /// Writes the files of a frame (whole or not at all, not yet synced) and tells their sizes and hashes, by path
  /// relative to the run.
  FileEntries make(std::size_t frame);

  const std::string& gl_renderer() const { return renderer_.gl_renderer(); }

 private:
  void write(const std::string& file_in_recording, std::string_view bytes, FileEntries* entries);

  const Scenario& scenario_;
  RunFolder run_;
  Renderer renderer_;
  RenderedView view_;
  Image16 depth_;
  PngEncoder png_;
  std::vector<Sensor> sensors_;
  std::vector<CloudMaker> clouds_;
};

/// Paths, relative to the run, of the files of a frame.
std::vector<std::string> files_of_frame(const Scenario& scenario, std::size_t frame);

}  // namespace rigproof
