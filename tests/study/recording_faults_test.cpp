// The table of faults that bench_faults measures: it names what there is, and every fault changes what it says it does.
#include "faults/recording_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <opencv2/imgcodecs.hpp>

#include "rigproof/core/files.h"
#include "rigproof/core/finding.h"
#include "temp_folder.h"

namespace rigproof::faults {
namespace {

namespace fs = std::filesystem;

constexpr int kStops = 12, kWidth = 48, kHeight = 32;

RigCamera camera_of(const std::string& name, Lens lens, const std::array<double, 5>& distortion, bool depth) {
  RigCamera camera;
  camera.name = camera.folder = camera.link = name;
  camera.camera = Camera::symmetric(kWidth, kHeight, 40.0);
  camera.camera.cx_px = 24.25;
  camera.camera.fx_px = 40.5 + static_cast<double>(name.size());
  camera.camera.lens = lens;
  camera.camera.distortion = distortion;
  if (depth) camera.depth = DepthStream();
  return camera;
}

void write_images(const fs::path& folder, const CameraFrame& frame, int offset) {
  cv::RNG random(static_cast<std::uint64_t>(offset));
  cv::Mat color(kHeight, kWidth, CV_8UC3), depth(kHeight, kWidth, CV_16U);
  random.fill(color, cv::RNG::UNIFORM, 20, 220);
  random.fill(depth, cv::RNG::UNIFORM, 900, 4000);
  for (const auto& [file, image] : {std::pair(frame.color_file, color), std::pair(frame.depth_file, depth)}) {
    if (file.empty()) continue;
    fs::create_directories((folder / file).parent_path());
    cv::imwrite((folder / file).string(), image);
  }
}

// Noise for pictures, but all that faults edit is there: depth or none, three lenses, stamps off whole seconds.
Recording drawn_recording(const fs::path& folder, int offset) {
  Recording recording;
  recording.folder = folder;
  recording.rig.name = "drawn";
  recording.rig.cameras = {camera_of("left", Lens::kBrownConrady, {0.11, -0.24, 0.0004, -0.0003, 0.1}, true),
                           camera_of("wide", Lens::kKannalaBrandt, {-0.012, 0.002, -0.001, 0.0}, false),
                           camera_of("right", Lens::kBrownConrady, {0.1, -0.2, 0.0005, -0.0002, 0.1}, true)};
  recording.frames.resize(recording.rig.cameras.size());
  for (int i = 0; i < kStops; ++i) {
    const double stamp_s = 100.3 + 2.0 * i;
    recording.odometry.push_back({stamp_s, 0.3 * i - 1.0, 0.2 * i * i, 0.4 - 0.3 * i});
    for (std::size_t k = 0; k < recording.frames.size(); ++k) {
      const RigCamera& camera = recording.rig.cameras[k];
      const std::string file = std::to_string(100 + i) + ".png";
      recording.frames[k].push_back({camera.folder + "/color/" + file,
                                     camera.depth ? camera.folder + "/depth/" + file : "", "", stamp_s, 0.005, 0});
      write_images(folder, recording.frames[k].back(), offset + 100 * i + static_cast<int>(k));
    }
  }
  save_recording(recording);
  return recording;
}

Files kind_of(const std::string& file) {
  const auto has = [&](const char* part) { return file.find(part) != std::string::npos; };
  if (has("/color/")) return Files::kColor;
  if (has("/depth/")) return Files::kDepth;
  if (has("/cloud/")) return Files::kClouds;
  if (has("frames.csv")) return Files::kFrames;
  return has("odometry.csv") ? Files::kOdometry : Files::kRig;
}

using Contents = std::map<std::string, std::string>;
Contents contents_of(const fs::path& folder) {
  Contents contents;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) contents[fs::relative(entry.path(), folder)] = read_text_file(entry.path());
  return contents;
}

std::set<Files> changed(const Contents& before, const Contents& after) {
  std::set<Files> kinds;
  for (const auto* these : {&before, &after})
    for (const auto& [file, bytes] : *these) {
      const Contents& others = these == &before ? after : before;
      if (const auto other = others.find(file); other == others.end() || other->second != bytes)
        kinds.insert(kind_of(file));
    }
  return kinds;
}

bool is_known(const std::string& code) {
  try {
    return Finding(code).is(code.c_str());
  } catch (const std::logic_error&) {
    return false;
  }
}

std::vector<RecordingFault> faults_and_pairs() {
  std::vector<RecordingFault> all = recording_faults();
  for (const RecordingFault& pair : recording_fault_pairs()) all.push_back(pair);
  return all;
}

TEST(RecordingFaults, AreManyAndHaveNamesOfTheirOwn) {
  EXPECT_GE(recording_faults().size(), 150U);
  EXPECT_GE(recording_fault_pairs().size(), 20U);
  std::set<std::string> names;
  for (const RecordingFault& fault : faults_and_pairs()) EXPECT_TRUE(names.insert(fault.name).second) << fault.name;
}

TEST(RecordingFaults, AreNamedByFindingsThatThereAre) {
  for (const RecordingFault& fault : faults_and_pairs())
    for (const std::vector<std::string>* codes : {&fault.codes, &fault.codes_if_alone})
      for (const std::string& code : *codes)
        EXPECT_TRUE(code == kError || is_known(code)) << fault.name << ": " << code;
}

TEST(RecordingFaults, ChangeTheFilesThatTheyNameAndNoOthers) {
  const TempFolder scratch;
  const Recording healthy = drawn_recording(scratch / "run/recording", 0);
  for (const Variant& variant : variants()) drawn_recording(scratch / ("run-" + variant.name + "/recording"), 7);
  const Contents before = contents_of(healthy.folder);
  int number = 0;
  for (const RecordingFault& fault : faults_and_pairs()) {
    SCOPED_TRACE(fault.name);
    const fs::path folder = scratch / std::to_string(number++);
    FaultyRecording recording(scratch / "run", folder, static_cast<std::uint64_t>(number));
    ASSERT_TRUE(!fault.fits || fault.fits(recording.now().rig));
    fault.apply(&recording);
    EXPECT_EQ(changed(before, contents_of(folder)), fault.files);
    fs::remove_all(folder);
  }
  EXPECT_EQ(contents_of(healthy.folder), before) << "what is shared must not change";
}

}  // namespace
}  // namespace rigproof::faults
