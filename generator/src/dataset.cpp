#include "rigproof/generator/dataset.h"

#include <algorithm>
#include <filesystem>

#include "rigproof/core/error.h"
#include "rigproof/sim/models.h"

namespace rigproof {
namespace {

// A world may be given as a file; its folder shall not become part of the run's.
std::string short_name(const std::string& scene) { return std::filesystem::path(scene).stem().string(); }

}  // namespace

std::vector<GenerateConfig> runs_of(const GenerateConfig& config) {
  if (config.scenes.empty()) return {config};
  Problems problems;
  std::vector<std::string> names;
  std::vector<GenerateConfig> runs;
  for (std::size_t i = 0; i < config.scenes.size(); ++i) {
    const std::string& scene = config.scenes[i];
    const std::string field = "scenes[" + std::to_string(i) + "]";
    try {
      load_scene_model(scene);
    } catch (const Error& error) {
      problems.add({"", 0, field, "", error.what()});
    }
    if (std::find(names.begin(), names.end(), short_name(scene)) != names.end())
      problems.add({"", 0, field, scene, "is in the list twice"});
    names.push_back(short_name(scene));
    GenerateConfig run = config;
    run.scenes.clear();
    run.scene = scene;
    run.name = config.name + "/" + names.back();
    run.seed = config.seed + static_cast<std::int64_t>(i);
    runs.push_back(std::move(run));
  }
  problems.throw_if_any();
  return runs;
}

}  // namespace rigproof
