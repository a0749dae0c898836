#include "unused_overrides.h"

#include <algorithm>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

struct UsedWhen {
  const char* needs;  ///< in words of the configuration
  bool (*is_used)(const GenerateConfig& config);
  std::vector<std::string> fields;  ///< with all below them
};

const std::vector<UsedWhen>& conditions() {
  using Config = const GenerateConfig&;
  static const std::vector<UsedWhen> all = {
      {"board.place=given",
       [](Config c) { return c.board.place == "given"; },
       {"board.x_m", "board.y_m", "board.z_m", "board.facing_deg", "board.lean_deg", "board.roll_deg"}},
      {"viewpoints.planner=covering or sampled",
       [](Config c) { return c.viewpoints.draws(); },
       {"poses", "viewpoints.distance_m", "viewpoints.bearing_deg", "viewpoints.max_candidates"}},
      {"viewpoints.planner=sampled",
       [](Config c) { return c.viewpoints.planner == "sampled"; },
       {"viewpoints.heading_deg", "viewpoints.all_cameras_share"}},
      {"viewpoints.planner=grid", [](Config c) { return c.viewpoints.planner == "grid"; }, {"viewpoints.grid"}},
      {"viewpoints.planner=list",
       [](Config c) { return c.viewpoints.planner == "list"; },
       {"viewpoints.list", "viewpoints.list_frame"}},
      {"odometry.model=thrun", [](Config c) { return c.odometry.model == "thrun"; }, {"odometry.thrun"}},
      {"odometry.model=wheels", [](Config c) { return c.odometry.model == "wheels"; }, {"odometry.wheels"}},
      {"motion=drive", [](Config c) { return c.motion == "drive"; }, {"drive"}},
      {"motion=teleport", [](Config c) { return c.motion == "teleport"; }, {"stop_period_s"}},
      {"motion=drive and drive.capture=moving",
       [](Config c) { return c.moves_while_exposing(); },
       {"render.motion_blur", "render.rolling_shutter", "render.exposure_ms", "render.readout_ms", "render.max_parts"}},
  };
  return all;
}

bool covers(const std::string& field, const std::string& set) { return set == field || set.rfind(field + ".", 0) == 0; }

}  // namespace

void refuse_unused(const std::vector<std::string>& overrides, const GenerateConfig& config) {
  Problems problems;
  for (const std::string& text : overrides) {
    const std::size_t equals = text.find('=');
    const std::string set = text.substr(0, equals);
    for (const UsedWhen& condition : conditions())
      if (!condition.is_used(config) && std::any_of(condition.fields.begin(), condition.fields.end(),
                                                    [&set](const auto& field) { return covers(field, set); }))
        problems.add({"--set", 0, set, text.substr(equals + 1), std::string("is not used without ") + condition.needs});
  }
  problems.throw_if_any();
}

}  // namespace rigproof
