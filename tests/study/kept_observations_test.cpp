#include "rigproof/study/workflow/kept_observations.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <set>

#include "rigproof/core/files.h"
#include "rigproof/core/observations_text.h"
#include "rigproof/geometric/geometric.h"
#include "small_recording.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

class KeptObservations : public testing::Test {
 protected:
  KeptObservations() { ::setenv("RIGPROOF_OBSERVATIONS", (scratch_ / "cache").c_str(), 1); }
  ~KeptObservations() override { ::setenv("RIGPROOF_OBSERVATIONS", "", 1); }

  // As of a minute later, when every file has settled.
  static std::string key_of(const Recording& recording, const ObserveOptions& options = {}) {
    return observations_key(recording, options, std::time(nullptr) + 60);
  }
  static Observations some_observations() {
    GeometricConfig config;
    config.stops = 3;
    return draw_geometric_run(config).observations;
  }

  TempFolder scratch_;
};

TEST_F(KeptObservations, AreRecalledToTheByte) {
  const std::string key = key_of(small_recording(scratch_ / "monday"));
  ASSERT_EQ(key.size(), 64U);
  EXPECT_FALSE(recall_observations(key));
  const std::string text = observations_text(some_observations());
  keep_observations(key, some_observations());
  const std::optional<Observations> known = recall_observations(key);
  ASSERT_TRUE(known);
  EXPECT_EQ(observations_text(*known), text);
  EXPECT_EQ(key_of(load_recording(scratch_ / "monday")), key) << "of the same files";
  EXPECT_FALSE(recall_observations(""));
}

TEST_F(KeptObservations, EverythingThatDetectionDependsOnIsInTheKey) {
  const fs::path folder = scratch_ / "monday";
  const Recording recording = small_recording(folder);
  std::set<std::string> keys = {key_of(recording)};
  ObserveOptions options;
  options.use_depth = false;
  keys.insert(key_of(recording, options));
  Recording other = recording;
  other.rig.board.square_m *= 1.001;
  keys.insert(key_of(other));
  other = recording;
  other.odometry.back().yaw_rad += 1e-9;
  keys.insert(key_of(other));
  other = recording;
  other.frames[1].pop_back();
  keys.insert(key_of(other));
  EXPECT_EQ(keys.size(), 5U);
  // Another content of the same size, and with the old one's time.
  const fs::path image = folder / "right/color/000001.png";
  const fs::file_time_type time = fs::last_write_time(image);
  std::string bytes = read_text_file(image);
  bytes.front() ^= 1;
  scratch_.write("monday/right/color/000001.png", bytes);
  fs::last_write_time(image, time);
  keys.insert(key_of(recording));
  EXPECT_EQ(keys.size(), 6U);
  fs::remove(folder / "left/depth/000002.png");
  EXPECT_EQ(key_of(recording), "") << "of a file that is not there";
}

TEST_F(KeptObservations, FilesThatHaveJustChangedAreLookedAtAgain) {
  const Recording recording = small_recording(scratch_ / "monday");
  EXPECT_EQ(observations_key(recording, {}), "");
}

TEST_F(KeptObservations, NothingIsKeptWhereNobodyWantsItOrItCannotBe) {
  const Recording recording = small_recording(scratch_ / "monday");
  const std::string key = key_of(recording);
  keep_observations(key, some_observations());
  fs::path kept;
  for (const auto& entry : fs::recursive_directory_iterator(scratch_ / "cache"))
    if (entry.is_regular_file()) kept = entry.path();
  ASSERT_FALSE(kept.empty());
  scratch_.write("cache/" + kept.filename().string(), "{\"version\": 1, \"stops\": [");
  EXPECT_FALSE(recall_observations(key)) << "damaged";
  ::setenv("RIGPROOF_OBSERVATIONS", scratch_.write("file", "no folder").c_str(), 1);
  EXPECT_NO_THROW(keep_observations(key, some_observations()));
  EXPECT_FALSE(recall_observations(key));
  ::setenv("RIGPROOF_OBSERVATIONS", "", 1);
  EXPECT_EQ(key_of(recording), "");
}

TEST_F(KeptObservations, TheNewestStay) {
  const Observations observations = some_observations();
  const fs::path folder = scratch_ / "cache";
  for (int i = 0; i < 66; ++i) {
    const std::string key = "key" + std::to_string(i);
    keep_observations(key, observations);
    fs::last_write_time(folder / (key + ".json"), fs::file_time_type::clock::now() - std::chrono::hours(100 - i));
  }
  keep_observations("last", observations);
  EXPECT_TRUE(recall_observations("last"));
  EXPECT_FALSE(recall_observations("key0"));
  EXPECT_TRUE(recall_observations("key65"));
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder)) ++count;
  EXPECT_EQ(count, 64U);
}

}  // namespace
}  // namespace rigproof
