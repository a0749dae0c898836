// A run as a few large files: data sets of many frames are slow to copy, and to keep, file by file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

namespace rigproof {

inline constexpr const char* kArchiveLayout = "archive";

struct ArchiveOptions {
  std::uint64_t shard_bytes = std::uint64_t{1} << 30U;  ///< of files in a shard; a larger file has one of its own
  /// (files done, all); returns false to interrupt, which throws Error with ExitCode::kTryAgain.
  std::function<bool(std::size_t, std::size_t)> progress = {};
};

struct ArchiveReport {
  std::size_t files = 0;
  std::size_t shards = 0;
};

/// Writes every file below `from` into the new folder `to`, which appears whole or not at all: data-00000.tar.zst, ..,
/// what lies under truth/ in truth-00000.tar.zst, .., index.csv (shard, file, size and SHA-256) and SHA256SUMS. The
/// same files give the same bytes: sorted by path, without times and owners. Throws Error with every file that cannot
/// be archived: links, paths too long for tar, files of 8 GiB or more.
ArchiveReport write_archive(const std::filesystem::path& from, const std::filesystem::path& to,
                            const ArchiveOptions& options = {});

}  // namespace rigproof
