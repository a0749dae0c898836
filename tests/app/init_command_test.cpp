// From the bag that a robot would have recorded of a run to the same poses as from the run itself.
#include <nlohmann/json.hpp>
#include <set>

#include "bag_bytes.h"
#include "cli_fixture.h"
#include "rigproof/core/image_cell.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/result.h"
#include "schema_check.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using json = nlohmann::json;

InfoFields info_of(const RigCamera& camera) {
  InfoFields info;
  info.frame_id = camera.name + "_optical";
  info.width = static_cast<std::uint32_t>(camera.camera.width_px);
  info.height = static_cast<std::uint32_t>(camera.camera.height_px);
  info.k = {camera.camera.fx_px, 0, camera.camera.cx_px, 0, camera.camera.fy_px, camera.camera.cy_px, 0, 0, 1};
  return info;
}

// Stamps of the small run count from 0; a robot's clock does not.
constexpr double kEpoch_s = 1700000000.0;

// As a robot's description has them: the mounts are a guess.
Recorded frames_of(const Recording& recording) {
  std::vector<TransformFields> transforms = {{"base_footprint", "base_link", {0, 0, 0.13, 0, 0, 0, 1}}};
  for (const RigCamera& camera : recording.rig.cameras) {
    transforms.push_back({"base_link", camera.name + "_link", {0.2, 0, 0.5, 0, 0, 0, 1}});
    transforms.push_back({camera.name + "_link", camera.name + "_optical", {0, 0.015, 0, -0.5, 0.5, -0.5, 0.5}});
  }
  return {"/tf_static", "tf2_msgs/msg/TFMessage", kEpoch_s, tf_message(kEpoch_s, transforms)};
}

std::string bag_of(const Recording& recording, bool with_frames = false) {
  std::vector<Recorded> messages;
  if (with_frames) messages.push_back(frames_of(recording));
  for (const OdometrySample& row : recording.odometry) {
    const double t = kEpoch_s + row.stamp_s;
    const PoseFields pose{row.x_m, row.y_m, 0, 0, 0, std::sin(0.5 * row.yaw_rad), std::cos(0.5 * row.yaw_rad)};
    messages.push_back({"/odom", "nav_msgs/msg/Odometry", t, odometry_message(t, pose, "base_footprint")});
  }
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    const RigCamera& camera = recording.rig.cameras[i];
    const std::string name = "/" + camera.name, frame = camera.name + "_optical";
    for (const CameraFrame& image : recording.frames[i]) {
      const double t = kEpoch_s + image.stamp_s;
      const std::string color = read_whole_file(recording.folder / image.color_file);
      const std::string depth = std::string(12, '\0') + read_whole_file(recording.folder / image.depth_file);
      messages.push_back({name + "/camera_info", "sensor_msgs/msg/CameraInfo", t, info_message(info_of(camera), t)});
      messages.push_back({name + "/image_raw/compressed", "sensor_msgs/msg/CompressedImage", t,
                          compressed_message(t, frame, "rgb8; png compressed bgr8", color)});
      messages.push_back({name + "/depth/image_raw/compressedDepth", "sensor_msgs/msg/CompressedImage", t,
                          compressed_message(t, frame, "16UC1; compressedDepth png", depth)});
    }
  }
  McapLayout layout;
  layout.compression = "zstd";
  layout.chunk_bytes = 1U << 20U;
  return mcap_bytes(messages, layout);
}

TEST(RecordCheck, TellsTheSameOfARunAndOfItsBagAndFollowsUntilNothingChanges) {
  const TempFolder scratch;
  const Recording recording = load_recording(small_run() / "recording");
  const fs::path bag = scratch.write("run.mcap", bag_of(recording));
  const ProcessOutput of_run = rigproof_command({"record-check", small_run().string(), "--json"});
  ASSERT_EQ(of_run.exit_code, 0) << of_run.err;
  const ProcessOutput of_bag =
      rigproof_command({"record-check", bag.string(), "--board", "checkerboard_5x4_100mm", "--json"});
  ASSERT_EQ(of_bag.exit_code, 0) << of_bag.err;
  const json run = json::parse(of_run.out);
  EXPECT_EQ(run["stops"], 10);
  EXPECT_EQ(run["cameras"], json::parse(of_bag.out)["cameras"]);
  const ProcessOutput followed =
      rigproof_command({"record-check", small_run().string(), "--follow", "--until-idle", "1"});
  EXPECT_EQ(followed.exit_code, 0) << followed.err;
  EXPECT_THAT(followed.out, AllOf(HasSubstr("stop 9: "), HasSubstr("parts of 48"), HasSubstr("10 stops in ")));
  // No terminal: nothing is written over.
  EXPECT_EQ(followed.out.find('\033'), std::string::npos);
}

TEST(RecordCheck, MistakesAreNamed) {
  const TempFolder scratch;
  const auto error = [](const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"record-check"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ProcessOutput output = rigproof_command(all);
    EXPECT_EQ(output.exit_code, 2) << output.out;
    return output.err;
  };
  EXPECT_THAT(error({(scratch / "nowhere").string(), "--follow"}), HasSubstr("no such file or folder"));
  EXPECT_THAT(error({small_run().string(), "--until-idle", "3"}), HasSubstr("--follow"));
  EXPECT_THAT(error({small_run().string(), "--squares", "6b5"}), HasSubstr("6b5"));
  EXPECT_THAT(error({small_run().string(), "--odometry", "x.csv"}), HasSubstr("is a recording"));
  fs::create_directories(scratch / "empty");
  EXPECT_THAT(error({(scratch / "empty").string(), "--follow", "--until-idle", "1"}), HasSubstr("no trajectory"));
}

TEST(InitCommand, ABagCalibratesToTheSamePosesAsItsRecording) {
  const TempFolder scratch;
  const Recording recording = load_recording(small_run() / "recording");
  const fs::path bag = scratch.write("run.mcap", bag_of(recording)), made = scratch / "monday";
  const ProcessOutput output =
      rigproof_command({"init", bag.string(), "--board", "checkerboard_5x4_100mm", "-o", made.string(), "--json"});
  ASSERT_EQ(output.exit_code, 0) << output.out << output.err;
  const json report = json::parse(output.out);
  EXPECT_EQ(schema_violations(report, json::parse(rigproof_command({"schema", "init_output"}).out)), "");
  EXPECT_EQ(report["stops"], 10);
  const std::string seen = (scratch / "seen.json").string();
  ASSERT_EQ(rigproof_command({"observe", made.string(), "-o", seen}).exit_code, 0);
  const Observations observations = load_observations(seen);
  for (std::size_t c = 0; c < report["cameras"].size(); ++c) {
    const json& camera = report["cameras"][c];
    EXPECT_GE(camera["board_stops"], 8) << camera["name"];
    std::set<std::size_t> cells;
    for (const BoardView& view : observations.board_views)
      for (const CornerObservation& corner : view.corners)
        if (observations.cameras[c].name == camera["name"] && view.camera == static_cast<int>(c))
          cells.insert(image_cell(observations.cameras[c].camera, corner.pixel));
    EXPECT_EQ(camera["cells"], cells.size()) << camera["name"];
    EXPECT_GE(cells.size(), 2U) << camera["name"];
  }

  // With the same facts of the rig the same numbers: all that differs are stamps, which have 2e-7 s since 1970.
  Recording imported = load_recording(made);
  fs::copy_file(small_run() / "recording/rig.yaml", made / "rig.yaml", fs::copy_options::overwrite_existing);
  const fs::path ours = scratch / "ours", theirs = scratch / "theirs";
  ASSERT_EQ(rigproof_command({"calibrate", (small_run() / "recording").string(), "-o", ours.string()}).exit_code, 0);
  ASSERT_EQ(rigproof_command({"calibrate", made.string(), "-o", theirs.string()}).exit_code, 0);
  const Result expected = load_result(ours / "ml.yaml"), result = load_result(theirs / "ml.yaml");
  ASSERT_EQ(result.camera_to_robot.size(), expected.camera_to_robot.size());
  for (std::size_t i = 0; i < expected.camera_to_robot.size(); ++i) {
    const Vector6d error =
        transform_error(result.camera_to_robot[i].T_parent_child, expected.camera_to_robot[i].T_parent_child);
    EXPECT_LT(error.norm(), 1e-6) << i;
  }
  EXPECT_EQ(imported.odometry.size(), recording.odometry.size());
}

double largest_difference(const Result& a, const Result& b) {
  EXPECT_EQ(a.camera_to_robot.size(), b.camera_to_robot.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < a.camera_to_robot.size(); ++i)
    largest = std::max(
        largest, transform_error(a.camera_to_robot[i].T_parent_child, b.camera_to_robot[i].T_parent_child).norm());
  return largest;
}

// A run as a bag and back: with the same facts of the rig the numbers are the same, to nanoseconds of the stamps.
TEST(ConvertCommand, ABagOfARunCalibratesToTheSameNumbers) {
  const TempFolder scratch;
  const std::string run = small_run().string(), ours = (scratch / "ours").string();
  ASSERT_EQ(rigproof_command({"calibrate", run + "/recording", "-o", ours}).exit_code, 0);
  const Result expected = load_result(fs::path(ours) / "ml.yaml");
  for (const std::vector<std::string>& how : {std::vector<std::string>{"--packing", "lz4"}, {"--compressed"}}) {
    const TempFolder folder;
    const std::string bag = (folder / "run.mcap").string(), made = (folder / "monday").string();
    std::vector<std::string> convert = {"convert", run, bag};
    convert.insert(convert.end(), how.begin(), how.end());
    const ProcessOutput output = rigproof_command(convert);
    ASSERT_EQ(output.exit_code, 0) << output.err;
    EXPECT_THAT(output.out, AllOf(HasSubstr("mcap  "), HasSubstr("depth images"), HasSubstr("that is sought")));
    EXPECT_EQ(read_whole_file(bag).find("square_mm"), std::string::npos) << "no rig.yaml is in it";
    ASSERT_EQ(rigproof_command({"init", bag, "-o", made, "--every-image"}).exit_code, 0);
    fs::copy_file(small_run() / "recording/rig.yaml", fs::path(made) / "rig.yaml",
                  fs::copy_options::overwrite_existing);
    ASSERT_EQ(rigproof_command({"calibrate", made}).exit_code, 0);
    EXPECT_LT(largest_difference(load_result(fs::path(made) / "results/ml.yaml"), expected), 1e-9) << how[0];
    EXPECT_EQ(rigproof_command({"convert", run, bag}).exit_code, 2) << "nothing is overwritten";
  }
}

// What a bag says of the robot's frames is enough for its tree: three commands and no question.
TEST(InitCommand, FromTheBagToTheTreeNothingIsAsked) {
  const TempFolder scratch;
  const Recording recording = load_recording(small_run() / "recording");
  const fs::path bag = scratch.write("run.mcap", bag_of(recording, true)), made = scratch / "monday";
  ASSERT_EQ(
      rigproof_command({"init", bag.string(), "--board", "checkerboard_5x4_100mm", "-o", made.string()}).exit_code, 0);
  ASSERT_EQ(rigproof_command({"calibrate", made.string()}).exit_code, 0);
  const ProcessOutput output = rigproof_command({"export", made.string(), "--to", "json"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  const json exported = json::parse(output.out);
  const Result result = load_result(made / "results/ml.yaml");
  ASSERT_EQ(exported["tree"].size(), recording.rig.cameras.size());
  for (std::size_t i = 0; i < recording.rig.cameras.size(); ++i) {
    const json& edge = exported["tree"][i];
    EXPECT_EQ(edge["parent"], "base_link");
    EXPECT_EQ(edge["child"], recording.rig.cameras[i].name + "_link");
    const std::vector<double> t = edge["translation_m"], q = edge["quaternion_xyzw"];
    const Rigid3 T_base_link({q[3], q[0], q[1], q[2]}, {t[0], t[1], t[2]});
    const Rigid3 T_robot_base(Eigen::Quaterniond::Identity(), {0, 0, 0.13});
    const Rigid3 T_link_optical({0.5, -0.5, 0.5, -0.5}, {0, 0.015, 0});
    const Vector6d error =
        transform_error(T_robot_base * T_base_link * T_link_optical, result.camera_to_robot[i].T_parent_child);
    EXPECT_LT(error.norm(), 1e-9);
  }
}

TEST(InitCommand, SaysWhatItFoundAndWhatIsMissing) {
  const TempFolder scratch;
  const fs::path bag = scratch.write("run.mcap", bag_of(load_recording(small_run() / "recording")));
  const ProcessOutput output = rigproof_command({"init", bag.string(), "-o", (scratch / "monday").string()});
  EXPECT_EQ(output.exit_code, 0);
  EXPECT_THAT(output.out, AllOf(HasSubstr("/left/image_raw/compressed"), HasSubstr("10 of 10 images"),
                                HasSubstr("MISSING"), HasSubstr("squares: [5, 4]"), HasSubstr("board in 10 of 10"),
                                HasSubstr("next: write what is missing into " + (scratch / "monday/rig.yaml").string() +
                                          ", then rigproof calibrate")));
  const ProcessOutput calibration = rigproof_command({"calibrate", (scratch / "monday").string()});
  EXPECT_EQ(calibration.exit_code, 2);
  EXPECT_THAT(calibration.err, HasSubstr("board"));
}

TEST(InitCommand, BadInputExitsWithTwo) {
  const TempFolder scratch;
  const fs::path ros1 = scratch.write("old.bag", "#ROSBAG V2.0\n");
  const ProcessOutput output = rigproof_command({"init", ros1.string(), "-o", (scratch / "monday").string()});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, HasSubstr("rosbags-convert"));
  const ProcessOutput squares = rigproof_command({"init", ros1.string(), "--squares", "6x5", "-o", "x"});
  EXPECT_EQ(squares.exit_code, 2);
  EXPECT_THAT(squares.err, HasSubstr("--square-mm"));
}

}  // namespace
}  // namespace rigproof
