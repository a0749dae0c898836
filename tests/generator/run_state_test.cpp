#include "run_state.h"

#include <gtest/gtest.h>

#include "rigproof/core/files.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

FileEntries written_file(const RunFolder& run, int number) {
  const std::string path = "recording/left/color/" + std::to_string(number) + ".png", text = std::to_string(number);
  write_file_atomically_unsynced(run.root / path, text);
  return {{path, {text.size(), sha256_hex(text)}}};
}

// More is added while a write is under way, and after it.
TEST(ManifestKeeper, FinishWritesAllThatWasAddedAtAnyTime) {
  constexpr int kFiles = 300;
  const TempFolder folder;
  const RunFolder run{folder.path()};
  Manifest before;
  before.not_kept["recording/left/color/7.png"] = {1, std::string(64, 'a')};
  ManifestKeeper keeper(run, before);
  for (int i = 0; i < kFiles; ++i) {
    keeper.add(written_file(run, i));
    keeper.tick();
    if (i == kFiles / 2) keeper.set_gl_renderer("llvmpipe");
  }
  keeper.add_not_kept({{"recording/left/color/looked_at.png", {2, std::string(64, 'b')}}});
  EXPECT_EQ(keeper.gl_renderer(), "llvmpipe");
  keeper.finish(true);
  const Manifest manifest = load_manifest(run.manifest_file());
  EXPECT_TRUE(manifest.complete);
  EXPECT_EQ(manifest.gl_renderer, "llvmpipe");
  ASSERT_EQ(manifest.files.size(), static_cast<std::size_t>(kFiles));
  for (const auto& [path, entry] : manifest.files) EXPECT_EQ(entry.sha256, sha256_hex_of_file(run.root / path)) << path;
  // A picture that is kept now is no longer one that was not.
  ASSERT_EQ(manifest.not_kept.size(), 1U);
  EXPECT_EQ(manifest.not_kept.begin()->first, "recording/left/color/looked_at.png");
  EXPECT_EQ(keeper.manifest().files.size(), manifest.files.size());
}

// The first write begins at once; what it was given is on the disk before anything else is asked for.
TEST(ManifestKeeper, WritesBesideTheWork) {
  const TempFolder folder;
  const RunFolder run{folder.path()};
  {
    ManifestKeeper keeper(run, {});
    keeper.add(written_file(run, 0));
    keeper.tick();
    keeper.add(written_file(run, 1));
    keeper.tick();
  }
  const Manifest manifest = load_manifest(run.manifest_file());
  EXPECT_FALSE(manifest.complete);
  ASSERT_EQ(manifest.files.size(), 1U);
  EXPECT_EQ(manifest.files.begin()->first, "recording/left/color/0.png");
}

}  // namespace
}  // namespace rigproof
