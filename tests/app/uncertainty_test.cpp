// suggest, moved and --accept as a user types them.
#include <nlohmann/json.hpp>

#include "cli_fixture.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

// The first stops of the small run by themselves.
std::string first_stops(const TempFolder& scratch, int count) {
  const std::string all = (scratch / "all.json").string(), few = (scratch / "few.json").string();
  rigproof_command({"observe", small_run().string(), "-o", all, "-q"});
  Observations observations = load_observations(all);
  observations.stops.resize(static_cast<std::size_t>(count));
  const auto later = [count](const auto& item) { return item.stop >= count; };
  const auto cut = [&later](auto* items) {
    items->erase(std::remove_if(items->begin(), items->end(), later), items->end());
  };
  cut(&observations.board_views);
  cut(&observations.ground_planes);
  cut(&observations.board_planes);
  cut(&observations.exclusions);
  save_observations(observations, few);
  return few;
}

TEST(Uncertainty, CommandsAreListedWithExamples) {
  EXPECT_THAT(rigproof_command({"--help"}).out, AllOf(HasSubstr("suggest"), HasSubstr("moved")));
  EXPECT_THAT(rigproof_command({"suggest", "--help"}).out, HasSubstr("rigproof suggest monday/"));
  EXPECT_THAT(rigproof_command({"moved", "--help"}).out, HasSubstr("rigproof moved tuesday/"));
  EXPECT_THAT(rigproof_command({"schema", "accept"}).out, HasSubstr("split_half"));
}

// From a straight line to a solved calibration: what is suggested is rendered and calibrated as it is.
TEST(Uncertainty, WhatIsSuggestedCanBeReplayed) {
  const TempFolder scratch;
  const std::string straight = (scratch / "straight").string(), next = (scratch / "next.yaml").string();
  write_whole_file(scratch / "straight.yaml",
                   "image_scale: 0.5\nodometry: {lambda: 0.2}\nsensor_noise: none\n"
                   "viewpoints: {planner: list, list_frame: board, list: [{x_m: 3.4, yaw_deg: 180}, "
                   "{x_m: 3.0, yaw_deg: 180}, {x_m: 2.6, yaw_deg: 180}, {x_m: 2.2, yaw_deg: 180}]}\n");
  ASSERT_EQ(rigproof_command({"generate", (scratch / "straight.yaml").string(), "-o", straight, "-q"}).exit_code, 0);
  ASSERT_EQ(rigproof_command({"calibrate", straight, "-q"}).exit_code, 3);
  const ProcessOutput output = rigproof_command({"suggest", straight, "--stops", "4", "--output", next});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_THAT(output.out,
              AllOf(HasSubstr("3 cameras x 4 stops: partial"), HasSubstr("NEXT"), HasSubstr("THEN     solved"),
                    ContainsRegex("tx \\[cm\\] .* roll \\[deg\\] +pitch +yaw"), Not(HasSubstr("rx"))));
  const std::string replay = (scratch / "replay").string();
  const ProcessOutput generated = rigproof_command({"generate", next, "-o", replay, "-q"});
  ASSERT_EQ(generated.exit_code, 0) << generated.err << read_whole_file(next);
  EXPECT_EQ(rigproof_command({"calibrate", replay, "-q"}).exit_code, 0);
  EXPECT_EQ(rigproof_command({"validate", replay}).exit_code, 0) << rigproof_command({"validate", replay}).out;
}

// Frames of a straight drive are no stops: the replay drives on from the last stop that was calibrated.
TEST(Uncertainty, AReplayHasNoStraightDrive) {
  const TempFolder scratch;
  const std::string run = (scratch / "run").string(), next = (scratch / "next.yaml").string();
  const std::vector<std::string> generate = {
      "generate", "-q", "-o", run, "--set", "poses=6", "--set", "image_scale=0.3", "--set", "straight_drive.frames=6"};
  ASSERT_EQ(rigproof_command(generate).exit_code, 0);
  const ProcessOutput output = rigproof_command({"suggest", run, "-k", "2", "--output", next});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_THAT(output.out, HasSubstr("3 cameras x 6 stops"));
  const ProcessOutput planned = rigproof_command({"generate", "--dry-run", next});
  EXPECT_EQ(planned.exit_code, 0) << planned.err;
  EXPECT_THAT(planned.out, AllOf(HasSubstr("8 stops, 24 images"), Not(HasSubstr("0 cameras at"))))
      << read_whole_file(next);
}

TEST(Uncertainty, SuggestIsJsonForMachines) {
  const TempFolder scratch;
  const ProcessOutput output = rigproof_command({"suggest", first_stops(scratch, 5), "--json", "-k", "2"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  const nlohmann::json json = nlohmann::json::parse(output.out);
  EXPECT_EQ(json["stops"].size(), 2U);
  EXPECT_EQ(json["cameras"].size(), 3U);
  EXPECT_TRUE(json["stops"][0]["distance_m"].is_number());
  EXPECT_EQ(rigproof_command({"suggest", first_stops(scratch, 5), "-k", "0"}).exit_code, 2);
}

TEST(Uncertainty, SuggestCountsWithThePriorsOfTheMethod) {
  // A focal length that is not believed leaves more open along the view: ahead, for the center camera.
  const auto ahead = [](const std::string& method) {
    const ProcessOutput output = rigproof_command({"suggest", small_run().string(), "--json", "-k", "1", "-m", method});
    EXPECT_EQ(output.exit_code, 0) << output.err;
    return nlohmann::json::parse(output.out)["cameras"][1]["now"]["tx_m"].get<double>();
  };
  EXPECT_GT(ahead("ml:focal_sigma_percent=2"), 1.5 * ahead("ml"));
  const ProcessOutput other = rigproof_command({"suggest", small_run().string(), "--method", "memroc"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, AllOf(HasSubstr("--method: memroc"), HasSubstr("allowed: ml,")));
}

TEST(Uncertainty, MovedSaysWhichCamera) {
  const TempFolder scratch;
  const std::string few = first_stops(scratch, 3);
  rigproof_command({"calibrate", small_run().string(), "-o", scratch.path().string(), "-q"});
  const std::string before = (scratch / "ml.yaml").string();
  const ProcessOutput still = rigproof_command({"moved", few, before});
  EXPECT_EQ(still.exit_code, 0) << still.out << still.err;
  EXPECT_THAT(still.out, AllOf(HasSubstr("stands"), HasSubstr("PASS     nothing moved"), Not(HasSubstr("FAIL"))));
  // A previous result with the center camera a centimetre higher: against it, the camera has sunk.
  Result result = load_result(before);
  for (EstimatedTransform& T : result.camera_to_robot)
    if (T.child == "center") T.T_parent_child.translation.z() += 0.01;
  save_result(result, scratch / "higher.yaml");
  const ProcessOutput sunk = rigproof_command({"moved", few, (scratch / "higher.yaml").string()});
  EXPECT_EQ(sunk.exit_code, 1) << sunk.out << sunk.err;
  EXPECT_THAT(sunk.out, AllOf(ContainsRegex(" center +moved"), HasSubstr("FAIL     a camera moved"),
                              ContainsRegex("tx \\[cm\\] .* roll \\[deg\\] +pitch +yaw")));
  EXPECT_LT(sunk.out.find("FAIL "), sunk.out.find("now less then")) << "the verdict first";
  const ProcessOutput json = rigproof_command({"moved", few, (scratch / "higher.yaml").string(), "--json"});
  EXPECT_EQ(nlohmann::json::parse(json.out)["outcome"], "moved");
  EXPECT_EQ(rigproof_command({"moved", few, (scratch / "missing.yaml").string()}).exit_code, 2);
}

TEST(Uncertainty, AcceptGatesACalibration) {
  const TempFolder scratch;
  const std::string out = scratch.path().string(), junit = (scratch / "gates.xml").string();
  const ProcessOutput good =
      rigproof_command({"calibrate", small_run().string(), "-o", out, "--accept", "default", "--junit", junit});
  EXPECT_EQ(good.exit_code, 0) << good.out << good.err;
  EXPECT_THAT(good.out, AllOf(HasSubstr("accept default.yaml"), HasSubstr("split half: left"),
                              ContainsRegex("ACCEPTED  40/40 gates\naccept default.yaml"),
                              ContainsRegex("left in base_footprint: tx +[.0-9]+ cm +0.8 cm  ok")));
  EXPECT_THAT(read_whole_file(junit), AllOf(HasSubstr("<testsuite"), HasSubstr("held-out stops")));
  write_whole_file(scratch / "strict.yaml", "uncertainty: {xy_mm: 0.0001}\n");
  const std::vector<std::string> strict = {"calibrate", small_run().string(), "-o",
                                           out,         "--accept",           (scratch / "strict.yaml").string()};
  const ProcessOutput bad = rigproof_command(strict);
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.out, AllOf(HasSubstr("FAIL"), HasSubstr("REJECTED")));
  std::vector<std::string> as_json = strict;
  as_json.emplace_back("--json");
  const nlohmann::json json = nlohmann::json::parse(rigproof_command(as_json).out);
  EXPECT_FALSE(json["results"][0]["acceptance"]["passed"].get<bool>());
  EXPECT_EQ(rigproof_command({"calibrate", small_run().string(), "-o", out, "--accept", "none_such"}).exit_code, 2);
}

TEST(Uncertainty, ARefusalIsSaidOnceForAllItsReasons) {
  const TempFolder scratch;
  const std::string file = first_stops(scratch, 2);
  Observations observations = load_observations(file);
  observations.ground_planes.clear();
  save_observations(observations, file);
  const ProcessOutput refused = rigproof_command({"calibrate", file, "-o", scratch.path().string()});
  EXPECT_EQ(refused.exit_code, 3) << refused.out << refused.err;
  EXPECT_THAT(refused.out, ContainsRegex("REFUSED  .*at least 3 are needed.*\n         .*no ground seen"));
  EXPECT_EQ(refused.out.find("REFUSED"), refused.out.rfind("REFUSED"));
}

// The limits that a user writes into rig.yaml hold without any option.
TEST(Uncertainty, TheRigsLimitsGateACalibration) {
  const TempFolder scratch;
  const std::string file = (scratch / "run.json").string(), out = (scratch / "results").string(),
                    junit = (scratch / "gates.xml").string();
  ASSERT_EQ(rigproof_command({"observe", small_run().string(), "-o", file, "-q"}).exit_code, 0);
  Observations observations = load_observations(file);
  const auto calibrated_within = [&](double xy_m, const std::vector<std::string>& more) {
    observations.accept = AcceptLimits{xy_m, 0.1, 0.1};
    save_observations(observations, file);
    std::vector<std::string> arguments = {"calibrate", file, "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return rigproof_command(arguments);
  };
  const ProcessOutput good = calibrated_within(0.1, {});
  EXPECT_EQ(good.exit_code, 0) << good.out << good.err;
  EXPECT_THAT(good.out, AllOf(HasSubstr("accept limits of the rig"), HasSubstr("ACCEPTED  18/18 gates")));
  fs::remove_all(out);
  const ProcessOutput bad = calibrated_within(1e-9, {"--junit", junit});
  EXPECT_EQ(bad.exit_code, 1) << bad.out << bad.err;
  EXPECT_THAT(bad.out, HasSubstr("REJECTED  12/18 gates"));  // x and y of three cameras
  EXPECT_TRUE(fs::exists(fs::path(out) / "ml.yaml"));
  EXPECT_THAT(read_whole_file(junit), HasSubstr("failures=\"6\""));
  const ProcessOutput both = calibrated_within(1e-9, {"--accept", "default"});
  EXPECT_EQ(both.exit_code, 1);
  EXPECT_THAT(both.out, AllOf(HasSubstr("accept default.yaml, limits of the rig"), HasSubstr("split half: left"),
                              HasSubstr("REJECTED  34/40 gates")));
  const nlohmann::json json = nlohmann::json::parse(calibrated_within(1e-9, {"--json"}).out);
  EXPECT_FALSE(json["results"][0]["acceptance"]["passed"].get<bool>());
}

TEST(Uncertainty, LimitsOfTheRigMustBePositive) {
  const TempFolder scratch;
  const std::string file = (scratch / "run.json").string();
  ASSERT_EQ(rigproof_command({"observe", small_run().string(), "-o", file, "-q"}).exit_code, 0);
  Observations observations = load_observations(file);
  observations.accept = AcceptLimits{0.0, 0.1, 0.1};
  save_observations(observations, file);
  const ProcessOutput output = rigproof_command({"calibrate", file});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, AllOf(HasSubstr("accept.xy_mm: 0: allowed is above 0"), Not(HasSubstr("e-308"))));
}

}  // namespace
}  // namespace rigproof
