// Rivals, methods from outside and the MEMROC layout, as a user types them.
#include <cmath>
#include <sstream>

#include "cli_fixture.h"
#include "onnx_bytes.h"
#include "paths.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(Rivals, MethodsSaysWhatEachNeedsAndGives) {
  const std::string list = rigproof_command({"methods"}).out;
  std::vector<std::string> names;
  std::istringstream lines(list);
  for (std::string line, name; std::getline(lines, line);)
    if (line.rfind(' ', 0) != 0 && std::istringstream(line) >> name) names.push_back(name);
  EXPECT_THAT(names, testing::IsSupersetOf(
                         {"memroc_reference", "robot_autocalib_board", "sensorx2car", "li", "opencv_daniilidis"}));
  for (const char* said : {"rotation only", "camera to camera only"}) EXPECT_THAT(list, HasSubstr(said));
}

// Observations have no images: one method says so before it runs, the other answers.
TEST(Rivals, AMethodThatCannotRunSaysSo) {
  const TempFolder scratch;
  const std::string observations = (scratch / "observations.json").string();
  ASSERT_EQ(rigproof_command({"observe", small_run().string(), "-o", observations}).exit_code, 0);
  const std::string results = (scratch / "results").string();
  const ProcessOutput output =
      rigproof_command({"calibrate", observations, "-m", "sensorx2car", "-m", "li", "-o", results});
  EXPECT_EQ(output.exit_code, 3) << output.err;
  EXPECT_THAT(output.out, HasSubstr("observations only"));
  EXPECT_EQ(load_result(scratch / "results/sensorx2car.yaml").status, ResultStatus::kRefused);
  EXPECT_EQ(load_result(scratch / "results/li.yaml").status, ResultStatus::kSolved);
}

TEST(Rivals, LiIsJudgedByItsPairs) {
  const TempFolder scratch;
  const std::string results = (scratch / "results").string(), run = small_run().string();
  ASSERT_EQ(rigproof_command({"calibrate", run, "-m", "li", "-o", results}).exit_code, 0);
  const ProcessOutput output = rigproof_command({"validate", run, results + "/li.yaml", "--json"});
  EXPECT_EQ(output.exit_code, 0) << output.out;
}

// The depth of the small run is not used, and heights come out all the same.
TEST(ImageGround, CalibratesWithoutDepth) {
  const TempFolder scratch;
  const std::string results = (scratch / "results").string(), run = small_run().string();
  const ProcessOutput output =
      rigproof_command({"calibrate", run, "-m", "memroc", "--ground", "images", "-o", results});
  EXPECT_EQ(output.exit_code, 0) << output.out << output.err;
  EXPECT_THAT(output.out, HasSubstr("left: ground from images"));
  const Result result = load_result(results + "/memroc-ground_images.yaml");
  EXPECT_EQ(result.method, "memroc-ground_images");
  const double heights_m[] = {0.700, 0.640, 0.725};
  ASSERT_EQ(result.camera_to_robot.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(result.camera_to_robot[i].T_parent_child.translation.z(), heights_m[i], 0.02);
}

TEST(ImageGround, MistakesAreNamed) {
  const TempFolder scratch;
  const std::string run = small_run().string(), observations = (scratch / "observations.json").string();
  const auto error = [&](const std::vector<std::string>& arguments) {
    const ProcessOutput output = rigproof_command(arguments);
    EXPECT_EQ(output.exit_code, 2) << output.out;
    return output.err;
  };
  EXPECT_THAT(error({"observe", run, "-o", observations, "--ground", "image"}), HasSubstr("images"));
  EXPECT_THAT(error({"observe", run, "-o", observations, "--features", "surf"}), HasSubstr("onnx:FILE"));
  EXPECT_THAT(error({"calibrate", run, "--features", "onnx:/no/such.onnx"}), HasSubstr("/no/such.onnx"));
  const std::string keypoints = scratch.write("keypoints.onnx", keypoint_network()).string();
  EXPECT_THAT(error({"calibrate", run, "--horizon", "onnx:" + keypoints}), HasSubstr("keypoints.onnx"));
  EXPECT_FALSE(std::filesystem::exists(observations));
  ASSERT_EQ(rigproof_command({"observe", run, "-o", observations}).exit_code, 0);
  EXPECT_THAT(error({"calibrate", observations, "--ground", "images", "-o", (scratch / "r").string()}),
              HasSubstr("observations only"));
}

TEST(External, ADescriptionStandsWhereAMethodDoes) {
  const TempFolder scratch;
  const std::string results = (scratch / "results").string(), run = small_run().string();
  const std::string example = source_path("docs/examples/ground_only.yaml");
  const ProcessOutput output =
      rigproof_command({"calibrate", run, "-m", "memroc", "-m", "external:" + example, "-o", results});
  EXPECT_EQ(output.exit_code, 0) << output.out << output.err;
  const Result result = load_result(results + "/ground_only.yaml");
  EXPECT_EQ(result.method, "ground_only");
  // The rig's cameras stand at 70, 64 and 72.5 cm; clean depth rounded to 1 mm.
  const double heights_m[] = {0.700, 0.640, 0.725};
  ASSERT_EQ(result.camera_to_robot.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(result.camera_to_robot[i].T_parent_child.translation.z(), heights_m[i], 2e-3);
}

TEST(External, AFailureIsARowAndExitCode3) {
  const TempFolder scratch;
  const std::string method = scratch.write("broken.yaml", "command: [/no/such/program]\n").string();
  const ProcessOutput output = rigproof_command({"calibrate", small_run().string(), "-m", "external:" + method, "-m",
                                                 "memroc", "-o", (scratch / "results").string()});
  EXPECT_EQ(output.exit_code, 3);
  EXPECT_THAT(output.out, HasSubstr("cannot be started"));
  EXPECT_EQ(load_result(scratch / "results/broken.yaml").status, ResultStatus::kRefused);
  EXPECT_EQ(load_result(scratch / "results/memroc.yaml").status, ResultStatus::kSolved);
  EXPECT_EQ(rigproof_command({"calibrate", small_run().string(), "-m", "external:/no/such.yaml"}).exit_code, 2);
}

// There and back: corners come from the same images, odometry from the same poses.
TEST(Convert, TheMemrocLayoutGivesTheSameObservations) {
  const TempFolder scratch;
  const std::string layout = (scratch / "layout").string(), back = (scratch / "back").string();
  const ProcessOutput there = rigproof_command({"convert", small_run().string(), layout});
  ASSERT_EQ(there.exit_code, 0) << there.err;
  EXPECT_THAT(there.out, HasSubstr("30 images, 30 clouds"));
  EXPECT_THAT(there.out, HasSubstr("left is camera1 there"));
  ASSERT_EQ(rigproof_command({"convert", layout, back}).exit_code, 0);
  std::vector<Observations> all;
  for (const std::string& input : {small_run().string(), layout, back}) {
    const fs::path file = scratch / (std::to_string(all.size()) + ".json");
    ASSERT_EQ(rigproof_command({"observe", input, "-o", file.string()}).exit_code, 0);
    all.push_back(load_observations(file));
  }
  for (std::size_t i = 1; i < all.size(); ++i) {
    ASSERT_EQ(all[i].board_views.size(), all[0].board_views.size());
    for (std::size_t v = 0; v < all[0].board_views.size(); ++v)
      for (std::size_t c = 0; c < all[0].board_views[v].corners.size(); ++c)
        EXPECT_EQ(all[i].board_views[v].corners[c].pixel, all[0].board_views[v].corners[c].pixel);
    for (std::size_t s = 0; s < all[0].stops.size(); ++s)
      EXPECT_NEAR(all[i].stops[s].yaw_rad, all[0].stops[s].yaw_rad, 1e-12);
  }
  EXPECT_EQ(rigproof_command({"convert", small_run().string(), layout}).exit_code, 2);
}

}  // namespace
}  // namespace rigproof
