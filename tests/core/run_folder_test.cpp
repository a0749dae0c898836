#include "rigproof/core/run_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "sample_data.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

TEST(Manifest, RoundTripKeepsEveryValueAndEveryByte) {
  const TempFolder folder;
  Manifest manifest = sample_manifest();
  for (const bool complete : {false, true}) {
    manifest.complete = complete;
    save_manifest(manifest, folder / "a.yaml");
    const Manifest again = load_manifest(folder / "a.yaml");
    EXPECT_EQ(again.complete, complete);
    EXPECT_EQ(again.gl_renderer, manifest.gl_renderer);
    EXPECT_EQ(again.config_sha256, manifest.config_sha256);
    ASSERT_EQ(again.files.size(), 2U);
    EXPECT_EQ(again.files.at("recording/left/color/000000.png").size_bytes, 123456789012ULL);
    save_manifest(again, folder / "b.yaml");
    EXPECT_EQ(folder.read("a.yaml"), folder.read("b.yaml"));
  }
}

TEST(Manifest, ProblemsAreNamed) {
  const TempFolder folder;
  const auto problems = [&](const std::string& text) {
    folder.write("run.yaml", text);
    return error_text([&] { load_manifest(folder / "run.yaml"); });
  };
  EXPECT_THAT(problems("format: rigproof-run\nversion: 1\nstate: half\nfiles: {a: {size_bytes: -1, sha256: xyz}}\n"),
              testing::AllOf(HasSubstr("run.yaml:3: state: half: must be one of complete, partial"),
                             HasSubstr("files.a.size_bytes: -1: allowed is 0 to"),
                             HasSubstr("files.a.sha256: xyz: must be 64 hexadecimal digits")));
  EXPECT_THAT(problems(""), HasSubstr("state: is missing"));
}

}  // namespace
}  // namespace rigproof
