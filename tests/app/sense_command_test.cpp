// Render once, sense many, and the noise curves, as a user types them.
#include <nlohmann/json.hpp>

#include "cli_fixture.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

bool is_png(const fs::path& file) { return read_whole_file(file).substr(1, 3) == "PNG"; }

TEST(SenseCommand, MakesAnotherRealisationWithoutRendering) {
  const TempFolder folder;
  const std::string cache = (folder / "cache").string(), run = (folder / "run").string();
  ASSERT_EQ(rigproof_command({"generate", "--set", "poses=2", "--set", "image_scale=0.2", "--cache", cache, "-o", run})
                .exit_code,
            0);
  const std::string other = (folder / "other").string(), same = (folder / "same").string();
  const ProcessOutput sensed = rigproof_command({"sense", run, "--cache", cache, "--seed", "7", "-o", other, "--json"});
  ASSERT_EQ(sensed.exit_code, 0) << sensed.err;
  EXPECT_EQ(nlohmann::json::parse(sensed.out)["seed"], 7);
  EXPECT_EQ(nlohmann::json::parse(sensed.out)["images"], 6);
  const std::string image = "recording/left/color/000000.jpg";
  EXPECT_NE(read_whole_file(fs::path(other) / image), read_whole_file(fs::path(run) / image));
  ASSERT_EQ(rigproof_command({"sense", run, "--cache", cache, "-o", same}).exit_code, 0);
  EXPECT_EQ(tree_content(same), tree_content(run));

  const std::string third = (folder / "third").string();
  const ProcessOutput refused = rigproof_command({"sense", run, "--cache", cache, "--set", "poses=3", "-o", third});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, testing::AllOf(HasSubstr("poses"), HasSubstr("render key")));
  const ProcessOutput without = rigproof_command({"sense", run, "-o", third});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.err, HasSubstr("--cache"));
  const ProcessOutput no_run = rigproof_command({"sense", cache, "--cache", cache, "-o", third});
  EXPECT_EQ(no_run.exit_code, 2);
  EXPECT_THAT(no_run.err, HasSubstr("no run"));
  const ProcessOutput empty = rigproof_command({"sense", run, "--cache", (folder / "empty").string(), "-o", third});
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_THAT(empty.err, HasSubstr("0 of 6 clean renders"));
}

TEST(SensorsCommand, DrawsTheNoiseOfAPreset) {
  const TempFolder folder;
  const fs::path file = folder / "curve.png";
  const ProcessOutput output = rigproof_command({"sensors", "--plot", "D455", "-o", file.string(), "--json"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_TRUE(is_png(file));
  EXPECT_TRUE(fs::exists(folder / "curve.csv"));
  const nlohmann::json points = nlohmann::json::parse(output.out)["points"];
  ASSERT_EQ(points.size(), 12U);
  // The goal for realised noise against the law, rounding included.
  std::vector<double> distances_m;
  for (const nlohmann::json& point : points) {
    EXPECT_NEAR(point["realised_mm"].get<double>() / point["recorded_mm"].get<double>(), 1.0, 0.05) << point;
    distances_m.push_back(point["z_m"]);
  }
  EXPECT_THAT(distances_m, testing::IsSupersetOf({0.8, 1.0, 2.0, 4.0}));
  const ProcessOutput unknown = rigproof_command({"sensors", "--plot", "d456"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("d455"));
  const ProcessOutput without_depth = rigproof_command({"sensors", "--plot", "fisheye", "-o", file.string()});
  EXPECT_EQ(without_depth.exit_code, 2);
  EXPECT_THAT(without_depth.err, HasSubstr("no depth"));
}

}  // namespace
}  // namespace rigproof
