#include "rigproof/validate/integrity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using Kind = IntegrityProblem::Kind;
namespace fs = std::filesystem;

class IntegrityTest : public testing::Test {
 protected:
  IntegrityTest() {
    add("recording/rig.yaml", "rig: yes\n");
    add("recording/left/color/000000.png", std::string(5000, 'p'));
    add("recording/left/color/000001.png", std::string(5000, 'q'));
    add("truth/truth.yaml", "truth\n");
    manifest_.complete = true;
    save();
  }

  void add(const std::string& file, const std::string& bytes) {
    write_file_atomically(run_.root / file, bytes);
    manifest_.files[file] = {bytes.size(), sha256_hex(bytes)};
  }
  void save() { save_manifest(manifest_, run_.manifest_file()); }

  const TempFolder folder_;
  const RunFolder run_{folder_.path()};
  Manifest manifest_;
};

TEST_F(IntegrityTest, AnUntouchedRunIsIntact) {
  const IntegrityReport report = verify_manifest(run_);
  EXPECT_TRUE(report.intact()) << report.text();
  EXPECT_EQ(report.files, 4U);
  EXPECT_EQ(report.bytes, 10015U);
  EXPECT_EQ(report.text(), "4 files, .010 MB: all as generated\n");
}

TEST_F(IntegrityTest, EveryKindOfTamperingIsFound) {
  fs::remove(run_.root / "recording/rig.yaml");
  std::string bytes(5000, 'p');
  bytes[2500] = 'P';
  write_file_atomically(run_.root / "recording/left/color/000000.png", bytes);
  write_file_atomically(run_.root / "recording/left/color/000001.png", std::string(1200, 'q'));
  write_file_atomically(run_.root / "recording/left/color/000002.png", std::string("new"));
  const IntegrityReport report = verify_manifest(run_);
  ASSERT_EQ(report.problems.size(), 4U) << report.text();
  EXPECT_EQ(report.problems[0].text(),
            "recording/left/color/000000.png: altered: same size, other content (SHA-256 differs)");
  EXPECT_EQ(report.problems[1].text(),
            "recording/left/color/000001.png: truncated or replaced: 1,200 bytes, 5,000 in the manifest");
  EXPECT_EQ(report.problems[2].kind, Kind::kExtra);
  EXPECT_EQ(report.problems[3].kind, Kind::kMissing);
  EXPECT_THAT(report.text(), testing::HasSubstr("1 missing, 2 altered, 1 extra"));
}

TEST_F(IntegrityTest, TheProofIsMadeLater) {
  write_file_atomically(run_.proof_file(), std::string("passed: true\n"));
  EXPECT_TRUE(verify_manifest(run_).intact());
}

TEST_F(IntegrityTest, AnUnfinishedRunIsTold) {
  manifest_.complete = false;
  save();
  const IntegrityReport report = verify_manifest(run_);
  ASSERT_EQ(report.problems.size(), 1U);
  EXPECT_EQ(report.problems[0].kind, Kind::kUnfinished);
}

TEST_F(IntegrityTest, PathsThatLeaveTheRunAreNotFollowed) {
  manifest_.files["../outside"] = {1, std::string(64, '0')};
  try {
    save();
    const IntegrityReport report = verify_manifest(run_);
    ASSERT_EQ(report.problems.size(), 1U);
    EXPECT_EQ(report.problems[0].kind, Kind::kUnreadable);
  } catch (const Error& error) {  // refusing the manifest as a whole is as good
    EXPECT_THAT(error.what(), testing::HasSubstr("outside"));
  }
}

TEST_F(IntegrityTest, WithoutAManifestThereIsAnError) {
  fs::remove(run_.manifest_file());
  EXPECT_THROW(verify_manifest(run_), Error);
}

}  // namespace
}  // namespace rigproof
