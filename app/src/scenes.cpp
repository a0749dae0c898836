// `rigproof scenes`: lists the worlds, or generates a little of some of them and says how they do.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "json_text.h"
#include "rigproof/core/error.h"
#include "rigproof/sim/models.h"
#include "rigproof/study/report/check_scene.h"
#include "terminal.h"

namespace rigproof {
namespace {

nlohmann::json json_of(const SceneCheck& check) {
  return {{"name", check.name},
          {"planned_board_whole_share", check.planned_whole_share},
          {"planned_board_at_every_stop", check.planned_board_everywhere},
          {"boards_visible", check.boards_visible},
          {"boards_found", check.boards_found},
          {"depth_images", check.depth_images},
          {"grounds_found", check.grounds_found},
          {"worst_normal_deg", check.worst_normal_deg},
          {"worst_height_mm", check.worst_height_mm},
          {"least_floor_share", check.least_floor_share},
          {"keypoints", check.keypoints},
          {"good", check.ground_is_good() && check.board_is_good()}};
}

SceneCheck check_with_progress(const ScenesArguments& arguments, const std::string& scene, const Terminal& terminal) {
  SceneCheckOptions options;
  options.poses = arguments.poses;
  options.jobs = arguments.common.jobs;
  options.device = arguments.device;
  ProgressLine progress(terminal, scene, "images");
  options.progress = progress.callback();
  return check_scene(scene, options);
}

}  // namespace

int scenes_command(const ScenesArguments& arguments) {
  if (arguments.scenes.empty() && arguments.output.empty()) return list_command(arguments.common, "scenes");
  const std::vector<std::string> scenes = arguments.scenes.empty() ? scene_model_names() : arguments.scenes;
  for (const std::string& scene : scenes) load_scene_model(scene);  // a mistake in the last is told before the first
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  std::vector<SceneCheck> checks;
  bool all_good = true;
  for (const std::string& scene : scenes) {
    checks.push_back(check_with_progress(arguments, scene, terminal));
    all_good = all_good && checks.back().ground_is_good() && checks.back().board_is_good();
  }
  if (!arguments.output.empty()) write_scenes_picture(checks, arguments.output);
  if (arguments.common.json) {
    nlohmann::json json = nlohmann::json::array();
    for (const SceneCheck& check : checks) json.push_back(json_of(check));
    std::puts(json_text(json).c_str());
  }
  terminal.text(format_checks(checks));
  if (!arguments.output.empty()) terminal.line("picture    " + arguments.output.string());
  return static_cast<int>(all_good ? ExitCode::kGood : ExitCode::kGateFailed);
}

}  // namespace rigproof
