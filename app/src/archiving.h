// A run as a few large files, from the command line.
#pragma once

#include <filesystem>
#include <string>

#include "terminal.h"

namespace rigproof {

/// Throws Error where an archive of the run cannot be made: the folder exists already and is none of it, or one of the
/// two would lie in the other.
void check_archive(const std::filesystem::path& run, const std::filesystem::path& archive);
/// Whether a run that is there is what a whole archive holds.
bool is_archive_of(const std::filesystem::path& run, const std::filesystem::path& archive);

/// Writes the archive of a run.
/// @return "912 files in 2 shards"
std::string write_shards(const std::filesystem::path& run, const std::filesystem::path& archive, int shard_mib,
                         ProgressLine* progress);

}  // namespace rigproof
