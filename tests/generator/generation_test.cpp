// Whole generations, small ones: what lies on disk, that it never depends on how it came about, and that it is true.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <thread>

#include "error_text.h"
#include "rigproof/calib/vision/checkerboard.h"
#include "rigproof/core/child_process.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/random.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/generator/generate.h"
#include "rigproof/generator/generator_version.h"
#include "rigproof/truth/truth.h"
#include "run_contents.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Twelve frames with everything that a run can have, as quick as can be.
GenerateConfig small_config() {
  return parse_generate_config("{include: plain.yaml, poses: 4, image_scale: 0.2, clouds: pcd, odometry: {rate_hz: 5}}",
                               "small.yaml");
}

GenerateOptions into(const fs::path& folder, int jobs = 2) {
  GenerateOptions options;
  options.output = folder;
  options.jobs = jobs;
  return options;
}

// One run that the others are compared with.
const std::map<std::string, std::string>& reference() {
  static const std::map<std::string, std::string> hashes = [] {
    const TempFolder folder;
    generate(small_config(), into(folder.path() / "run", 1));
    return contents(folder.path() / "run");
  }();
  return hashes;
}

TEST(Generation, LayoutIsTheDocumentedOneAndTheManifestHoldsEveryFile) {
  const TempFolder folder;
  const GenerateReport report = generate(small_config(), into(folder.path() / "run"));
  EXPECT_EQ(report.images, 12U);
  EXPECT_EQ(report.images_rendered, 12U);
  EXPECT_TRUE(report.complete);
  std::set<std::string> expected = {"run.yaml", "truth/config.yaml", "truth/truth.yaml", "recording/rig.yaml",
                                    "recording/odometry.csv"};
  for (const std::string camera : {"left", "center", "right"}) {
    expected.insert("recording/" + camera + "/frames.csv");
    for (const std::string number : {"000000", "000001", "000002", "000003"}) {
      expected.insert("recording/" + camera + "/color/" + number + ".png");
      expected.insert("recording/" + camera + "/depth/" + number + ".png");
      expected.insert("recording/" + camera + "/cloud/" + number + ".pcd");
    }
  }
  const Manifest manifest = load_manifest(folder.path() / "run" / "run.yaml");
  EXPECT_TRUE(manifest.complete);
  EXPECT_EQ(manifest.gl_renderer, report.gl_renderer);
  std::set<std::string> found;
  for (const auto& [path, hash] : contents(folder.path() / "run")) {
    found.insert(path);
    if (path == "run.yaml") continue;
    ASSERT_TRUE(manifest.files.count(path)) << path;
    EXPECT_EQ(manifest.files.at(path).sha256, hash) << path;
    EXPECT_EQ(manifest.files.at(path).size_bytes, fs::file_size(folder.path() / "run" / path)) << path;
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(manifest.files.size() + 1, expected.size());
}

TEST(Generation, RecordingAndTruthReadBackAndBelongTogether) {
  const TempFolder folder;
  GenerateConfig config = small_config();
  config.odometry.lambda = 0.0;
  generate(config, into(folder.path() / "run"));
  const RunFolder run{folder.path() / "run"};
  const Recording recording = load_recording(run.recording());
  const Truth truth = load_truth(run.truth_file());
  ASSERT_EQ(recording.frames.size(), 3U);
  ASSERT_EQ(truth.stops.size(), 4U);
  EXPECT_EQ(recording.odometry.size(), 3U * 10U + 1U);  // 5 Hz over 2 s from stop to stop
  // The world is the robot's frame at the first stop.
  EXPECT_LT(truth.stops[0].T_world_robot.translation.norm(), 1e-12);
  for (std::size_t i = 0; i < 4; ++i) {
    const OdometrySample& sample = recording.odometry[10 * i];
    EXPECT_EQ(recording.frames[1][i].stamp_s, sample.stamp_s);
    EXPECT_EQ(truth.stops[i].stamp_s, sample.stamp_s);
    EXPECT_NEAR(truth.stops[i].T_world_robot.translation.x(), sample.x_m, 1e-9);  // exact odometry
    EXPECT_NEAR(truth.stops[i].T_world_robot.translation.y(), sample.y_m, 1e-9);
  }
}

TEST(Generation, RecordingTellsNothingOfTheTruth) {
  const TempFolder folder;
  generate(small_config(), into(folder.path() / "run"));
  for (const auto& entry : fs::recursive_directory_iterator(folder.path() / "run" / "recording")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".yaml" && extension != ".csv") continue;
    const std::string text = read_text_file(entry.path());
    for (const char* word : {"seed", "truth", "scene", "indoor", "T_robot", "mount", "lambda", "sigma_xy", "T_world"}) {
      EXPECT_EQ(text.find(word), std::string::npos) << entry.path() << " holds " << word;
    }
  }
}

TEST(Generation, BytesDoNotDependOnTheNumberOfProcesses) {
  for (const int jobs : {2, 3}) {
    const TempFolder folder;
    generate(small_config(), into(folder.path() / "run", jobs));
    EXPECT_EQ(contents(folder.path() / "run"), reference()) << jobs;
  }
}

TEST(Generation, AnotherSeedGivesOtherImages) {
  const TempFolder folder;
  GenerateConfig config = small_config();
  config.seed = 1;
  config.poses = 1;
  generate(config, into(folder.path() / "run", 1));
  const std::string image = "recording/left/color/000000.png";
  EXPECT_NE(contents(folder.path() / "run").at(image), reference().at(image));
}

TEST(Generation, CompleteRunIsLeftAlone) {
  const TempFolder folder;
  generate(small_config(), into(folder.path() / "run"));
  const auto written = fs::last_write_time(folder.path() / "run" / "run.yaml");
  const GenerateReport report = generate(small_config(), into(folder.path() / "run"));
  EXPECT_EQ(report.images_rendered, 0U);
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(fs::last_write_time(folder.path() / "run" / "run.yaml"), written);
}

TEST(Generation, InterruptedRunResumes) {
  const TempFolder folder;
  GenerateOptions options = into(folder.path() / "run");
  options.progress = [](std::size_t done, std::size_t) { return done < 5; };
  const GenerateReport first = generate(small_config(), options);
  EXPECT_FALSE(first.complete);
  EXPECT_GE(first.images_rendered, 5U);
  EXPECT_LE(first.images_rendered, 9U);  // what was in work was finished: two a process
  EXPECT_FALSE(load_manifest(folder.path() / "run" / "run.yaml").complete);
  const GenerateReport second = generate(small_config(), into(folder.path() / "run"));
  EXPECT_EQ(first.images_rendered + second.images_rendered, 12U);
  EXPECT_EQ(contents(folder.path() / "run"), reference());
}

TEST(Generation, DamagedFilesAreMadeAnew) {
  const TempFolder folder;
  const fs::path run = folder.path() / "run";
  generate(small_config(), into(run));
  fs::resize_file(run / "recording/left/color/000001.png", 1000);
  fs::remove(run / "recording/right/depth/000003.png");
  fs::remove(run / "truth/truth.yaml");
  EXPECT_EQ(generate(small_config(), into(run)).images_rendered, 2U);
  EXPECT_EQ(contents(run), reference());
}

TEST(Generation, KilledAtAnyMomentItResumesToTheSameBytes) {
  const auto start = std::chrono::steady_clock::now();
  reference();
  const double whole_s = std::max(0.5, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  RandomStream random(3, "kill");
  const char* kills = std::getenv("RIGPROOF_KILLS");
  const int trials = kills != nullptr ? std::atoi(kills) : 4;
  for (int trial = 0; trial < trials; ++trial) {
    const TempFolder folder;
    const fs::path run = folder.path() / "run";
    ChildProcess generation([&] { return generate(small_config(), into(run)).complete ? 0 : 1; });
    std::this_thread::sleep_for(std::chrono::duration<double>(random.uniform(0.2, 1.0) * std::min(whole_s, 3.0)));
    generation.kill_all();
    generation.wait();
    // What is visible is whole.
    if (fs::exists(run)) {
      for (const auto& [path, hash] : contents(run)) {
        const bool temporary = fs::path(path).extension() == ".tmp";
        if (temporary || path == "run.yaml") continue;
        EXPECT_EQ(hash, reference().at(path)) << path;
      }
    }
    EXPECT_TRUE(generate(small_config(), into(run)).complete);
    EXPECT_EQ(contents(run), reference()) << "trial " << trial;
  }
}

// Processes whose parent this is, from the kernel's list.
std::vector<pid_t> children() {
  std::vector<pid_t> pids;
  for (const auto& task : fs::directory_iterator("/proc/self/task")) {
    std::ifstream in(task.path() / "children");
    for (pid_t pid = 0; in >> pid;) pids.push_back(pid);
  }
  return pids;
}

TEST(Generation, CrashedProcessIsOneClearErrorAndNothingIsLost) {
  const TempFolder folder;
  GenerateOptions options = into(folder.path() / "run");
  options.progress = [](std::size_t done, std::size_t) {
    if (done >= 3 && !children().empty()) ::kill(children().front(), SIGKILL);
    return true;
  };
  try {
    generate(small_config(), options);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kTryAgain);
    EXPECT_THAT(error.what(), HasSubstr("signal 9"));
    EXPECT_THAT(error.what(), HasSubstr("the same command goes on"));
  }
  const GenerateReport report = generate(small_config(), into(folder.path() / "run"));
  EXPECT_LE(report.images_rendered, 9U);
  EXPECT_EQ(contents(folder.path() / "run"), reference());
}

TEST(Generation, AnotherConfigurationIsRefusedUnlessFresh) {
  const TempFolder folder;
  GenerateOptions options = into(folder.path() / "run");
  options.progress = [](std::size_t, std::size_t) { return false; };
  generate(small_config(), options);
  GenerateConfig other = small_config();
  other.odometry.lambda = 3.0;
  const std::string error = error_text([&] { generate(other, options); });
  EXPECT_THAT(error, HasSubstr("odometry.lambda: 1 there, 3 here"));
  EXPECT_THAT(error, HasSubstr("--fresh"));
  options.fresh = true;
  EXPECT_NO_THROW(generate(other, options));
}

// As --fresh leaves them where something cannot be removed, or the machine stops.
TEST(Generation, WhatARunOfWhichNothingIsKnownHoldsIsRemoved) {
  const TempFolder folder;
  const RunFolder run{folder.path() / "run"};
  generate(small_config(), into(run.root));
  write_file_atomically(run.recording() / "left/color/000099.png", std::string_view("of an older run"));
  fs::create_directories(run.results());
  write_file_atomically(run.results() / "ml.yaml", std::string_view("of an older run"));
  Manifest manifest = load_manifest(run.manifest_file());
  manifest.complete = false;
  manifest.files.clear();
  save_manifest(manifest, run.manifest_file());
  EXPECT_EQ(generate(small_config(), into(run.root)).images_rendered, 12U);
  EXPECT_EQ(contents(run.root), reference());
}

// Other sources may make other bytes of the same configuration.
TEST(Generation, ARunOfAnotherGeneratorIsRefusedUnlessFresh) {
  const TempFolder folder;
  const RunFolder run{folder.path() / "run"};
  GenerateOptions options = into(run.root);
  options.progress = [](std::size_t, std::size_t) { return false; };
  generate(small_config(), options);
  Manifest manifest = load_manifest(run.manifest_file());
  EXPECT_EQ(manifest.tool_version, generator_version());
  manifest.tool_version = "0.1.0+0123456789ab";
  save_manifest(manifest, run.manifest_file());
  const std::string error = error_text([&] { generate(small_config(), options); });
  EXPECT_THAT(error, HasSubstr("of rigproof 0.1.0+0123456789ab, this is " + generator_version()));
  EXPECT_THAT(error, HasSubstr("--fresh"));
  options.fresh = true;
  EXPECT_NO_THROW(generate(small_config(), options));
  EXPECT_EQ(load_manifest(run.manifest_file()).tool_version, generator_version());
}

TEST(Generation, WithoutItsRenderDeviceNothingIsBegunAndNothingRemoved) {
  const TempFolder folder;
  GenerateOptions options = into(folder.path() / "run");
  options.device = 99;
  EXPECT_THAT(error_text([&] { generate(small_config(), options); }), HasSubstr("render device 99 does not exist"));
  EXPECT_FALSE(fs::exists(options.output));
  generate(small_config(), into(options.output));
  options.fresh = true;
  EXPECT_THAT(error_text([&] { generate(small_config(), options); }), HasSubstr("render device 99 does not exist"));
  EXPECT_EQ(contents(options.output), reference());
}

TEST(Generation, ForeignFolderIsNeverTouched) {
  const TempFolder folder;
  write_file_atomically(folder.path() / "thesis.tex", std::string_view("ten years of work"));
  GenerateOptions options = into(folder.path());
  options.fresh = true;
  EXPECT_THAT(error_text([&] { generate(small_config(), options); }), HasSubstr("thesis.tex"));
  EXPECT_EQ(contents(folder.path()).size(), 1U);
}

TEST(Generation, SecondGenerationIntoTheSameFolderIsKeptOut) {
  const TempFolder folder;
  GenerateOptions options = into(folder.path() / "run");
  std::string error;
  options.progress = [&](std::size_t done, std::size_t) {
    if (done >= 1 && error.empty()) {
      error = error_text([&] { generate(small_config(), into(folder.path() / "run")); });
    }
    return error.empty();
  };
  generate(small_config(), options);
  EXPECT_THAT(error, HasSubstr("another rigproof generates into this folder"));
}

TEST(Generation, BadSurroundingsAreOneClearError) {
  const TempFolder folder;
  write_file_atomically(folder.path() / "file", std::string_view("x"));
  GenerateConfig config = small_config();
  EXPECT_THAT(error_text([&] { generate(config, into(folder.path() / "file" / "run")); }), HasSubstr("file/run"));
  config.scene = "indoor_lap";
  EXPECT_THAT(error_text([&] { generate(config, into(folder.path() / "run")); }), HasSubstr("indoor_lab"));
  config = small_config();
  config.rig = "husky_3x_d45";
  EXPECT_THAT(error_text([&] { generate(config, into(folder.path() / "run")); }), HasSubstr("husky_3x_d455"));
  config = small_config();
  config.viewpoints.distance_m = 50.0;
  EXPECT_THAT(error_text([&] { generate(config, into(folder.path() / "run")); }), HasSubstr("drivable area"));
  config = small_config();
  config.board.squares = {6, 4};
  EXPECT_THAT(error_text([&] { generate(config, into(folder.path() / "run")); }), HasSubstr("180 degrees"));
  EXPECT_FALSE(fs::exists(folder.path() / "run"));
}

[[noreturn]] void generate_on_small_disk(const fs::path& run) {
  ::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{20000, 20000};
  ::setrlimit(RLIMIT_FSIZE, &limit);
  const std::string error = error_text([&] { generate(small_config(), into(run)); });
  ::dprintf(2, "%s\n", error.c_str());
  ::_exit(error.empty() ? 0 : 2);
}

// A limit on the size of files stands in for a full disk: the write fails in the middle of a file.
TEST(Generation, FullDiskIsOneClearErrorAndNothingIsHalfWritten) {
  const TempFolder folder;
  const fs::path run = folder.path() / "run";
  EXPECT_EXIT(generate_on_small_disk(run), testing::ExitedWithCode(2), "recording/.*cannot write");
  for (const auto& [path, hash] : contents(run)) {
    EXPECT_NE(fs::path(path).extension(), ".tmp") << path;
    if (path == "run.yaml") continue;
    EXPECT_EQ(hash, reference().at(path)) << path;
  }
}

TEST(Generation, PlanTellsWhatWillCome) {
  const GeneratePlan plan = plan_generation(parse_generate_config("poses: 7"));
  EXPECT_EQ(plan.stops, 7U);
  EXPECT_EQ(plan.images, 21U);
  EXPECT_EQ(plan.pictures, 21U);
  EXPECT_GT(plan.expected_mb, 7.0);
  EXPECT_GT(plan.expected_minutes, 0.0);
  // Effects take time; JPEG takes less of the disk, and a run is refused where the disk has too little.
  const GeneratePlan plain = plan_generation(parse_generate_config("{include: plain.yaml, poses: 7}"));
  EXPECT_LT(plan.expected_mb, 0.5 * plain.expected_mb);
  EXPECT_GT(plan.expected_minutes, 1.2 * plain.expected_minutes);
  EXPECT_THAT(plan.coverage, HasSubstr("7 stops"));
}

Image8 read_rgb(const fs::path& file) {
  const cv::Mat bgr = cv::imread(file.string(), cv::IMREAD_COLOR);
  Image8 image(bgr.cols, bgr.rows, 3);
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = bgr.ptr<std::uint8_t>(y)[3 * x + 2 - c];
    }
  }
  return image;
}

// Distance along the optical axis from the camera to the board's plane, along the ray through a pixel.
double board_depth_m(const Camera& camera, const Rigid3& T_camera_board, const Eigen::Vector2d& pixel) {
  Eigen::Vector3d ray;
  EXPECT_TRUE(camera.unproject(pixel, &ray));
  const Eigen::Vector3d normal = T_camera_board.rotation * Eigen::Vector3d::UnitZ();
  return normal.dot(T_camera_board.translation) / normal.dot(ray);
}

// The loop closed: what the truth projects to is where the detector finds it, and where the depth image says it is.
TEST(Generation, CornersAndDepthAreWhereTheTruthProjectsThem) {
  const TempFolder folder;
  GenerateConfig config = parse_generate_config("{include: plain.yaml, poses: 2, sensor_noise: none}");
  generate(config, into(folder.path() / "run"));
  const RunFolder run{folder.path() / "run"};
  const Recording recording = load_recording(run.recording());
  const Truth truth = load_truth(run.truth_file());
  int corners = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero(), squares = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < truth.cameras.size(); ++k) {
    const Camera& camera = truth.cameras[k].camera;
    for (std::size_t i = 0; i < truth.stops.size(); ++i) {
      const Rigid3 T_camera_board =
          (truth.stops[i].T_world_robot * truth.cameras[k].T_robot_camera).inverse() * truth.T_world_board;
      const CameraFrame& frame = recording.frames[k][i];
      const BoardDetection detection =
          detect_checkerboard(read_rgb(run.recording() / frame.color_file), recording.rig.board);
      const auto* found = std::get_if<std::vector<CornerObservation>>(&detection);
      if (found == nullptr) continue;
      const cv::Mat depth = cv::imread((run.recording() / frame.depth_file).string(), cv::IMREAD_UNCHANGED);
      for (const CornerObservation& corner : *found) {
        Eigen::Vector2d expected;
        ASSERT_TRUE(camera.project(T_camera_board * truth.board.corner(corner.id), &expected));
        const Eigen::Vector2d error = corner.pixel - expected;
        sum += error;
        squares += error.cwiseProduct(error);
        ++corners;
        const int u = static_cast<int>(std::lround(expected.x())), v = static_cast<int>(std::lround(expected.y()));
        // Rounding to millimetres, and 0.01 mm of the depth buffer (rendering).
        EXPECT_NEAR(0.001 * depth.at<std::uint16_t>(v, u), board_depth_m(camera, T_camera_board, Eigen::Vector2d(u, v)),
                    0.00051);
      }
    }
  }
  ASSERT_GE(corners, 4 * 12);  // six views; at least four of them with the whole board
  // The detector's and the renderer's share together (0.006 px each), with 8-bit rounding; half a pixel would be seen.
  EXPECT_LT(std::sqrt(squares.x() / corners), 0.02);
  EXPECT_LT(std::sqrt(squares.y() / corners), 0.02);
  EXPECT_NEAR(sum.x() / corners, 0.0, 0.006);
  EXPECT_NEAR(sum.y() / corners, 0.0, 0.006);
}

}  // namespace
}  // namespace rigproof
