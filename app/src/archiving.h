// A run as a few large files, from the command line.
#pragma once

#include <filesystem>
#include <string>

#include "terminal.h"

namespace rigproof {

/// Writes the archive of a run.
/// @return "912 files in 2 shards"
std::string write_shards(const std::filesystem::path& run, const std::filesystem::path& archive, int shard_mib,
                         ProgressLine* progress);

}  // namespace rigproof
