#include "archiving.h"

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/study/workflow/archive.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

bool contains(const fs::path& folder, const fs::path& other) {
  const fs::path inside = fs::weakly_canonical(other).lexically_relative(fs::weakly_canonical(folder));
  return !inside.empty() && *inside.begin() != "..";
}

}  // namespace

void check_archive(const fs::path& run, const fs::path& archive) {
  if (contains(run, archive) || contains(archive, run))
    throw Error("--archive: " + archive.string() + " must neither lie in the run " + run.string() + " nor hold it");
  if (fs::exists(fs::symlink_status(archive)) && !is_archive_of(run, archive))
    throw Error("--archive: " + archive.string() + " exists already and is no archive of " + run.string() +
                "; name a new folder");
}

bool is_archive_of(const fs::path& run, const fs::path& archive) {
  for (const fs::path& file : {archive / "SHA256SUMS", archive / "index.csv", run / "run.yaml"})
    if (!fs::is_regular_file(file)) return false;
  const std::string manifest = ",run.yaml,", index = read_text_file(archive / "index.csv");
  const std::string ending = "," + sha256_hex_of_file(run / "run.yaml") + "\n";
  const std::size_t at = index.find(manifest);
  return at != std::string::npos && index.find(ending, at) + ending.size() == index.find('\n', at) + 1;
}

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
