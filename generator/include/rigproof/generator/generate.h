// Renders a run: viewpoints, odometry, images, truth.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "rigproof/core/image.h"
#include "rigproof/core/recording.h"
#include "rigproof/generator/config.h"
#include "rigproof/generator/coverage.h"

namespace rigproof {

struct Scenario;

/// The pictures of a frame, for who looks at them before they are gone.
struct FramePictures {
  const CameraFrame& files;  ///< that they would be
  std::size_t camera = 0;
  const Image8& color;          ///< RGB
  std::string_view color_jpeg;  ///< the bytes of a file that loses something; empty = it would hold `color`
  const Image16& depth;         ///< empty without a depth file
  std::map<std::string, std::string> sha256;  ///< of each file
};

struct GenerateOptions {
  std::filesystem::path output;  ///< the run's folder
  int jobs = 0;                  ///< render processes, 0 = one a core
  bool fresh = false;            ///< delete what is there and start over, instead of resuming
  int device = -2;               ///< as RenderOptions::device
  std::filesystem::path cache;   ///< clean renders are taken from here and kept here; empty = nothing is kept
  bool render = true;            ///< false: the cache must hold every clean render, and no driver is needed
  /// Called in the render processes with each frame instead of writing its files, of which the manifest keeps the
  /// hashes. A frame is done once this has returned.
  std::function<void(const FramePictures&)> look;
  std::set<std::string> again;  ///< of the files that were looked at, by path in the recording: to look at once more
  /// (images done, images in all); return false to interrupt. Called from the main process only.
  std::function<bool(std::size_t, std::size_t)> progress;
  /// motion: drive, while the drive is simulated, which happens once a run: (viewpoints reached, viewpoints in all);
  /// return false to interrupt, which is an Error with ExitCode::kTryAgain. Called by whoever prepares.
  std::function<bool(std::size_t, std::size_t)> on_the_way;
  /// Told once when render processes work and the caller's own process is nearly idle: the time to prepare the next run
  /// of several, in a thread. Not called if nothing is left to render.
  std::function<void()> on_started;
  /// Told once what renders, before the first image is done; not called if nothing is left to render.
  std::function<void(const std::string& gl_renderer)> on_renderer;
};

/// What --dry-run prints.
struct GeneratePlan {
  std::size_t stops = 0;
  std::size_t images = 0;
  std::size_t pictures = 0;  ///< that are drawn for them: an image of a moving camera is put together from several
  double expected_mb = 0.0;
  double expected_minutes = 0.0;         ///< with the drive, where it has to be simulated
  std::string coverage;                  ///< distances, bearings, cameras per view, in words
  std::vector<CameraCoverage> cameras;   ///< what each of them sees of the board from the viewpoints
  std::vector<CameraCoverage> possible;  ///< and what it could see from anywhere: see possible_coverage()
  std::size_t viewpoints = 0;            ///< stops, but for the frames of a straight drive
};

struct GenerateReport {
  std::size_t images = 0;             ///< in the run
  std::size_t images_rendered = 0;    ///< by this call, or sensed from the cache; the rest was there already
  std::size_t images_from_cache = 0;  ///< of those, the ones whose clean render the cache held
  std::uint64_t bytes = 0;
  double seconds = 0.0;
  bool complete = false;  ///< false: interrupted, resumes
  std::string gl_renderer;
  std::string coverage;
};

GeneratePlan plan_generation(const GenerateConfig& config, const GenerateOptions& options = {});

/// The first half of generate(): loads and composes the world, plans the viewpoints and drives through them, unless the
/// output or the cache holds that drive. Writes nothing; one thread at a time may prepare or generate the same run.
/// Throws Error on bad input.
std::shared_ptr<const Scenario> prepare_generation(const GenerateConfig& config, const GenerateOptions& options);

/// The other half: generates or resumes. Byte-identical for one configuration at any number of jobs, interrupted or
/// not. Throws Error on a bad environment.
GenerateReport generate(const Scenario& scenario, const GenerateOptions& options);

/// Both.
GenerateReport generate(const GenerateConfig& config, const GenerateOptions& options);

}  // namespace rigproof
