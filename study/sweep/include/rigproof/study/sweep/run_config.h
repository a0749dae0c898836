// The configuration of a run, as commands are given it: a file or preset, and overrides.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/generator/config.h"

namespace rigproof {

/// @param config a file, or the name of one that ships ("demo"); empty: all defaults
/// @param set FIELD=VALUE, as overrides.h has them
/// Throws Error with every problem, and for overrides of fields that are then not looked at.
GenerateConfig run_config(const std::string& config, const std::vector<std::string>& set);

/// Of a run (a folder), or a configuration, with other noise: an override of what would have to be rendered throws
/// Error.
GenerateConfig sense_config(const std::filesystem::path& source, const std::vector<std::string>& set);

}  // namespace rigproof
