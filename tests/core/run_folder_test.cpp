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

// As it always was: a run that somebody keeps is compared by its bytes.
TEST(Manifest, IsWrittenInTheseBytes) {
  const TempFolder folder;
  Manifest manifest;
  manifest.tool_version = "0.1.0+ab";
  manifest.gl_renderer = "a: b";
  manifest.mujoco_version = "2.2.2";
  manifest.config_sha256 = std::string(64, 'a');
  save_manifest(manifest, folder / "empty.yaml");
  const std::string head =
      "format: rigproof-run\nversion: 1\ntool_version: \"0.1.0+ab\"\ngl_renderer: \"a: b\"\n"
      "mujoco_version: \"2.2.2\"\nconfig_sha256: " +
      manifest.config_sha256 + "\nstate: partial\n";
  EXPECT_EQ(folder.read("empty.yaml"), head + "files: {}\n");
  const std::string letters(64, 'b'), digits(64, '0');
  manifest.files["recording/rig.yaml"] = {5, letters};
  manifest.files["recording/\"left\", #1.png"] = {123456789012ULL, digits};
  manifest.not_kept["1.png"] = {7, letters};
  save_manifest(manifest, folder / "full.yaml");
  EXPECT_EQ(folder.read("full.yaml"),
            head + "files:\n  \"recording/\\\"left\\\", #1.png\": {size_bytes: 123456789012, sha256: \"" + digits +
                "\"}\n  recording/rig.yaml: {size_bytes: 5, sha256: " + letters +
                "}\nnot_kept:\n  \"1.png\": {size_bytes: 7, sha256: " + letters + "}\n");
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
