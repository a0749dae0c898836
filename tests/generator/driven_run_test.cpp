// A driven run on disk: driven once, whatever happens afterwards.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <thread>

#include "drive_store.h"
#include "error_text.h"
#include "rigproof/core/child_process.h"
#include "rigproof/core/random.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/generator/generate.h"
#include "run_contents.h"
#include "tiny_world.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const TinyWorld& world() {
  static const TinyWorld* const tiny = new TinyWorld;
  return *tiny;
}

GenerateConfig driven_config(const std::string& more = "") {
  return parse_generate_config("include: plain.yaml\nscene: " + world().scene() +
                                   "\nrig: husky_1x_d455\nimage_scale: 0.1\nmotion: drive\nviewpoints: {planner: list, "
                                   "list: [{x_m: 1, y_m: -1, yaw_deg: 0}, {x_m: 1.6, y_m: -0.8, yaw_deg: 20}, "
                                   "{x_m: 1.2, y_m: 0.2, yaw_deg: 5}]}\n" +
                                   more,
                               "driven.yaml");
}

// Counts how often it hears of the way.
GenerateOptions into(const fs::path& folder, std::size_t* heard = nullptr) {
  GenerateOptions options;
  options.output = folder;
  options.jobs = 1;
  if (heard != nullptr) options.on_the_way = [heard](std::size_t, std::size_t) { return ++*heard > 0; };
  return options;
}

const std::map<std::string, std::string>& reference() {
  static const std::map<std::string, std::string> hashes = [] {
    const TempFolder folder;
    generate(driven_config(), into(folder / "run"));
    return contents(folder / "run");
  }();
  return hashes;
}

TEST(DrivenRun, ItsDriveIsAFileOfTheRun) {
  const TempFolder folder;
  std::size_t heard = 0;
  generate(driven_config(), into(folder / "run", &heard));
  EXPECT_EQ(heard, 2U) << "once before each way";
  const Manifest manifest = load_manifest(folder / "run/run.yaml");
  EXPECT_EQ(manifest.files.count("truth/drive.bin"), 1U);
  EXPECT_EQ(contents(folder / "run"), reference());
}

TEST(DrivenRun, InterruptedOnTheWayNothingIsWrittenAndItStartsAgain) {
  const TempFolder folder;
  GenerateOptions options = into(folder / "run");
  options.on_the_way = [](std::size_t reached, std::size_t all) {
    EXPECT_EQ(all, 3U);
    return reached < 2;
  };
  try {
    generate(driven_config(), options);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kTryAgain);
    EXPECT_THAT(error.what(), HasSubstr("interrupted while driving"));
  }
  EXPECT_FALSE(fs::exists(folder / "run"));
  generate(driven_config(), into(folder / "run"));
  EXPECT_EQ(contents(folder / "run"), reference());
}

TEST(DrivenRun, InterruptedAmongItsImagesItDoesNotDriveAgain) {
  const TempFolder folder;
  GenerateOptions options = into(folder / "run");
  options.progress = [](std::size_t done, std::size_t) { return done < 1; };
  EXPECT_FALSE(generate(driven_config(), options).complete);
  std::size_t heard = 0;
  EXPECT_TRUE(generate(driven_config(), into(folder / "run", &heard)).complete);
  EXPECT_EQ(heard, 0U);
  EXPECT_EQ(contents(folder / "run"), reference());
}

TEST(DrivenRun, KilledAtAnyMomentItResumesToTheSameBytes) {
  const auto start = std::chrono::steady_clock::now();
  reference();
  const double whole_s = std::max(0.3, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  RandomStream random(5, "kill");
  for (int trial = 0; trial < 3; ++trial) {
    const TempFolder folder;
    ChildProcess generation([&] { return generate(driven_config(), into(folder / "run")).complete ? 0 : 1; });
    std::this_thread::sleep_for(std::chrono::duration<double>(random.uniform() * std::min(whole_s, 2.0)));
    generation.kill_all();
    generation.wait();
    EXPECT_TRUE(generate(driven_config(), into(folder / "run")).complete);
    EXPECT_EQ(contents(folder / "run"), reference()) << "trial " << trial;
  }
}

TEST(DrivenRun, ADamagedDriveIsDrivenAgain) {
  const TempFolder folder;
  generate(driven_config(), into(folder / "run"));
  const RunFolder run{folder / "run"};
  std::vector<std::uint8_t> bytes = read_binary_file(run.drive_file());
  bytes[bytes.size() / 2] = static_cast<std::uint8_t>(bytes[bytes.size() / 2] ^ 1U);
  write_file_atomically(run.drive_file(), bytes);
  fs::remove(run.recording() / "odometry.csv");
  std::size_t heard = 0;
  generate(driven_config(), into(run.root, &heard));
  EXPECT_GT(heard, 0U);
  EXPECT_EQ(contents(run.root), reference());
}

TEST(DrivenRun, OtherNoiseOfTheSameRendersDrivesNoMore) {
  const TempFolder folder;
  GenerateOptions options = into(folder / "run");
  options.cache = folder / "cache";
  generate(driven_config(), options);
  std::size_t heard = 0;
  GenerateOptions sensed = into(folder / "sensed", &heard);
  sensed.cache = options.cache;
  sensed.render = false;
  generate(driven_config("sensing: {seed: 9}"), sensed);
  EXPECT_EQ(heard, 0U);
  EXPECT_NE(contents(folder / "sensed").at("recording/front/color/000000.png"),
            reference().at("recording/front/color/000000.png"));
  // Another rate of the odometry is another drive on the same way.
  sensed.output = folder / "slower";
  generate(driven_config("odometry: {rate_hz: 25}"), sensed);
  EXPECT_GT(heard, 0U);
}

TEST(DrivenRun, MayBePreparedWhileAnotherOneIsRendered) {
  const TempFolder folder;
  const GenerateOptions second = into(folder / "second");
  std::future<std::shared_ptr<const Scenario>> prepared;
  GenerateOptions first = into(folder / "first");
  first.on_started = [&] {
    prepared = std::async(std::launch::async, [&second] { return prepare_generation(driven_config(), second); });
  };
  generate(driven_config("seed: 4"), first);
  ASSERT_TRUE(prepared.valid());
  generate(*prepared.get(), second);
  EXPECT_EQ(contents(folder / "second"), reference());
}

TEST(DriveStore, GivesNothingForDamageOrAnotherKey) {
  DrivenViewpoints driven;
  driven.plan.coverage = "three stops";
  driven.plan.stops.resize(3);
  driven.plan.stops[1].x_m = 0.1;
  driven.drive.captures = {{1.5, planar_pose(1.0, 2.0, 0.3)}};
  driven.drive.odometry = {{0.0, 0.0, 0.0, 0.0}, {0.02, 1e-300, -0.0, 3.1}};
  driven.drive.T_ground_robot.translation.z() = -0.003;
  driven.drive.trajectory.add(0.0, Rigid3());
  driven.drive.trajectory.add(0.01, planar_pose(0.1, 0.2, 0.3));
  const std::string key(64, 'a');
  const std::string bytes = encode_drive(driven, key);
  const std::optional<DrivenViewpoints> back = decode_drive(bytes, key);
  ASSERT_TRUE(back);
  EXPECT_EQ(encode_drive(*back, key), bytes);
  EXPECT_EQ(back->plan.coverage, "three stops");
  EXPECT_EQ(back->drive.T_ground_robot.translation.z(), -0.003);
  EXPECT_EQ(back->drive.captures[0].T_scene_robot.rotation.coeffs(),
            driven.drive.captures[0].T_scene_robot.rotation.coeffs());
  EXPECT_FALSE(decode_drive(bytes, std::string(64, 'b')));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string bad = bytes;
    bad[i] = static_cast<char>(bad[i] ^ 0x20);
    EXPECT_FALSE(decode_drive(bad, key)) << i;
    EXPECT_FALSE(decode_drive(bytes.substr(0, i), key)) << i;
  }
}

}  // namespace
}  // namespace rigproof
