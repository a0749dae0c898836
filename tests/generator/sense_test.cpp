// Render once, sense many: what comes from the cache has the bytes of what is generated directly.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "clean_cache.h"
#include "error_text.h"
#include "frame_maker.h"
#include "rigproof/core/files.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/generator/generate.h"
#include "rigproof/generator/parameters.h"
#include "rigproof/truth/truth.h"
#include "run_contents.h"
#include "scenario.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

GenerateConfig small_config(const std::string& more = "") {
  return parse_generate_config("include: plain.yaml\nposes: 2\nimage_scale: 0.2\n" + more, "small.yaml");
}

// Everything that can be switched on.
const char* const kAllEffects = R"(
sensing:
  seed: 77
  image: {pixel_pattern: true, vignetting: true, exposure: 0.8, exposure_jitter_percent: 3, defocus_sigma_px: 0.7}
  depth: {coarse_noise: true, bias_field: true, occlusion: true, edges: true, texture_holes: true, misregistration_px: 2}
  lens: {focal_error_percent: {normal: {mean: 0, stddev: 0.1}}}
  time: {clock_offset_ms: {uniform: [-20, 20]}, stamp_jitter_ms: 1, odometry_delay_ms: 10}
)";

GenerateOptions into(const fs::path& folder, const fs::path& cache = {}, bool render = true) {
  GenerateOptions options;
  options.output = folder;
  options.jobs = 1;
  options.cache = cache;
  options.render = render;
  return options;
}

TEST(Sense, FromTheCacheComeTheBytesOfADirectGeneration) {
  const TempFolder folder;
  const fs::path cache = folder.path() / "cache";
  generate(small_config(), into(folder.path() / "plain", cache));
  EXPECT_EQ(contents(cache).size(), 6U);
  for (const char* effects : {"", kAllEffects, "sensor_noise: none\nclouds: pcd\n"}) {
    const GenerateConfig config = small_config(effects);
    generate(config, into(folder.path() / "direct"));
    const GenerateReport report = generate(config, into(folder.path() / "sensed", cache, false));
    EXPECT_TRUE(report.complete);
    EXPECT_EQ(contents(folder.path() / "sensed"), contents(folder.path() / "direct")) << effects;
    fs::remove_all(folder.path() / "direct");
    fs::remove_all(folder.path() / "sensed");
  }
  EXPECT_EQ(contents(cache).size(), 6U);
}

// The reader is told of a fixed error of depth where there is one, and of none where there is none.
TEST(Sense, TheRigTellsTheBiasThatIsSimulated) {
  const auto noise = [](const std::string& more) {
    return resolve_scenario(small_config(more)).recording.rig.cameras.at(0).depth->noise;
  };
  const std::string field = "sensing: {depth: {bias_field: true}}\n";
  EXPECT_FALSE(noise("").has_bias());
  EXPECT_FALSE(noise(field + "sensor_noise: none\n").has_bias());
  const DepthNoise told = noise(field), preset = load_sensor_preset("d455").depth->noise;
  EXPECT_TRUE(told.has_bias());
  EXPECT_NEAR(told.bias_inverse_depth_per_m, preset.bias_inverse_depth_per_m, 1e-12);
  EXPECT_NEAR(told.bias_cell_deg, preset.bias_cell_deg, 1e-9);
}

TEST(Sense, RefusesWhatTheCacheDoesNotHold) {
  const TempFolder folder;
  const fs::path cache = folder.path() / "cache";
  generate(small_config(), into(folder.path() / "run", cache));
  GenerateConfig other = small_config();
  other.render.psf_sigma_px = 0.8;
  const std::string error = error_text([&] { generate(other, into(folder.path() / "other", cache, false)); });
  EXPECT_THAT(error, HasSubstr("0 of 6 clean renders"));
  EXPECT_THAT(error, HasSubstr("generate"));
  // More stops of the same drive: what is there is used.
  other = small_config();
  other.poses = 3;
  EXPECT_NO_THROW(generate(other, into(folder.path() / "longer", cache)));
  EXPECT_LE(contents(cache).size(), 6U + 3U);
}

TEST(Sense, DamagedRenderIsMadeAnew) {
  const TempFolder folder;
  const fs::path cache = folder.path() / "cache";
  generate(small_config(), into(folder.path() / "run", cache));
  const auto whole = contents(cache);
  const fs::path victim = cache / whole.begin()->first;
  std::vector<std::uint8_t> bytes = read_binary_file(victim);
  bytes.back() = static_cast<std::uint8_t>(bytes.back() ^ 1U);
  write_file_atomically(victim, bytes);
  const std::string error = error_text([&] { generate(small_config(), into(folder.path() / "again", cache, false)); });
  EXPECT_THAT(error, HasSubstr("is damaged"));
  fs::remove(victim);
  generate(small_config(), into(folder.path() / "third", cache));
  EXPECT_EQ(contents(cache), whole);
  EXPECT_EQ(contents(folder.path() / "third"), contents(folder.path() / "run"));
}

std::vector<std::string> keys_of(const GenerateConfig& config) { return clean_frame_keys(resolve_scenario(config)); }

// The keys hash what rendering depends on, exactly: a sense key changes none of them, a render key all.
TEST(Sense, KeysFollowRenderKeysAlone) {
  const std::vector<std::string> keys = keys_of(small_config());
  EXPECT_EQ(std::set<std::string>(keys.begin(), keys.end()).size(), keys.size());
  EXPECT_EQ(keys_of(small_config()), keys);
  EXPECT_EQ(keys_of(small_config(kAllEffects)), keys);
  EXPECT_EQ(keys_of(small_config("name: x\nstop_period_s: 3\nodometry: {lambda: 4}\nsensor_noise: none\n"
                                 "depth_scale_bias_percent: 2\nclouds: pcd\ncloud_stride_px: 3\npng_level: 2\n")),
            keys);
  for (const char* change :
       {"seed: 1\n", "scene: outdoor_yard\n", "render: {psf_sigma_px: 0.7}\n", "render: {whole_at_double: true}\n",
        "board: {square_mm: 90}\n", "board: {squares: [6, 5]}\n"}) {
    const std::vector<std::string> changed = keys_of(small_config(change));
    for (const std::string& key : changed) EXPECT_EQ(std::count(keys.begin(), keys.end(), key), 0) << change;
  }
}

TEST(Sense, DroppedFramesAreMissingAndJpegIsJpeg) {
  const TempFolder folder;
  const GenerateConfig config =
      small_config("sensing: {seed: 3, time: {dropped_percent: 60}, image: {jpeg_quality: 90}}\n");
  generate(config, into(folder.path() / "run"));
  const Recording recording = load_recording(folder.path() / "run" / "recording");
  const Truth truth = load_truth(folder.path() / "run" / "truth" / "truth.yaml");
  std::size_t frames = 0;
  double dropped = 0.0;
  for (std::size_t camera = 0; camera < 3; ++camera) {
    frames += recording.frames[camera].size();
    for (const CameraFrame& frame : recording.frames[camera]) {
      EXPECT_THAT(frame.color_file, HasSubstr(".jpg"));
      EXPECT_TRUE(fs::exists(recording.folder / frame.color_file));
    }
    const auto& labels = truth.cameras[camera].sensing;
    if (labels.count("dropped_frames") != 0) dropped += labels.at("dropped_frames");
  }
  EXPECT_EQ(frames + static_cast<std::size_t>(dropped), 6U);
  EXPECT_LT(frames, 6U);
}

}  // namespace
}  // namespace rigproof
