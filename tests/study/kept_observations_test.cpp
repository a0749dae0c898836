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

// A recording whose cameras and odometry are those of the observations.
Recording recording_of(const Observations& observations, Recording recording) {
  recording.folder = observations.source;
  recording.rig.cameras = observations.cameras;
  recording.rig.odometry_noise = observations.odometry_noise;
  recording.rig.accept = observations.accept;
  return recording;
}

TEST_F(KeptObservations, AreRecalledToTheByte) {
  const Recording monday = small_recording(scratch_ / "monday");
  const std::string key = key_of(monday);
  ASSERT_EQ(key.size(), 64U);
  const Recording recording = recording_of(some_observations(), monday);
  EXPECT_FALSE(recall_observations(key, recording));
  const std::string text = observations_text(some_observations());
  keep_observations(key, some_observations());
  const std::optional<Observations> known = recall_observations(key, recording);
  ASSERT_TRUE(known);
  EXPECT_EQ(observations_text(*known), text);
  EXPECT_EQ(key_of(load_recording(scratch_ / "monday")), key) << "of the same files";
  EXPECT_EQ(key_of(load_recording(scratch_ / "monday/./")), key) << "by another name of the folder";
  EXPECT_FALSE(recall_observations("", recording));
}

// Cameras of one sensor share errors; files do not name sensors that are files of their own.
TEST_F(KeptObservations, KnowTheSensorsOfTheRecording) {
  const Recording monday = small_recording(scratch_ / "monday");
  Recording recording = recording_of(some_observations(), monday);
  for (RigCamera& camera : recording.rig.cameras) camera.sensor = "/home/me/mine.yaml";
  Observations seen = some_observations();
  seen.cameras = recording.rig.cameras;
  const std::string key = key_of(monday);
  keep_observations(key, seen);
  const std::optional<Observations> known = recall_observations(key, recording);
  ASSERT_TRUE(known);
  for (const RigCamera& camera : known->cameras) EXPECT_EQ(camera.sensor, "/home/me/mine.yaml");
}

TEST_F(KeptObservations, EverythingThatDetectionDependsOnIsInTheKey) {
  const fs::path folder = scratch_ / "monday";
  const Recording recording = small_recording(folder);
  std::set<std::string> keys = {key_of(recording)};
  ObserveOptions options;
  options.use_depth = false;
  keys.insert(key_of(recording, options));
  options = {};
  options.stop_tolerance_s = 0.01;
  keys.insert(key_of(recording, options));
  options = {};
  options.max_odometry_gap_s = 0.3;
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
  other = recording;
  other.frames[0][1].stamp_s += 1e-6;
  keys.insert(key_of(other));
  other = recording;
  other.segments.push_back({kStraightSegment, 1.0, 2.0});
  keys.insert(key_of(other));
  EXPECT_EQ(keys.size(), 9U);
  // Another content of the same size, and with the old one's time.
  const fs::path image = folder / "right/color/000001.png";
  const fs::file_time_type time = fs::last_write_time(image);
  std::string bytes = read_text_file(image);
  bytes.front() ^= 1;
  scratch_.write("monday/right/color/000001.png", bytes);
  fs::last_write_time(image, time);
  keys.insert(key_of(recording));
  EXPECT_EQ(keys.size(), 10U);
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
  EXPECT_FALSE(recall_observations(key, recording)) << "damaged";
  ::setenv("RIGPROOF_OBSERVATIONS", scratch_.write("file", "no folder").c_str(), 1);
  EXPECT_NO_THROW(keep_observations(key, some_observations()));
  EXPECT_FALSE(recall_observations(key, recording));
  ::setenv("RIGPROOF_OBSERVATIONS", "", 1);
  EXPECT_EQ(key_of(recording), "");
}

TEST_F(KeptObservations, ThoseThatWereUsedLastStayAndNobodyElsesFilesGo) {
  const Observations observations = some_observations();
  const Recording recording = recording_of(observations, small_recording(scratch_ / "monday"));
  const fs::path folder = scratch_ / "cache";
  const fs::path others = scratch_.write("cache/precious.json", "{}");
  const auto key = [](int i) { return sha256_hex(std::to_string(i)); };
  const auto file = [&](int i) { return folder / (key(i) + ".observations"); };
  const auto made = [](int i) { return fs::file_time_type::clock::now() - std::chrono::hours(100 - i); };
  fs::last_write_time(others, made(-100));
  for (int i = 0; i < 63; ++i) {
    keep_observations(key(i), observations);
    fs::last_write_time(file(i), made(i));
  }
  EXPECT_TRUE(recall_observations(key(0), recording)) << "and so it is younger than the others";
  for (int i = 63; i < 66; ++i) {
    keep_observations(key(i), observations);
    fs::last_write_time(file(i), made(i));
  }
  keep_observations(key(99), observations);
  EXPECT_TRUE(recall_observations(key(99), recording));
  EXPECT_TRUE(recall_observations(key(0), recording));
  EXPECT_FALSE(recall_observations(key(1), recording));
  EXPECT_TRUE(recall_observations(key(65), recording));
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder)) ++count;
  EXPECT_EQ(count, 65U) << "64, and what is not ours";
  EXPECT_TRUE(fs::exists(others));
}

// Whoever runs the tests has recordings of their own.
TEST(KeptObservationsOfUsers, AreNoneOfTheTests) {
  if (std::getenv("CTEST_INTERACTIVE_DEBUG_MODE") == nullptr) GTEST_SKIP() << "not run by ctest";
  const char* folder = std::getenv("RIGPROOF_OBSERVATIONS");
  ASSERT_NE(folder, nullptr);
  EXPECT_STREQ(folder, "");
}

}  // namespace
}  // namespace rigproof
