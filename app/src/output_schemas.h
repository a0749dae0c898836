// JSON Schemas of what commands print with --json.
#pragma once

#include <string>

namespace rigproof {

std::string calibrate_output_schema();
std::string validate_output_schema();
std::string observe_output_schema();
std::string moved_output_schema();
std::string suggest_output_schema();

}  // namespace rigproof
