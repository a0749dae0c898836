// A drive as a file: simulated once, and the same drive for whoever goes on with the run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "driven.h"
#include "scenario.h"

namespace rigproof {

/// SHA-256 of all that a drive depends on: program and MuJoCo, the configuration without its sense keys (but for the
/// rate of the odometry), and the files that it names.
std::string drive_key(const GenerateConfig& config, const std::vector<ScenarioInput>& inputs);

/// What is recorded of a drive, to the last bit: viewpoints, captures, odometry, trajectory. What went wrong on the way
/// is only counted.
std::string encode_drive(const DrivenViewpoints& driven, const std::string& key);
/// Nothing where the bytes are damaged or belong to another key.
std::optional<DrivenViewpoints> decode_drive(std::string_view bytes, const std::string& key);

/// Where the drive of a key is kept in a folder of clean renders.
std::filesystem::path drive_in_cache(const std::filesystem::path& cache, const std::string& key);
/// From the first of these files that holds the drive. Never throws for what it finds.
std::optional<DrivenViewpoints> find_drive(const std::vector<std::filesystem::path>& files, const std::string& key);

}  // namespace rigproof
