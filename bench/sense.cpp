// CPU time that a frame of colour and depth takes from the cache of clean renders to the files, by what is simulated.
// What a run takes whatever its length (world, viewpoints) is measured by itself and taken off.
// The goal is 50 ms a frame of 1280x720.
//
//   bench_sense [POSES=20 [CASE]]     CASE: one of those that it prints, for a profiler
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "clocks.h"
#include "rigproof/core/error.h"
#include "rigproof/generator/generate.h"
#include "rigproof/study/workflow/scratch_folder.h"

namespace {

namespace fs = std::filesystem;
using namespace rigproof;

const char* const kAsByDefault = "as by default";
const char* const kImageEffects = "image: {pixel_pattern: true, vignetting: true}";
const char* const kDepthEffects =
    "depth: {coarse_noise: true, bias_field: true, occlusion: true, edges: true, texture_holes: true}";

const std::vector<std::pair<std::string, std::string>>& cases() {
  static const std::vector<std::pair<std::string, std::string>> list = {
      {"clean", "sensor_noise: none\n"},
      {"noise", ""},
      {"image effects", std::string("sensing: {") + kImageEffects + "}\n"},
      {"depth effects", std::string("sensing: {") + kDepthEffects + "}\n"},
      {"all of these", std::string("sensing: {") + kImageEffects + ", " + kDepthEffects + "}\n"},
      {"as JPEG", "sensing: {image: {jpeg_quality: 90}}\n"},
      {"demosaicing", "sensing: {image: {demosaicing: true}}\n"},
      {"sharpening", "sensing: {image: {sharpening: true}}\n"},
      {"defocus", "sensing: {image: {defocus_sigma_px: 0.3}}\n"},
      {kAsByDefault, ""}};
  return list;
}

void measure(const std::string& poses, const std::string& only, const fs::path& folder) {
  GenerateOptions options;
  options.jobs = 1;
  options.cache = folder / "cache";
  options.output = folder / "run";
  double start = cpu_s();
  const GenerateReport rendered = generate(parse_generate_config(poses, "bench"), options);
  const double images = static_cast<double>(rendered.images);
  std::printf("%-16s %6.1f ms CPU a frame, viewpoints and drawing included\n", "rendered",
              1e3 * (cpu_s() - start) / images);
  options.render = false;
  start = cpu_s();
  plan_generation(parse_generate_config(poses, "bench"));
  const double plan_s = cpu_s() - start;
  std::printf("%-16s %6.1f ms CPU a run\n", "planned", 1e3 * plan_s);
  for (const auto& [name, text] : cases()) {
    if (!only.empty() && only != name) continue;
    options.output = folder / "sensed";
    start = cpu_s();
    GenerateConfig config = parse_generate_config(poses + text, "bench");
    if (name == kAsByDefault) config.sensing = SensingConfig();
    generate(config, options);
    std::printf("%-16s %6.1f ms CPU a frame from the cache\n", name.c_str(), 1e3 * (cpu_s() - start - plan_s) / images);
    std::fflush(stdout);
    fs::remove_all(options.output);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const ScratchFolder folder("bench-sense");
    measure("include: plain.yaml\nposes: " + std::string(argc > 1 ? argv[1] : "20") + "\n", argc > 2 ? argv[2] : "",
            folder.path());
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
