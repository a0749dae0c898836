// JSON Schemas of the files of a run, made from the descriptions that read and write them.
#pragma once

#include <string>

#include "rigproof/core/fields.h"

namespace rigproof {

std::string rig_schema();  ///< rig.yaml of a recording
/// models/sensors/NAME.yaml. @param simulation describes its block `simulation`, which only a simulator knows
std::string sensor_schema(const VisitFields& simulation);
std::string board_schema();         ///< models/boards/NAME.yaml
std::string observations_schema();  ///< observations.json
std::string result_schema();        ///< results/METHOD.yaml
std::string manifest_schema();      ///< run.yaml of a run

}  // namespace rigproof
