// JSON Schemas of robots, simulated rigs and scenes.
#pragma once

#include <string>

namespace rigproof {

std::string robot_schema();      ///< models/robots/NAME.yaml
std::string rig_model_schema();  ///< models/rigs/NAME.yaml
std::string scene_schema();      ///< scenes/NAME.yaml

}  // namespace rigproof
