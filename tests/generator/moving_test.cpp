// Runs that are recorded while the robot drives, and runs whose depth is measured beside the colour camera: what they
// hold is what the truth says, and the data set's own proof notices where it is not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "error_text.h"
#include "exposures.h"
#include "frame_maker.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/files.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/generator/generate.h"
#include "rigproof/validate/proof.h"
#include "scenario.h"
#include "temp_folder.h"
#include "worded.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

// Blur and rolling shutter far beyond what the presets say; one camera, from one viewpoint to the next.
GenerateConfig moving_config(const std::string& render = "exposure_ms: 20, readout_ms: 20") {
  return parse_generate_config(
      "{include: plain.yaml, motion: drive, drive: {capture: moving, frame_rate_hz: 1}, poses: 2, seed: 3, "
      "image_scale: 0.3, rig: husky_1x_d455, render: {" +
          render + "}}",
      "moving.yaml");
}

GenerateConfig raw_config(const std::string& more = "") {
  return parse_generate_config("include: plain.yaml\nposes: 3\nimage_scale: 0.5\ndepth_frame: raw\n" + more,
                               "raw.yaml");
}

GenerateOptions into(const fs::path& folder, const fs::path& cache = {}, bool render = true) {
  GenerateOptions options;
  options.output = folder;
  options.jobs = 1;
  options.cache = cache;
  options.render = render;
  return options;
}

std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> hashes;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      hashes[fs::relative(entry.path(), folder).generic_string()] = sha256_hex_of_file(entry.path());
  return hashes;
}

struct SeenRun {
  Recording recording;
  Truth truth;
  Observations observations;

  explicit SeenRun(const fs::path& folder)
      : recording(load_recording(RunFolder{folder}.recording())),
        truth(load_truth(RunFolder{folder}.truth_file())),
        observations(observe(recording)) {}
  Proof proof() const { return prove(recording, observations, truth); }
};

TEST(Moving, ThePlanCountsThePicturesThatImagesArePutTogetherFrom) {
  const Scenario scenario = resolve_scenario(moving_config());
  std::size_t pictures = 0;
  for (const FrameJob& job : scenario.frames) {
    const std::size_t color = color_exposure(scenario, job).parts();
    pictures += color == 1 ? 1 : color + 1;  // depth of one time beside them
  }
  const GeneratePlan plan = plan_generation(moving_config());
  EXPECT_EQ(plan.images, scenario.frame_count());
  EXPECT_EQ(plan.pictures, pictures);
  EXPECT_GT(plan.pictures, 3U * plan.images);
  EXPECT_EQ(plan_generation(raw_config()).pictures, 2U * plan_generation(raw_config()).images);
  EXPECT_LT(plan_generation(raw_config("sensing: {time: {dropped_percent: 50}}")).images,
            plan_generation(raw_config()).images);
}

TEST(Moving, ExposuresFollowTheDriveAndTheTruthTellsThem) {
  const Scenario scenario = resolve_scenario(moving_config());
  const std::map<std::string, double>& labels = scenario.truth.cameras[0].sensing;
  EXPECT_EQ(labels.at("motion_blur_ms"), 20.0);
  EXPECT_EQ(labels.at("readout_ms"), 20.0);
  EXPECT_EQ(labels.count("depth_readout_ms"), 0U) << "the D455's imagers have global shutters";
  EXPECT_GT(labels.at("exposure_parts"), 4.0);
  EXPECT_LE(labels.at("exposure_step_px"), 0.5);
  EXPECT_FALSE(scenario.truth.T_robot_chassis) << "it stands on equal wheels, unloaded";
  bool stood = false, moved = false;
  for (const FrameJob& job : scenario.frames) {
    const TrueStop& stop = scenario.truth.stops[job.stop];
    ASSERT_TRUE(stop.velocity.has_value());
    EXPECT_EQ(job.files.exposure_s, 0.02);
    const Exposure exposure = color_exposure(scenario, job);
    EXPECT_EQ(exposure.parts(), static_cast<std::size_t>(job.color_parts));
    EXPECT_EQ(depth_exposure(scenario, job).parts(), 1U);
    stood = stood || job.color_parts == 1;
    moved = moved || job.color_parts > 4;
    // The poses of the parts lie about the truth's pose of the stop, as its velocity says.
    const double span_s = 0.04 * (1.0 - 1.0 / job.color_parts);
    const Rigid3 T_world_scene = scenario.truth.stops[0].T_world_robot * scenario.T_scene_robot[0].inverse();
    const Vector6d from_first =
        se3_log((T_world_scene * exposure.T_world_robot.front()).inverse() * stop.T_world_robot);
    EXPECT_LT((from_first - 0.5 * span_s * *stop.velocity).norm(), 1e-3) << job.stop;
  }
  EXPECT_TRUE(moved);
  EXPECT_TRUE(stood) << "it stands before it starts";
}

// On unequal wheels and under a load the model's frame, in which cameras are mounted, leans. The truth has the frame
// that lies in the ground, and cameras are where they were.
TEST(Moving, TheTruthsRobotFrameLiesInTheGroundHoweverTheRobotLeans) {
  const Scenario scenario = resolve_scenario(parse_generate_config(
      "{motion: drive, drive: {capture: moving, frame_rate_hz: 1, wheel_diameter_ratio: 1.02, payload_kg: 20, "
      "payload_x_m: 0.3}, sensing: {time: {camera_delay_ms: 30}}, poses: 2, seed: 3, image_scale: 0.3, "
      "rig: husky_1x_d455}",
      "leaning.yaml"));
  const Truth& truth = scenario.truth;
  ASSERT_TRUE(truth.T_robot_chassis);
  const Vector6d stance = se3_log(*truth.T_robot_chassis);
  EXPECT_LT(stance[2], -5e-4);
  EXPECT_LT(stance[3], -3e-3);
  EXPECT_GT(stance[4], 3e-3);
  const TrueStop& at_rest = truth.stops.back();
  ASSERT_LT(at_rest.velocity->norm(), 1e-4);
  EXPECT_LT(std::abs(at_rest.T_world_robot.translation.z()), 1e-6);
  EXPECT_LT((at_rest.T_world_robot.rotation * Eigen::Vector3d::UnitZ()).head<2>().norm(), 1e-6);
  const Rigid3& T_model_camera = scenario.rig.T_robot_camera[0];
  const Rigid3& T_robot_camera = truth.cameras[0].T_robot_camera;
  const Rigid3 T_world_scene = truth.T_world_board * scenario.subject.T_scene_board.inverse();
  EXPECT_LT(std::abs(T_world_scene.rotation_matrix()(2, 2) - 1.0), 1e-12) << "both are level";
  double fastest = 0.0;
  for (const std::vector<TrueStop>* stops : {&truth.stops, &truth.cameras[0].stops}) {
    ASSERT_FALSE(stops->empty());
    for (const TrueStop& stop : *stops) {
      const double later_s = 0.02;
      const Rigid3 T_scene_model = scenario.trajectory.at(stop.stamp_s);
      const Rigid3 later = T_scene_model * se3_exp(later_s * scenario.trajectory.velocity(stop.stamp_s));
      const auto off = [&](const Rigid3& T_world_robot, const Rigid3& T_scene) {
        return se3_log((T_world_robot * T_robot_camera).inverse() * T_world_scene * T_scene * T_model_camera).norm();
      };
      EXPECT_LT(off(stop.T_world_robot, T_scene_model), 1e-9);
      EXPECT_LT(off(stop.T_world_robot_after(later_s), later), 1e-9);
      fastest = std::max(fastest, stop.velocity->norm());
    }
  }
  EXPECT_GT(fastest, 0.3);
}

TEST(Moving, TooFewPartsAreReportedAndStandingRunsHaveNone) {
  const Scenario capped = resolve_scenario(moving_config("exposure_ms: 20, max_parts: 3"));
  EXPECT_EQ(capped.truth.cameras[0].sensing.at("exposure_parts"), 3.0);
  EXPECT_GT(capped.truth.cameras[0].sensing.at("exposure_step_px"), 0.5);
  const Scenario frozen = resolve_scenario(moving_config("motion_blur: false, rolling_shutter: false"));
  for (const char* label : {"motion_blur_ms", "readout_ms", "exposure_parts"})
    EXPECT_EQ(frozen.truth.cameras[0].sensing.count(label), 0U) << label;
  for (const FrameJob& job : frozen.frames) EXPECT_EQ(job.color_parts, 1);
  const Scenario standing = resolve_scenario(parse_generate_config("{poses: 2, render: {exposure_ms: 50}}", "s.yaml"));
  EXPECT_EQ(standing.truth.cameras[0].sensing.count("motion_blur_ms"), 0U);
  EXPECT_FALSE(standing.truth.stops[0].velocity);
}

// A frame's key hashes each part's view: what changes the shutter changes the frames that move, and no others.
TEST(Moving, ShuttersAndDepthFramesAreRenderKeys) {
  const Scenario a = resolve_scenario(moving_config()), b = resolve_scenario(moving_config("exposure_ms: 24"));
  const std::vector<std::string> keys = clean_frame_keys(a), others = clean_frame_keys(b);
  ASSERT_EQ(keys.size(), others.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    EXPECT_EQ(keys[i] == others[i], a.frames[i].color_parts == 1 && b.frames[i].color_parts == 1) << i;
  GenerateConfig registered = raw_config();
  registered.depth_frame = "registered";
  EXPECT_NE(clean_frame_keys(resolve_scenario(raw_config())), clean_frame_keys(resolve_scenario(registered)));
}

// The pictures of a moving camera with a rolling shutter show corners where the truth's velocity puts their rows.
TEST(Moving, ProofHoldsForBlurredAndLeaningPicturesAndNoticesAWrongVelocity) {
  const TempFolder folder;
  const fs::path cache = folder.path() / "cache";
  GenerateConfig config = moving_config();
  config.image_scale = 0.5;
  generate(config, into(folder.path() / "run", cache));
  generate(config, into(folder.path() / "sensed", cache, false));
  EXPECT_EQ(contents(folder.path() / "run"), contents(folder.path() / "sensed"));
  SeenRun run(folder.path() / "run");
  const Proof proof = run.proof();
  EXPECT_THAT(proof.problems, testing::IsEmpty());
  ASSERT_GE(proof.cameras[0].corners, 36U) << "three boards";
  EXPECT_LT(proof.cameras[0].corner_rms_px.maxCoeff(), 0.1);
  double largest = 0.0;
  for (const TrueStop& stop : run.truth.stops) largest = std::max(largest, stop.velocity->norm());
  EXPECT_GT(largest, 0.2) << "it moved";
  for (TrueStop& stop : run.truth.stops) *stop.velocity = -*stop.velocity;
  EXPECT_FALSE(run.proof().passed);
}

// Three cameras of 0 to 40 ms, each with a delay of its own.
const char* const kNoTrigger = "camera_delay_ms: {uniform: [0, 40]}";

GenerateConfig without_trigger(const std::string& time = kNoTrigger, double frame_rate_hz = 1.0) {
  GenerateConfig config = moving_config();
  config.rig = "husky_3x_d455";
  config.drive.frame_rate_hz = frame_rate_hz;
  config.sensing.time =
      parse_generate_config("{motion: drive, drive: {capture: moving}, sensing: {time: {" + time + "}}}", "time.yaml")
          .sensing.time;
  return config;
}

double delay_s(const Scenario& scenario, std::size_t camera) {
  const std::map<std::string, double>& labels = scenario.truth.cameras[camera].sensing;
  const auto found = labels.find("camera_delay_s");
  return found == labels.end() ? 0.0 : found->second;
}

TEST(WithoutTrigger, ImagesStampsAndTruthAreThoseOfEachCamerasTime) {
  const Scenario scenario = resolve_scenario(without_trigger());
  const Rigid3 T_world_scene = scenario.truth.stops[0].T_world_robot * scenario.T_scene_robot[0].inverse();
  EXPECT_NE(delay_s(scenario, 0), delay_s(scenario, 1));
  EXPECT_NE(delay_s(scenario, 1), delay_s(scenario, 2));
  double farthest_m = 0.0;
  for (const FrameJob& job : scenario.frames) {
    const TrueStop &shared = scenario.truth.stops[job.stop], &own = scenario.truth.stops_of(job.camera)[job.stop];
    EXPECT_NEAR(own.stamp_s, shared.stamp_s + delay_s(scenario, job.camera), 1e-12);
    EXPECT_EQ(job.files.stamp_s, own.stamp_s);
    const Rigid3 T_scene_robot = scenario.trajectory.at(own.stamp_s);
    EXPECT_LT(se3_log((T_world_scene * T_scene_robot).inverse() * own.T_world_robot).norm(), 1e-9);
    EXPECT_EQ(*own.velocity, scenario.trajectory.velocity(own.stamp_s));
    farthest_m = std::max(farthest_m, (own.T_world_robot.translation - shared.T_world_robot.translation).norm());
    // The exposure begins and ends about that time, too.
    const Exposure color = color_exposure(scenario, job), depth = depth_exposure(scenario, job);
    const std::vector<Rigid3> poses = job.color_parts > 1
                                          ? scenario.trajectory.during(own.stamp_s, 0.04, job.color_parts)
                                          : std::vector<Rigid3>{T_scene_robot};
    ASSERT_EQ(color.parts(), poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i)
      EXPECT_LT(se3_log(color.T_world_robot[i].inverse() * poses[i]).norm(), 1e-9);
    EXPECT_LT(se3_log(depth.T_world_robot[0].inverse() * T_scene_robot).norm(), 1e-9);
  }
  EXPECT_GT(farthest_m, 0.005);
}

TEST(WithoutTrigger, ADelayOfZeroChangesNoByteAndAnotherOneTheFramesThatMove) {
  const TempFolder folder;
  const Scenario plain = resolve_scenario(without_trigger("clock_offset_ms: 3")),
                 zero = resolve_scenario(without_trigger("clock_offset_ms: 3, camera_delay_ms: {choice: [0]}")),
                 late = resolve_scenario(without_trigger("clock_offset_ms: 3, camera_delay_ms: {uniform: [5, 40]}"));
  save_truth(plain.truth, folder / "plain.yaml");
  save_truth(zero.truth, folder / "zero.yaml");
  EXPECT_EQ(folder.read("plain.yaml"), folder.read("zero.yaml"));
  const std::vector<std::string> keys = clean_frame_keys(plain), late_keys = clean_frame_keys(late);
  EXPECT_EQ(clean_frame_keys(zero), keys);
  EXPECT_EQ(zero.drive_bytes, plain.drive_bytes);
  EXPECT_EQ(late.drive_bytes, plain.drive_bytes) << "cameras that are late drive nowhere else";
  ASSERT_EQ(late_keys.size(), keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    EXPECT_EQ(plain.frames[i].files.stamp_s, zero.frames[i].files.stamp_s);
    const bool moves = plain.frames[i].color_parts > 1;
    EXPECT_TRUE(!moves || late_keys[i] != keys[i]) << i;
  }
}

// Stamps may be wrong as ever; when images are taken is not drawn anew.
TEST(WithoutTrigger, OtherNoiseKeepsTheDelaysAndThePictures) {
  GenerateConfig config = without_trigger();
  const Scenario before = resolve_scenario(config);
  config.sensing.seed = 77;
  config.sensing.time.clock_offset_ms = 20.0;
  const Scenario after = resolve_scenario(config);
  EXPECT_EQ(clean_frame_keys(after), clean_frame_keys(before));
  for (std::size_t i = 0; i < before.frames.size(); ++i)
    EXPECT_NEAR(after.frames[i].files.stamp_s, before.frames[i].files.stamp_s + 0.02, 1e-12);
  for (std::size_t camera = 0; camera < 3; ++camera) EXPECT_EQ(delay_s(after, camera), delay_s(before, camera));
}

TEST(WithoutTrigger, NothingIsTakenAfterTheDrive) {
  const Scenario whole = resolve_scenario(without_trigger("camera_delay_ms: 0", 5.0)),
                 late = resolve_scenario(without_trigger("camera_delay_ms: 700", 5.0));
  EXPECT_EQ(late.stop_count(), whole.stop_count());
  EXPECT_LT(late.frame_count(), whole.frame_count());
  EXPECT_GE(late.frame_count() + 3U * 4U, whole.frame_count());
  for (const FrameJob& job : late.frames) EXPECT_LE(job.files.stamp_s, late.trajectory.end_s());
  const double one_image_hz = 1.0 / (whole.trajectory.end_s() - 0.5);
  EXPECT_EQ(resolve_scenario(without_trigger("camera_delay_ms: 0", one_image_hz)).stop_count(), 1U);
  const std::string error =
      error_text([&] { resolve_scenario(without_trigger("camera_delay_ms: 700", one_image_hz)); });
  EXPECT_THAT(error, HasSubstr("sensing.time.camera_delay_ms"));
  EXPECT_THAT(error, HasSubstr("700 ms"));
  EXPECT_THAT(error, HasSubstr("after the drive's end"));
}

TEST(WithoutTrigger, PicturesAgreeWithTheTruthAndSenseMakesNoOthers) {
  const TempFolder folder;
  const fs::path cache = folder.path() / "cache";
  GenerateConfig config = without_trigger();
  config.image_scale = 0.4;
  generate(config, into(folder.path() / "run", cache));
  generate(config, into(folder.path() / "sensed", cache, false));
  EXPECT_EQ(contents(folder.path() / "run"), contents(folder.path() / "sensed"));
  GenerateConfig other = without_trigger("camera_delay_ms: {uniform: [0, 41]}");
  other.image_scale = 0.4;
  EXPECT_THAT(error_text([&] { generate(other, into(folder.path() / "other", cache, false)); }),
              HasSubstr("clean renders"));
  SeenRun run(folder.path() / "run");
  const Proof proof = run.proof();
  EXPECT_THAT(proof.problems, testing::IsEmpty());
  std::size_t corners = 0;
  for (const CameraProof& camera : proof.cameras) corners += camera.corners;
  EXPECT_GE(corners, 100U);
  // With the others' poses instead of its own a camera's pictures are wrong, and why is said.
  std::swap(run.truth.stops, run.truth.cameras[1].stops);
  for (std::size_t i = 0; i < run.truth.stops.size(); ++i)
    std::swap(run.truth.stops[i].stamp_s, run.truth.cameras[1].stops[i].stamp_s);
  EXPECT_THAT(worded(run.proof().problems), Contains(HasSubstr("without this camera's delay")));
}

TEST(RawDepth, IsRecordedWithItsOwnCameraAndTheTruthTellsIt) {
  const Scenario scenario = resolve_scenario(raw_config());
  const DepthStream& depth = *scenario.recording.rig.cameras[0].depth;
  ASSERT_TRUE(depth.own_camera.has_value());
  EXPECT_EQ(depth.own_camera->camera.width_px, 424) << "half of the preset's";
  EXPECT_NEAR(depth.own_camera->T_color_depth.translation.x(), -0.059, 1e-12);
  ASSERT_TRUE(scenario.truth.cameras[0].depth_camera.has_value());
  EXPECT_EQ(scenario.truth.cameras[0].depth_camera->camera.width_px, 424);
  EXPECT_THAT(error_text([] { resolve_scenario(raw_config("rig: cart_5x_mixed\n")); }), HasSubstr("depth_frame: raw"));
}

TEST(RawDepth, ComesFromTheCacheWithTheSameBytes) {
  const TempFolder folder;
  const GenerateConfig config = raw_config(
      "clouds: pcd\nsensing: {depth: {texture_holes: true, occlusion: true, edges: true, bias_field: true}}\n");
  generate(config, into(folder.path() / "run", folder.path() / "cache"));
  generate(config, into(folder.path() / "sensed", folder.path() / "cache", false));
  EXPECT_EQ(contents(folder.path() / "run"), contents(folder.path() / "sensed"));
  // A cloud lies in the colour camera's frame, as the points of the depth image do.
  const Recording recording = load_recording(RunFolder{folder.path() / "run"}.recording());
  const CameraFrame& frame = recording.frames[0][0];
  const auto image = read_depth_image(recording.folder / frame.depth_file);
  const auto cloud = read_point_cloud(recording.folder / frame.cloud_file);
  const Image16& depth = std::get<Image16>(image);
  EXPECT_EQ(depth.width, 424);
  std::size_t compared = 0;
  const auto& points = std::get<std::vector<Eigen::Vector3f>>(cloud);
  const DepthStream& stream = *recording.rig.cameras[0].depth;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p_depth = stream.own_camera->T_color_depth.inverse() * point.cast<double>();
    Eigen::Vector2d pixel;
    ASSERT_TRUE(stream.own_camera->camera.project(p_depth, &pixel));
    const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
    EXPECT_NEAR((pixel - Eigen::Vector2d(x, y)).norm(), 0.0, 1e-2);
    EXPECT_NEAR(p_depth.z(), stream.unit_m * depth.at(x, y), 1e-4);
    ++compared;
  }
  EXPECT_GT(compared, 1000U);
}

// The same floor and board, seen from two places: planes agree within what either states.
TEST(RawDepth, AgreesWithRegisteredDepthInGroundAndBoardPlanes) {
  const TempFolder folder;
  generate(raw_config("sensing: {told: exact}\n"), into(folder.path() / "raw"));
  generate(
      parse_generate_config("include: plain.yaml\nposes: 3\nimage_scale: 0.5\nsensing: {told: exact}\n", "raw.yaml"),
      into(folder.path() / "registered"));
  const SeenRun raw(folder.path() / "raw"), registered(folder.path() / "registered");
  const auto compare = [](const std::vector<PlaneObservation>& a, const std::vector<PlaneObservation>& b) {
    double chi_square = 0.0;
    std::size_t count = 0;
    for (const PlaneObservation& p : a) {
      for (const PlaneObservation& q : b) {
        if (p.stop != q.stop || p.camera != q.camera) continue;
        const Eigen::Vector3d d = p.inverse_depth_plane - q.inverse_depth_plane;
        chi_square += d.dot((p.covariance_per_m2 + q.covariance_per_m2).ldlt().solve(d));
        ++count;
      }
    }
    EXPECT_GE(count, 6U);
    // Mean of chi-square with 3 degrees of freedom over six planes and more: above 6 once in ten thousand.
    EXPECT_LT(chi_square / static_cast<double>(count), 6.0);
  };
  compare(raw.observations.ground_planes, registered.observations.ground_planes);
  compare(raw.observations.board_planes, registered.observations.board_planes);
}

TEST(RawDepth, ProofNoticesAWrongTransform) {
  const TempFolder folder;
  generate(raw_config("sensing: {told: exact}\n"), into(folder.path() / "run"));
  SeenRun run(folder.path() / "run");
  EXPECT_THAT(run.proof().problems, testing::IsEmpty());
  EXPECT_GT(run.proof().cameras[0].depth_pixels, 500U);
  Rigid3& T_color_depth = run.recording.rig.cameras[1].depth->own_camera->T_color_depth;
  const Rigid3 right = T_color_depth;
  T_color_depth = right.inverse();
  ASSERT_FALSE(run.proof().problems.empty());
  EXPECT_TRUE(run.proof().problems[0].is("proof.depth_frame"));
  EXPECT_EQ(*run.proof().problems[0].find("way"), FindingValue("way", "inverted"));
  EXPECT_THAT(worded(run.proof().problems), Contains(HasSubstr("center: T_color_depth in rig.yaml is off by .12 m")));
  EXPECT_THAT(worded(run.proof().problems), Contains(HasSubstr("inverted")));
  T_color_depth = Rigid3();
  EXPECT_THAT(worded(run.proof().problems), Contains(HasSubstr("measured where colour is")));
  T_color_depth = right * Rigid3(Eigen::Quaterniond::Identity(), {0.0, 0.0002, 0.0});
  EXPECT_THAT(worded(run.proof().problems), Contains(HasSubstr("off by")));
  T_color_depth = right;
  run.recording.rig.cameras[1].depth->own_camera.reset();
  EXPECT_THAT(worded(run.proof().problems), Contains(HasSubstr("no depth.T_color_depth")));
  // Depth that was not measured where the truth says: the pictures themselves tell.
  SeenRun broken(folder.path() / "run");
  Rigid3& T_true = broken.truth.cameras[1].depth_camera->T_color_depth;
  T_true = Rigid3(Eigen::Quaterniond(Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitX())), {-0.059, 0.0, 0.05});
  broken.recording.rig.cameras[1].depth->own_camera->T_color_depth = T_true;
  EXPECT_THAT(worded(broken.proof().problems), Contains(HasSubstr("center: depth")));
}

}  // namespace
}  // namespace rigproof
