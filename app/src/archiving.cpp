#include "archiving.h"

#include "rigproof/study/workflow/archive.h"

namespace rigproof {

std::string write_shards(const std::filesystem::path& run, const std::filesystem::path& archive, int shard_mib,
                         ProgressLine* progress) {
  ArchiveOptions options;
  options.shard_bytes = static_cast<std::uint64_t>(shard_mib) << 20U;
  options.progress = progress->callback();
  const ArchiveReport report = write_archive(run, archive, options);
  return std::to_string(report.files) + " files in " + std::to_string(report.shards) +
         (report.shards == 1 ? " shard" : " shards");
}

}  // namespace rigproof
