// What a frame costs, stage by stage in one process, and how many frames a second so many processes make. Wall time: a
// graphics card works beside the processor.
//
//   bench_frames [POSES=40] [WORKERS=1 2 4 ..] [key: value ..]
//
// Further arguments are lines of a run's configuration, e.g. "sensor_noise: none" or "rig: cart_5x_mixed".
#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bare_passes.h"
#include "clocks.h"
#include "exposures.h"
#include "rigproof/calib/vision/picture_memory.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/generator/generate.h"
#include "rigproof/generator/sensors.h"
#include "rigproof/png/png_encoder.h"
#include "rigproof/study/sweep/observed_run.h"
#include "rigproof/study/workflow/scratch_folder.h"
#include "run_arguments.h"
#include "scenario.h"

namespace {

using namespace rigproof;

// Knows no picture and keeps nothing.
class Forgetful : public PictureMemory {
 public:
  std::string content_of(const std::string& file) const override { return file; }
  std::optional<std::string> recall(Finding /*finding*/, const std::string& /*key*/) override { return {}; }
  void keep(Finding /*finding*/, const std::string& /*key*/, const std::string& /*bytes*/) override {}
};

struct Stage {
  const char* name;
  double wall_s = 0.0, cpu_s = 0.0;

  void time(const std::function<void()>& work) {
    const double cpu = rigproof::cpu_s();
    wall_s += seconds_of(work);
    cpu_s += rigproof::cpu_s() - cpu;
  }
};

void print_stages(const GenerateConfig& config) {
  const Scenario scenario = resolve_scenario(config);
  Renderer renderer(*scenario.world, render_options_of(config));
  std::vector<Sensor> sensors;
  for (std::size_t k = 0; k < scenario.camera_count(); ++k) {
    const Camera& camera = scenario.rig.rig.cameras[k].camera;
    sensors.emplace_back(scenario.sensors[k], camera.width_px, camera.height_px);
  }
  std::array<Stage, 8> stages = {{{"bare passes, drawn and read"},
                                  {"render"},
                                  {"depth sensor"},
                                  {"image sensor"},
                                  {"encode image"},
                                  {"encode depth"},
                                  {"hash both"},
                                  {"look at both"}}};
  RenderedView view;
  Image16 depth;
  PngEncoder color_png, depth_png;
  std::string_view color_bytes, depth_bytes;
  Forgetful memory;
  double bytes = 0.0;
  renderer.render(0, &view);  // warms caches and shaders
  for (const FrameJob& job : scenario.frames) {
    const FrameSeed seed{static_cast<std::uint64_t>(config.seed), static_cast<std::int64_t>(job.stop),
                         static_cast<std::int32_t>(job.camera)};
    const std::optional<DepthStream>& stream = scenario.rig.rig.cameras[job.camera].depth;
    const bool with_depth = stream && !job.files.depth_file.empty();
    scenario.world->place_robot(scenario.T_scene_robot[job.stop]);
    stages[0].time([&] { renderer.render_bare(job.camera); });
    stages[1].time([&] {
      renderer.render_moving(job.camera, color_exposure(scenario, job), depth_exposure(scenario, job), &view);
    });
    if (with_depth) {
      const Image8& looked_at = view.imager.empty() ? view.color : view.imager;
      stages[2].time([&] { sensors[job.camera].sense_depth(view.depth_m, looked_at, stream->unit_m, seed, &depth); });
    }
    stages[3].time([&] { sensors[job.camera].sense_color(seed, &view.color); });
    stages[4].time([&] { color_bytes = color_png.encode(view.color); });
    if (with_depth) stages[5].time([&] { depth_bytes = depth_png.encode(depth); });
    stages[6].time([&] {
      sha256_hex(color_bytes);
      sha256_hex(depth_bytes);
    });
    bytes += static_cast<double>(color_bytes.size() + depth_bytes.size());
    stages[7].time([&] { look_at(scenario.recording, {job.files, job.camera, view.color, depth}, &memory); });
  }
  const auto frames = static_cast<double>(scenario.frame_count());
  std::printf("%zu frames, %.2f MB each, drawn by %s\n", scenario.frame_count(), 1e-6 * bytes / frames,
              renderer.gl_renderer().c_str());
  for (const Stage& stage : stages)
    std::printf("  %-28s %7.2f ms a frame, %7.2f ms CPU\n", stage.name, 1e3 * stage.wall_s / frames,
                1e3 * stage.cpu_s / frames);
  std::fflush(stdout);
}

// World and viewpoints are worked out before. Few frames say what starting takes.
void print_workers(const GenerateConfig& config, const std::vector<int>& workers) {
  const Scenario scenario = resolve_scenario(config);
  const auto frames = static_cast<double>(scenario.frame_count());
  std::printf(
      "Of %zu frames so many a second, starts of the processes included: drawn and read, written, as observations\n",
      scenario.frame_count());
  for (const int count : workers) {
    const auto options_in = [&](const ScratchFolder& folder) {
      GenerateOptions options;
      options.output = folder.path() / "run";  // the folder itself is locked
      options.jobs = count;
      return options;
    };
    const double bare_s = seconds_of([&] { render_bare(scenario, count); });
    const double written_s = seconds_of([&] {
      const ScratchFolder folder("bench-frames");
      generate(scenario, options_in(folder));
    });
    const double observed_s = seconds_of([&] {
      const ScratchFolder folder("bench-frames");
      generate_observed(scenario, options_in(folder));
    });
    std::printf("  %3d processes: %7.1f %7.1f %7.1f\n", count, frames / bare_s, frames / written_s,
                frames / observed_s);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    auto [numbers, words, config] = parse_run_arguments(argc, argv);
    const int poses = numbers.empty() ? 40 : numbers.front();
    std::vector<int> workers(numbers.begin() + (numbers.empty() ? 0 : 1), numbers.end());
    if (workers.empty())
      for (int n = 1; n <= static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); n *= 2)
        workers.push_back(n);
    config.poses = poses;
    print_workers(config, workers);  // forks, so before this process has a context
    config.poses = std::min(poses, 20);
    print_stages(config);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
