#include "rigproof/study/workflow/archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../support/process.h"
#include "../support/run_contents.h"
#include "error_text.h"
#include "rigproof/core/error.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Names of more than 100 characters, an empty file, and sizes around tar's blocks.
fs::path sample_run(const fs::path& folder) {
  write_file_atomically(folder / "run.yaml", std::string("complete: true\n"));
  write_file_atomically(folder / "recording" / "empty.txt", std::string());
  for (const std::size_t size : {511U, 512U, 513U, 700000U})
    write_file_atomically(folder / "recording" / (std::to_string(size) + ".bin"), std::string(size, 'x'));
  write_file_atomically(folder / std::string(90, 'd') / (std::string(80, 'n') + ".png"), std::string("png"));
  write_file_atomically(folder / "truth" / "truth.yaml", std::string("seed: 7\n"));
  return folder;
}

void unpack(const fs::path& archive, const std::string& kind, const fs::path& into) {
  fs::create_directories(into);
  for (const auto& entry : fs::directory_iterator(archive)) {
    if (entry.path().filename().string().rfind(kind, 0) != 0) continue;
    const ProcessOutput tar = run_process({"tar", "--zstd", "-x", "-f", entry.path().string(), "-C", into.string()});
    ASSERT_EQ(tar.exit_code, 0) << tar.err;
    EXPECT_EQ(tar.err, "");
  }
}

TEST(Archive, UnpacksWithTarToTheSameFiles) {
  const TempFolder scratch;
  const fs::path run = sample_run(scratch / "run");
  const ArchiveReport report = write_archive(run, scratch / "archive", {1U << 19U, {}});
  EXPECT_EQ(report.files, 8U);
  EXPECT_EQ(report.shards, 4U) << "before the large file, it, after it, and the truth";
  unpack(scratch / "archive", "data-", scratch / "back");
  EXPECT_FALSE(fs::exists(scratch / "back" / "truth"));
  unpack(scratch / "archive", "truth-", scratch / "back");
  EXPECT_EQ(contents(scratch / "back"), contents(run));
  const ProcessOutput sums = run_process(
      {"sh", "-c", "cd \"$0\" && sha256sum --quiet --strict -c SHA256SUMS", (scratch / "archive").string()});
  EXPECT_EQ(sums.exit_code, 0) << sums.out << sums.err;
  EXPECT_THAT(read_text_file(scratch / "archive" / "index.csv"),
              HasSubstr("truth-00000.tar.zst,truth/truth.yaml,8," + sha256_hex("seed: 7\n") + "\n"));
}

TEST(Archive, TheSameFilesGiveTheSameBytes) {
  const TempFolder scratch;
  write_archive(sample_run(scratch / "one"), scratch / "first");
  const fs::path copy = sample_run(scratch / "two");
  fs::permissions(copy / "run.yaml", fs::perms::owner_all);
  fs::last_write_time(copy / "run.yaml", fs::file_time_type::clock::now() - std::chrono::hours(48));
  write_archive(copy, scratch / "second");
  EXPECT_EQ(contents(scratch / "first"), contents(scratch / "second"));
}

TEST(Archive, LeavesNothingWhenItIsInterrupted) {
  const TempFolder scratch;
  ArchiveOptions options;
  options.progress = [](std::size_t done, std::size_t) { return done < 3; };
  const fs::path run = sample_run(scratch / "run");
  EXPECT_THROW(write_archive(run, scratch / "archive", options), Error);
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch.path()), fs::directory_iterator()), 1) << "the run alone";
}

TEST(Archive, NamesEveryFileThatItCannotHold) {
  const TempFolder scratch;
  const fs::path run = sample_run(scratch / "run");
  fs::create_symlink("/etc/hostname", run / "link");
  write_file_atomically(run / (std::string(120, 'l') + ".png"), std::string("png"));
  const std::string error = error_text([&] { write_archive(run, scratch / "archive"); });
  EXPECT_THAT(error, HasSubstr("link: is no regular file"));
  EXPECT_THAT(error, HasSubstr("path is too long"));
  EXPECT_FALSE(fs::exists(scratch / "archive"));
  fs::create_directories(scratch / "taken" / "something");
  EXPECT_THAT(error_text([&] { write_archive(sample_run(scratch / "other"), scratch / "taken"); }),
              HasSubstr("something already"));
}

}  // namespace
}  // namespace rigproof
