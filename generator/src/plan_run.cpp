#include "rigproof/generator/plan_run.h"

#include "rigproof/core/error.h"
#include "scenario.h"
#include "sensing/resolve.h"
#include "told_odometry.h"

namespace rigproof {

PlannedRun plan_run(const GenerateConfig& config) {
  Scenario scenario = resolve_scenario(config);
  return {std::move(scenario.recording), std::move(scenario.truth)};
}

bool odometry_is_apart(const GenerateConfig& config) { return config.motion == "teleport"; }

void replace_odometry(const GenerateConfig& config, Recording* recording, Truth* truth) {
  if (!odometry_is_apart(config)) throw Error("motion " + config.motion + ": its odometry cannot be told anew");
  tell_odometry(config, load_rig_model(config.rig).robot, recording, truth);
  disturb_odometry_time(config.sensing.time, sensing_seed(config), recording, truth);
}

std::vector<std::string> run_inputs(const GenerateConfig& config) {
  std::vector<std::string> inputs;
  for (const ScenarioInput& input : scenario_inputs(config)) inputs.push_back(input.sha256 + " " + input.name);
  return inputs;
}

}  // namespace rigproof
