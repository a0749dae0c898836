// Sweeps on pictures: each is rendered once and searched once, whatever else varies.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "cache.h"
#include "error_text.h"
#include "onnx_bytes.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/calib/vision/ground_source.h"
#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/files.h"
#include "rigproof/generator/generate.h"
#include "rigproof/generator/plan_run.h"
#include "rigproof/study/sweep/sweep.h"
#include "rigproof/validate/validate.h"
#include "rigproof/words/sentences.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// One camera, small images: eight of them.
// As many pictures show the same things as when these figures were written down.
const char* const kRun =
    "run: {include: plain.yaml, rig: husky_1x_d455, poses: 8, image_scale: 0.3, sensor_noise: none, "
    "board: {place: scene}, "
    "viewpoints: {planner: sampled}}\n";
constexpr std::uint64_t kImages = 8;

class RenderedSweep : public testing::Test {
 protected:
  SweepReport sweep_of(const std::string& name, const std::string& text, int jobs = 2) {
    SweepOptions options;
    options.folder = folder_ / name;
    options.cache = folder_ / "cache";
    options.jobs = jobs;
    return run_sweep(load_sweep_config(folder_.write(name + ".yaml", text)), options);
  }
  SweepReport sweep(const std::string& name, const std::string& text, int jobs = 2) {
    return sweep_of(name, kRun + text, jobs);
  }
  static std::uint64_t count(const SweepReport& report, const std::string& name) {
    const auto found = report.counters.find(name);
    return found == report.counters.end() ? 0 : found->second;
  }

  TempFolder folder_;
};

TEST_F(RenderedSweep, OdometryRendersAndDetectsOnce) {
  const std::string text =
      "axes: {lambda: {field: odometry.lambda, values: [0, 1, 5]}}\n"
      "seeds: {count: 3, field: odometry.seed}\nmethods: [ml, opencv_park]\n";
  const SweepReport report = sweep("a", text);
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(report.answers, 18U);
  EXPECT_EQ(count(report, "images rendered"), kImages);
  EXPECT_EQ(count(report, "corners detected"), kImages);
  EXPECT_EQ(count(report, "planes fitted"), kImages);
  EXPECT_EQ(count(report, "corners from cache"), 9 * kImages);
  EXPECT_EQ(count(report, "planes from cache"), 9 * kImages);
  for (const auto& file : fs::recursive_directory_iterator(folder_ / "cache" / "pictures"))
    EXPECT_NE(file.path().extension(), ".png") << "that nobody reads: " << file.path();
  const SweepRows rows = load_sweep_rows(folder_ / "a");
  std::map<std::string, double> largest;
  for (const SweepRow& row : rows.rows)
    if (row.method == "ml" && row.subject == SweepSubject::kCamera && row.error[0])
      largest[row.levels[0]] = std::max(largest[row.levels[0]], std::abs(*row.error[0]));
  EXPECT_LT(largest["0"], 1.0);
  EXPECT_GT(largest["5"], largest["0"]);

  // Warm: another folder, more levels: only solving is left.
  const SweepReport warm = sweep("b",
                                 "axes: {lambda: {field: odometry.lambda, values: [0, 1, 5, 9]}}\n"
                                 "seeds: {count: 3, field: odometry.seed}\nmethods: [ml, opencv_park]\n");
  EXPECT_EQ(count(warm, "images rendered"), 0U);
  EXPECT_EQ(count(warm, "corners detected") + count(warm, "planes fitted"), 0U);
  EXPECT_EQ(count(warm, "answers solved"), 6U);
  EXPECT_EQ(count(warm, "answers from cache"), 18U);
}

TEST_F(RenderedSweep, NumbersOfImagesShareTheirPictures) {
  const SweepReport report = sweep("a", "axes: {count: {field: images, values: [4, 6, 8]}}\nmethods: [ml]\n");
  EXPECT_EQ(count(report, "images rendered"), kImages);
  EXPECT_EQ(count(report, "corners detected"), kImages);
  std::map<std::string, double> bound;
  for (const SweepRow& row : load_sweep_rows(folder_ / "a").rows)
    if (row.subject == SweepSubject::kCamera) bound[row.levels[0]] = row.bound[2].value_or(0.0);
  EXPECT_GT(bound["4"], bound["8"]);
  EXPECT_GT(bound["8"], 0.0);
}

TEST_F(RenderedSweep, SensorNoiseIsSensedOnTheSameRenders) {
  const SweepReport report =
      sweep("a", "axes: {noise: {field: sensor_noise, values: [none, realistic]}}\nmethods: [opencv_park]\n", 3);
  EXPECT_EQ(count(report, "images rendered"), kImages);
  EXPECT_EQ(count(report, "images from clean renders"), kImages);
  EXPECT_EQ(count(report, "corners detected"), 2 * kImages);
}

TEST_F(RenderedSweep, PicturesThatWereDeletedAreMadeAgainOnlyForThoseWhoReadThem) {
  const std::string text = "methods: [opencv_park]\n";
  sweep("a", text);
  const SweepCache cache(folder_ / "cache");
  cache.shrink_to(0, {});
  std::size_t images = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "cache"))
    images += entry.path().extension() == ".png";
  EXPECT_EQ(images, 0U);
  EXPECT_EQ(count(sweep("b", "methods: [opencv_tsai]\n"), "images rendered"), 0U);
  folder_.write("see.yaml", "command: [ls, \"{input}/front/color/000007.png\"]\n");
  const SweepReport report = sweep("c", "methods: [\"external:see.yaml\"]\n");
  EXPECT_EQ(count(report, "images rendered"), kImages);
  EXPECT_EQ(count(report, "corners detected"), 0U);
}

// Whoever comes second waits for the pictures of the first, and neither deletes what the other reads.
TEST_F(RenderedSweep, TwoSweepsShareACacheAtTheSameTime) {
  const std::string one = "methods: [memroc_reference, opencv_park]\n";
  const std::string two = "axes: {lambda: {field: odometry.lambda, values: [1, 4]}}\n" + one;
  const pid_t other = fork();
  ASSERT_GE(other, 0);
  if (other == 0) {
    int code = 1;
    try {
      code = sweep("b", two, 1).complete ? 0 : 1;
    } catch (...) {
      code = 2;
    }
    _exit(code);
  }
  const SweepReport report = sweep("a", one, 1);
  int status = 0;
  ASSERT_EQ(waitpid(other, &status, 0), other);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_TRUE(report.complete);
  const std::uint64_t by_other = sweep_state(folder_ / "b").counters["images rendered"];
  EXPECT_EQ(count(report, "images rendered") + by_other, kImages);
  // The lambda of 1 is both's.
  const SweepRows a = load_sweep_rows(folder_ / "a"), b = load_sweep_rows(folder_ / "b");
  ASSERT_FALSE(a.rows.empty());
  for (std::size_t i = 0; i < a.rows.size(); ++i) EXPECT_EQ(a.rows[i].error, b.rows[i].error);
}

TEST_F(RenderedSweep, ALimitOfTheCacheHoldsAndCostsNoAnswer) {
  const std::string text = "axes: {lambda: {field: odometry.lambda, values: [1, 4]}}\nmethods: [memroc_reference]\n";
  SweepOptions options;
  options.folder = folder_ / "a";
  options.cache = folder_ / "cache";
  options.cache_limit_gb = 1e-6;
  options.jobs = 2;
  const SweepReport report = run_sweep(load_sweep_config(folder_.write("a.yaml", kRun + text)), options);
  EXPECT_EQ(count(report, "images rendered"), kImages);
  std::size_t images = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "cache"))
    images += entry.path().extension() == ".png" || entry.path().extension() == ".clean";
  EXPECT_EQ(images, 0U);
  EXPECT_EQ(count(sweep("b", text), "answers from cache"), 2U);
}

TEST_F(RenderedSweep, PicturesThatCannotBeDrivenToAreAFailedRow) {
  const SweepReport report =
      sweep("a", "axes: {d: {field: viewpoints.distance_m, values: [0.31, 2]}}\nmethods: [opencv_park]\n");
  EXPECT_TRUE(report.complete);
  const SweepState state = sweep_state(folder_ / "a");
  const auto failed = std::find_if(state.failures.begin(), state.failures.end(),
                                   [](const auto& failure) { return failure.status == SweepStatus::kFailed; });
  ASSERT_NE(failed, state.failures.end());
  EXPECT_EQ(failed->tasks, 1);
  EXPECT_THAT(words::text_of(failed->reasons), HasSubstr("Nothing to calibrate from: viewpoints: no place found"));
}

// The stops, and what the pictures of the first task state of corners and planes, are all that the geometric mode
// knows.
TEST_F(RenderedSweep, TheGeometricModeAgreesWithIt) {
  constexpr int kSeeds = 6;
  const std::string common =
      "odometry: {lambda: 2}}\nseeds: {count: " + std::to_string(kSeeds) + ", field: sensing.seed}\nmethods: [ml]\n";
  const std::string run =
      "run: {include: plain.yaml, rig: husky_1x_d455, poses: 12, image_scale: 0.3, sensing: {told: exact}, "
      "board: {place: scene}, viewpoints: {planner: sampled}, ";
  sweep_of("pictures", run + common);
  const fs::path pictures = folder_ / "cache" / "pictures";
  const auto set = std::find_if(fs::directory_iterator(pictures), fs::directory_iterator(),
                                [](const auto& entry) { return entry.is_directory(); });
  ASSERT_NE(set, fs::directory_iterator());
  const RunFolder first{set->path()};
  const SweepCache cache(folder_ / "cache");
  CachedFindings findings(cache, first);
  save_observations(observe(load_recording_of(first), {}, &findings), folder_ / "measured.json");
  sweep_of("drawn", "mode: geometric\ngeometric: {rig: run, measured: measured.json}\n" + run + common);

  const auto rows = [this](const std::string& name) {
    std::vector<SweepRow> found;
    for (const SweepRow& row : load_sweep_rows(folder_ / name).rows)
      if (row.subject == SweepSubject::kCamera) found.push_back(row);
    return found;
  };
  const std::vector<SweepRow> rendered = rows("pictures"), drawn = rows("drawn");
  ASSERT_EQ(rendered.size(), static_cast<std::size_t>(kSeeds));
  ASSERT_EQ(drawn.size(), rendered.size());
  for (std::size_t axis = 0; axis < 6; ++axis) {
    double rendered_bound = 0.0, drawn_bound = 0.0, rendered_squares = 0.0, drawn_squares = 0.0;
    for (std::size_t i = 0; i < rendered.size(); ++i) {
      ASSERT_TRUE(rendered[i].error[axis] && drawn[i].error[axis])
          << words::text_of(rendered[i].reasons) << words::text_of(drawn[i].reasons);
      rendered_bound += *rendered[i].bound[axis];
      drawn_bound += *drawn[i].bound[axis];
      rendered_squares += std::pow(*rendered[i].error[axis] / *rendered[i].bound[axis], 2);
      drawn_squares += std::pow(*drawn[i].error[axis] / *drawn[i].bound[axis], 2);
    }
    EXPECT_NEAR(drawn_bound / rendered_bound, 1.0, 0.1) << axis;
    // Chi square with six degrees of freedom, 0.01 % on either side.
    constexpr double kLow = 0.175, kHigh = 27.86;
    EXPECT_GT(rendered_squares, kLow) << axis;
    EXPECT_LT(rendered_squares, kHigh) << axis;
    EXPECT_GT(drawn_squares, kLow) << axis;
    EXPECT_LT(drawn_squares, kHigh) << axis;
  }
}

// Every pair of images is matched once, whatever number of stops is used and whichever method asks.
TEST_F(RenderedSweep, ImagesAreMatchedOnceForAllMethodsAndLevels) {
  const std::string text =
      "axes: {count: {field: images, values: [4, 6, 8]}}\n"
      "methods: [robot_autocalib, sensorx2car, memroc_reference, joint_memroc_reference]\n";
  const SweepReport report = sweep("a", text, 1);
  EXPECT_EQ(count(report, "images matched"), kImages - 1);
  EXPECT_EQ(count(report, "motions found"), kImages - 1);
  EXPECT_GE(count(report, "matches from cache"), 3U + 5U) << "those of fewer stops, at least";
  // Only those after a stop at which OpenCV saw the whole board, too.
  EXPECT_GE(count(report, "clouds searched"), 1U);
  EXPECT_LT(count(report, "clouds searched"), kImages);
  EXPECT_GE(count(report, "clouds from cache"), count(report, "clouds searched")) << "for the other method";
  EXPECT_EQ(count(report, "chessboards searched"), kImages);
  EXPECT_EQ(count(report, "chessboards from cache"), 2U * (4 + 6 + 8) - kImages);
  const SweepReport again =
      sweep("b", "axes: {count: {field: images, values: [5, 7]}}\n" + text.substr(text.find('\n') + 1));
  for (const char* work : {"images matched", "motions found", "clouds searched", "chessboards searched"})
    EXPECT_EQ(count(again, work), 0U) << work;
}

TEST_F(RenderedSweep, AMethodMayTakeItsGroundFromImages) {
  const std::string methods =
      "methods: [memroc, {method: memroc, name: memroc_image_ground, ground: images},\n"
      "          {method: memroc, name: memroc_auto, ground: auto}]\n";
  sweep("a", methods);
  std::map<std::string, SweepRow> rows;
  for (const SweepRow& row : load_sweep_rows(folder_ / "a").rows)
    if (row.subject == SweepSubject::kCamera) rows[row.method] = row;
  ASSERT_EQ(rows.size(), 3U);
  ASSERT_TRUE(rows["memroc"].error[2]) << words::text_of(rows["memroc"].reasons);
  EXPECT_EQ(rows["memroc_auto"].error, rows["memroc"].error) << "depth is trusted here";
  EXPECT_NE(rows["memroc_image_ground"].error, rows["memroc"].error);
  EXPECT_NE(rows["memroc_image_ground"].bound, rows["memroc"].bound);

  // As `calibrate --ground images` has it.
  const fs::path pictures = folder_ / "cache" / "pictures";
  const auto set = std::find_if(fs::directory_iterator(pictures), fs::directory_iterator(),
                                [](const auto& entry) { return entry.is_directory(); });
  const RunFolder run{set->path()};
  const Recording recording = load_recording(run.recording());
  Observations observations = observe(recording);
  const Observations seen = observations;
  take_ground_from(GroundSource::kImages, {seen, &recording, 1}, &observations);
  EXPECT_NE(observations.ground_planes.size(), seen.ground_planes.size());
  const Result result = run_method(find_method("memroc"), {observations, &recording, 1});
  ASSERT_EQ(result.camera_to_robot.size(), 1U);
  EXPECT_EQ(result.camera_to_robot[0].observable[2], rows["memroc_image_ground"].error[2].has_value());
  const Comparison comparison = compare(result, load_truth(run.truth_file()));
  ASSERT_EQ(comparison.camera_to_robot.size(), 1U);
  for (const Eigen::Index axis : {0, 1})
    EXPECT_NEAR(*rows["memroc_image_ground"].error[static_cast<std::size_t>(axis)],
                100.0 * comparison.camera_to_robot[0].error[axis], 1e-9);

  // Other options are another answer, the same ones are known.
  EXPECT_EQ(count(sweep("b", "methods: [{method: memroc, name: other, ground: images}]\n"), "answers from cache"), 1U);
  EXPECT_EQ(count(sweep("b", "methods: [{method: memroc, name: other}]\n"), "answers from cache"), 1U);
  for (const SweepRow& row : load_sweep_rows(folder_ / "b").rows) {
    if (row.subject == SweepSubject::kCamera) {
      EXPECT_EQ(row.error, rows["memroc"].error);
    }
  }
}

// The task's process sees that nobody wants the answer any more, and the sweep ends as interrupted, not with a failure.
TEST_F(RenderedSweep, AnAnswerThatIsAbandonedIsMadeLater) {
  const std::string text = std::string(kRun) + "methods: [opencv_park, robot_autocalib]\n";
  const pid_t owner = getpid();
  SweepOptions options;
  options.folder = folder_ / "a";
  options.cache = folder_ / "cache";
  options.jobs = 1;
  int asked = 0;  // in the task's process, after its first answer
  options.keep_going = [&] {
    if (getpid() == owner || !fs::exists(options.folder / "tasks")) return true;
    const auto is_answer = [](const auto& entry) { return entry.path().filename() == "opencv_park.json"; };
    const fs::recursive_directory_iterator answers(options.folder / "tasks");
    return std::none_of(fs::begin(answers), fs::end(answers), is_answer) || ++asked < 4;
  };
  const SweepConfig config = load_sweep_config(folder_.write("a.yaml", text));
  const SweepReport report = run_sweep(config, options);
  EXPECT_FALSE(report.complete);
  EXPECT_EQ(report.answers, 1U);
  EXPECT_EQ(count(report, "images matched") + count(report, "motions found"), 0U) << "amid the images";
  for (const SweepRow& row : load_sweep_rows(folder_ / "a").rows) EXPECT_EQ(row.method, "opencv_park");
  for (const FailureCount& failure : sweep_state(folder_ / "a").failures) EXPECT_EQ(failure.method, "opencv_park");
  options.keep_going = {};
  const SweepReport rest = run_sweep(config, options);
  EXPECT_TRUE(rest.complete);
  EXPECT_EQ(count(rest, "answers already there"), 1U);
  EXPECT_EQ(count(rest, "answers solved"), 1U) << "nothing was kept of the abandoned one";
  options.folder = folder_ / "whole";
  options.cache = folder_ / "other_cache";
  run_sweep(config, options);
  EXPECT_EQ(folder_.read("a/rows.csv"), folder_.read("whole/rows.csv"));
}

// Networks in the processes of a sweep: their features and horizons are what the methods get, and answers are kept
// apart from another network's.
TEST_F(RenderedSweep, MethodsLookThroughNetworks) {
  folder_.write("keypoints.onnx", keypoint_network());
  folder_.write("horizon.onnx", horizon_network(40000.0, 0.1));
  const std::string run =
      "run: {rig: husky_1x_d455, poses: 8, image_scale: 0.3, sensor_noise: none, straight_drive: {frames: 6}}\n";
  const std::string in_order =
      "methods:\n  - {method: robot_autocalib, name: by_network, features: \"onnx:keypoints.onnx\"}\n";
  const std::string with_ground =
      in_order + "  - {method: memroc, name: ground_by_network, ground: images, features: \"onnx:keypoints.onnx\"}\n";
  const std::string methods = with_ground +
                              "  - {method: ml, name: ml_by_network, ground: images, features: "
                              "\"onnx:keypoints.onnx\"}\n"
                              "  - {method: sensorx2car, name: by_horizon, horizon: \"onnx:horizon.onnx\"}\n";
  EXPECT_EQ(count(sweep_of("in_order", run + in_order), "images matched"), kImages - 1);
  const std::uint64_t nearby = count(sweep_of("with_ground", run + with_ground), "images matched");
  EXPECT_GT(nearby, 0U) << "the ground is seen from nearby, not from one stop to the next";
  EXPECT_LE(nearby, kImages);
  const SweepReport report = sweep_of("a", run + methods);
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(count(report, "images matched"), 0U) << "by the network, for all that ask it; horizons need none";
  std::map<std::string, SweepRow> cameras;
  for (const SweepRow& row : load_sweep_rows(folder_ / "a").rows) {
    EXPECT_NE(row.status, SweepStatus::kFailed) << row.method << ": " << words::text_of(row.reasons);
    EXPECT_NE(row.status, SweepStatus::kCouldNotRun) << row.method << ": " << words::text_of(row.reasons);
    if (row.subject == SweepSubject::kCamera) cameras[row.method] = row;
  }
  EXPECT_TRUE(cameras["ground_by_network"].error[0]) << words::text_of(cameras["ground_by_network"].reasons);
  EXPECT_TRUE(cameras["by_horizon"].error[5]) << words::text_of(cameras["by_horizon"].reasons);

  // The same networks are known; another one is asked.
  EXPECT_EQ(count(sweep_of("b", run + methods), "answers solved"), 0U);
  folder_.write("horizon.onnx", horizon_network(40000.0, 0.2));
  const SweepReport other = sweep_of("a", run + methods);
  EXPECT_EQ(count(other, "answers solved"), 1U);
  EXPECT_EQ(count(other, "answers already there"), 3U);
  folder_.write("horizon.onnx", keypoint_network());
  EXPECT_THAT(error_text([&] { sweep_of("a", run + methods); }), HasSubstr("horizon.onnx"));
}

TEST(ReplaceOdometry, GivesWhatGenerateWouldHaveWritten) {
  const TempFolder folder;
  const std::string base =
      "rig: husky_1x_d455\nposes: 3\nimage_scale: 0.1\nsensor_noise: none\n"
      "sensing: {time: {odometry_delay_ms: 15, odometry_jitter_ms: 1}}\n";
  const auto generated = [&](const std::string& name, const std::string& odometry) {
    GenerateOptions options;
    options.output = folder / name;
    options.jobs = 1;
    generate(parse_generate_config(base + odometry, "run.yaml"), options);
    return RunFolder{folder / name};
  };
  for (const std::string odometry :
       {"odometry: {lambda: 3, seed: 9, declared: true}", "odometry: {model: per_pose, rate_hz: 5, seed: 1}",
        "odometry: {model: wheels, wheels: {track_ratio: {uniform: [1.1, 1.2]}}}", "odometry: {model: thrun}"}) {
    const PlannedRun wanted = plan_run(parse_generate_config(base + odometry, "run.yaml"));
    const RunFolder run = generated("base", "");
    Recording recording = load_recording(run.recording());
    Truth truth = load_truth(run.truth_file());
    replace_odometry(parse_generate_config(base + odometry, "run.yaml"), &recording, &truth);
    ASSERT_EQ(recording.odometry.size(), wanted.recording.odometry.size()) << odometry;
    for (std::size_t i = 0; i < recording.odometry.size(); ++i) {
      EXPECT_NEAR(recording.odometry[i].x_m, wanted.recording.odometry[i].x_m, 1e-12);
      EXPECT_NEAR(recording.odometry[i].yaw_rad, wanted.recording.odometry[i].yaw_rad, 1e-12);
      EXPECT_DOUBLE_EQ(recording.odometry[i].stamp_s, wanted.recording.odometry[i].stamp_s);
    }
    EXPECT_EQ(truth.drawn.size(), wanted.truth.drawn.size()) << odometry;
    EXPECT_NEAR(*truth.odometry_noise.sigma_xy_m, *wanted.truth.odometry_noise.sigma_xy_m, 1e-12);
    EXPECT_EQ(recording.rig.odometry_noise.model, wanted.recording.rig.odometry_noise.model) << odometry;
  }
}

TEST(PictureMemory, ObservationsFromMemoryAreTheSameToTheBit) {
  const TempFolder folder;
  GenerateOptions options;
  options.output = folder / "run";
  generate(parse_generate_config("rig: husky_1x_d455\nposes: 4\nimage_scale: 0.3\n", "run.yaml"), options);
  const RunFolder run{folder / "run"};
  const Recording recording = load_recording(run.recording());
  const SweepCache cache(folder / "cache");
  const auto text = [&](PictureMemory* memory) {
    const Observations seen = memory == nullptr ? observe(recording) : observe(recording, {}, memory);
    save_observations(seen, folder / "seen.json");
    return folder.read("seen.json");
  };
  const std::string plain = text(nullptr);
  CachedFindings first(cache, run), second(cache, run);
  EXPECT_EQ(text(&first), plain);
  EXPECT_EQ(first.kept(PictureMemory::Finding::kCorners), 4U);
  EXPECT_EQ(text(&second), plain);
  EXPECT_EQ(second.recalled(PictureMemory::Finding::kCorners), 4U);
  EXPECT_EQ(second.recalled(PictureMemory::Finding::kPlanes), 4U);
  EXPECT_EQ(second.kept(PictureMemory::Finding::kCorners) + second.kept(PictureMemory::Finding::kPlanes), 0U);
  // Damaged findings are found again.
  for (const auto& entry : fs::recursive_directory_iterator(folder / "cache"))
    if (entry.is_regular_file()) fs::resize_file(entry.path(), fs::file_size(entry.path()) / 2);
  CachedFindings third(cache, run);
  EXPECT_EQ(text(&third), plain);
  EXPECT_EQ(third.kept(PictureMemory::Finding::kCorners), 4U);
}

}  // namespace
}  // namespace rigproof
