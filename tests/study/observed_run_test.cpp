// Runs whose pictures are looked at in memory: the observations are those of the files.
#include "rigproof/study/sweep/observed_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/study/sweep/run_config.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::size_t kImages = 8;

class ObservedRunTest : public testing::TestWithParam<std::vector<std::string>> {
 protected:
  static GenerateConfig config(const std::vector<std::string>& more = {}) {
    std::vector<std::string> set = {"rig=husky_1x_d455", "poses=8", "image_scale=0.3", "board.place=scene",
                                    "viewpoints.planner=sampled"};
    set.insert(set.end(), more.begin(), more.end());
    return run_config("", set);
  }
  // The same folder for all: its name is part of observations.
  GenerateOptions options() const {
    GenerateOptions made;
    made.output = run_.root;
    made.jobs = 2;
    return made;
  }
  GenerateOptions interrupted_after(std::size_t images) const {
    GenerateOptions made = options();
    made.progress = [images](std::size_t done, std::size_t all) { return done < images || done == all; };
    return made;
  }
  ObservedRun observed(const GenerateConfig& config, const GenerateOptions& how) const {
    return generate_observed(*prepare_generation(config, how), how);
  }
  // observations.json by way of files, and the manifest of them.
  std::string by_files(const GenerateConfig& config) {
    generate(config, options());
    save_observations(observe(load_recording(run_.recording())), run_.observations_file());
    of_files_ = load_manifest(run_.manifest_file());
    const std::string text = read_text_file(run_.observations_file());
    fs::remove_all(run_.root);
    return text;
  }
  std::string observations_text() const { return read_text_file(run_.observations_file()); }

  TempFolder folder_;
  const RunFolder run_{folder_ / "run"};
  Manifest of_files_;
};

TEST_P(ObservedRunTest, GivesTheBytesThatFilesGive) {
  const std::string expected = by_files(config(GetParam()));
  observed(config(GetParam()), options());
  EXPECT_EQ(observations_text(), expected);
  EXPECT_THAT(expected, HasSubstr("inverse_depth_plane_per_m"));
}

INSTANTIATE_TEST_SUITE_P(Formats, ObservedRunTest,
                         testing::Values(std::vector<std::string>{"sensor_noise=none"},
                                         std::vector<std::string>{"sensor_noise=realistic"},
                                         std::vector<std::string>{"sensing.image.jpeg_quality=80"},
                                         std::vector<std::string>{"clouds=pcd"},
                                         std::vector<std::string>{"straight_drive.frames=4"}));

TEST_F(ObservedRunTest, KeepsHashesOfPicturesButNoPicture) {
  by_files(config());
  observed(config(), options());
  const Manifest manifest = load_manifest(run_.manifest_file());
  EXPECT_TRUE(manifest.complete);
  ASSERT_EQ(manifest.not_kept.size(), 2 * kImages) << "colour and depth";
  for (const auto& [path, entry] : manifest.not_kept) EXPECT_EQ(entry.sha256, of_files_.files.at(path).sha256) << path;
  for (const char* gone : {"recording", "findings"}) EXPECT_FALSE(fs::exists(run_.root / gone)) << gone;
  EXPECT_TRUE(fs::exists(run_.truth_file()));
}

TEST_F(ObservedRunTest, GoesOnWhereItWasInterrupted) {
  const std::string expected = by_files(config());
  try {
    observed(config(), interrupted_after(3));
    FAIL() << "was interrupted";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kTryAgain);
  }
  const std::size_t before = load_manifest(run_.manifest_file()).not_kept.size() / 2;
  EXPECT_GE(before, 3U);
  EXPECT_EQ(observed(config(), options()).report.images_rendered, kImages - before);
  EXPECT_EQ(observations_text(), expected);
  EXPECT_EQ(observed(config(), options()).report.images_rendered, 0U) << "all there";
}

TEST_F(ObservedRunTest, LooksAgainWhereFindingsAreLost) {
  const std::string expected = by_files(config());
  EXPECT_THROW(observed(config(), interrupted_after(3)), Error);
  fs::remove_all(run_.root / "findings");
  EXPECT_EQ(observed(config(), options()).report.images_rendered, kImages)
      << "those that were not done, then those that were lost";
  EXPECT_EQ(observations_text(), expected);
}

TEST_F(ObservedRunTest, ObservationsThatAreLostAreMadeAgain) {
  observed(config(), options());
  const std::string expected = observations_text();
  fs::remove(run_.observations_file());
  observed(config(), options());
  EXPECT_EQ(observations_text(), expected);
}

TEST_F(ObservedRunTest, LeavesARunWithPicturesAlone) {
  generate(config(), options());
  EXPECT_THAT(error_text([&] { observed(config(), options()); }), HasSubstr("holds a run with its pictures"));
  EXPECT_TRUE(fs::exists(run_.recording()));
}

TEST_F(ObservedRunTest, PicturesCanBeMadeAfterwards) {
  by_files(config());
  observed(config(), options());
  generate(config(), options());
  const Manifest manifest = load_manifest(run_.manifest_file());
  EXPECT_TRUE(manifest.not_kept.empty());
  for (const auto& [path, entry] : of_files_.files) EXPECT_EQ(manifest.files.at(path).sha256, entry.sha256) << path;
}

}  // namespace
}  // namespace rigproof
