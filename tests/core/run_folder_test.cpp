#include "rigproof/core/run_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "sample_data.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

TEST(RunFolder, InputsAreToldByTheirShape) {
  const TempFolder folder;
  folder.write("run/run.yaml", "");
  folder.write("bare/recording/rig.yaml", "");
  folder.write("monday/rig.yaml", "");
  folder.write("memroc/CalibrationInfo.yaml", "");
  folder.write("o/observations.json", "");
  EXPECT_EQ(classify_input(folder / "run"), InputKind::kRun);
  EXPECT_EQ(classify_input(folder / "bare"), InputKind::kRun) << "a run whose manifest is lost";
  EXPECT_EQ(classify_input(folder / "monday"), InputKind::kRecording);
  EXPECT_EQ(classify_input(folder / "memroc"), InputKind::kMemrocLayout);
  EXPECT_EQ(classify_input(folder / "o"), InputKind::kObservations);
  EXPECT_EQ(classify_input(folder / "o/observations.json"), InputKind::kObservations);
}

TEST(RunFolder, WhatIsNoInputSaysWhatWasLookedForAndFound) {
  const TempFolder folder;
  folder.write("photos/a.png", "");
  folder.write("photos/b.png", "");
  const std::string text = error_text([&] { classify_input(folder / "photos"); });
  EXPECT_THAT(text, HasSubstr("run.yaml (a run), rig.yaml (a recording), CalibrationInfo.yaml (the MEMROC layout) and "
                              "observations.json were looked for; the folder holds a.png, b.png"));
  std::filesystem::create_directory(folder / "empty");
  EXPECT_THAT(error_text([&] { classify_input(folder / "empty"); }), HasSubstr("the folder is empty"));
  EXPECT_THAT(error_text([&] { classify_input(folder / "none"); }), HasSubstr("none: no such file or folder"));
  EXPECT_THAT(error_text([&] { classify_input(folder / "photos/a.png"); }), HasSubstr("observations (.json)"));
  folder.write("monday/rig.yaml", "");
  EXPECT_THAT(error_text([&] { classify_input(folder / "monday/rig.yaml"); }),
              HasSubstr("give the folder that holds this file"));
}

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
