// `rigproof board`, and runs whose robot drives or whose board is bad, as a user meets their mistakes.
#include "cli_fixture.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

TEST(BoardCommand, WritesAPdfByPresetAndByMeasures) {
  const TempFolder scratch;
  const fs::path file = scratch / "b.pdf";
  EXPECT_EQ(rigproof_command({"board", "checkerboard_6x5_110mm", "-o", file.string()}).exit_code, 0);
  EXPECT_THAT(read_whole_file(file), AllOf(HasSubstr("%PDF-"), HasSubstr("660 mm if exact")));
  EXPECT_EQ(rigproof_command({"board", "--squares", "7x5", "--square-mm", "20", "--type", "charuco", "--paper", "a4",
                              "-o", file.string()})
                .exit_code,
            0);
  EXPECT_THAT(read_whole_file(file), HasSubstr("DICT_5X5_50"));
  for (const char* preset : {"charuco_7x5_100mm", "aprilgrid_6x4_130mm"}) {
    EXPECT_EQ(rigproof_command({"board", preset, "-o", file.string()}).exit_code, 0) << preset;
    EXPECT_THAT(read_whole_file(file), AllOf(HasSubstr("%PDF-"), HasSubstr("mm if exact"))) << preset;
  }
}

TEST(BoardCommand, WritesTheFormatOfItsEndingAndNoOther) {
  const TempFolder scratch;
  for (const auto& [name, begin] :
       {std::pair("b.svg", "<svg "), {"b.dxf", "0\nSECTION\n2\nHEADER\n"}, {"b.PDF", "%PDF-"}}) {
    const fs::path file = scratch / name;
    EXPECT_EQ(rigproof_command({"board", "checkerboard_6x5_110mm", "-o", file.string()}).exit_code, 0) << name;
    EXPECT_THAT(read_whole_file(file), testing::StartsWith(begin));
  }
  for (const char* name : {"c.png", "c.eps", "c"}) {
    const fs::path file = scratch / name;
    const ProcessOutput output = rigproof_command({"board", "checkerboard_6x5_110mm", "-o", file.string()});
    EXPECT_EQ(output.exit_code, 2) << name;
    EXPECT_THAT(output.err, AllOf(HasSubstr("--output"), HasSubstr(name), HasSubstr(".pdf, .svg or .dxf")));
    EXPECT_FALSE(fs::exists(file)) << name;
  }
}

TEST(BoardCommand, SpreadsALargeBoardOverTiles) {
  const TempFolder scratch;
  const std::string file = (scratch / "b.pdf").string();
  const std::vector<std::string> command = {
      "board", "checkerboard_6x5_110mm", "--paper", "a4", "--tiles", "--overlap-mm", "15", "-o", file};
  const ProcessOutput output = rigproof_command(command);
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_THAT(output.out, HasSubstr("4 rows x 3 columns of a4"));
  EXPECT_THAT(read_whole_file(file), AllOf(HasSubstr("row 4, column 3 of 4 x 3"), HasSubstr("/Count 13")));
}

TEST(BoardCommand, OptionsThatContradictAreNamedTogether) {
  const TempFolder scratch;
  const auto error = [&](const char* name, std::vector<std::string> arguments) {
    const fs::path file = scratch / name;
    arguments.insert(arguments.begin(), {"board", "checkerboard_6x5_110mm"});
    arguments.insert(arguments.end(), {"-o", file.string()});
    const ProcessOutput output = rigproof_command(arguments);
    EXPECT_EQ(output.exit_code, 2) << output.out;
    EXPECT_FALSE(fs::exists(file));
    return output.err;
  };
  EXPECT_THAT(error("b.svg", {"--tiles"}), AllOf(HasSubstr("--tiles: contradicts .svg"),
                                                 HasSubstr("--tiles: contradicts --paper fit"), HasSubstr("a4")));
  EXPECT_THAT(error("b.dxf", {"--tiles", "--paper", "a4"}), HasSubstr("--tiles: contradicts .dxf"));
  EXPECT_THAT(error("b.pdf", {"--paper", "a0", "--overlap-mm", "12"}), HasSubstr("--overlap-mm: "));
  EXPECT_THAT(error("b.pdf", {"--printer-margin-mm", "51"}), HasSubstr("50"));
}

TEST(BoardCommand, MistakesAreNamed) {
  const TempFolder scratch;
  const std::string file = (scratch / "b.pdf").string();
  const auto error = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "board");
    arguments.insert(arguments.end(), {"-o", file});
    const ProcessOutput output = rigproof_command(arguments);
    EXPECT_EQ(output.exit_code, 2) << output.out;
    return output.err;
  };
  EXPECT_THAT(error({"--squares", "6x4", "--square-mm", "20"}),
              AllOf(HasSubstr("6x4"), HasSubstr("180 degrees"), HasSubstr("6x3")));
  EXPECT_THAT(error({"--squares", "6by5", "--square-mm", "20"}), AllOf(HasSubstr("6by5"), HasSubstr("columns x rows")));
  EXPECT_THAT(error({"--squares", "6x5"}), HasSubstr("--square-mm"));
  EXPECT_THAT(error({"--squares", "6x5", "--square-mm", "110", "--paper", "a4"}), HasSubstr("do not fit"));
  EXPECT_THAT(error({"--squares", "6x5", "--square-mm", "110", "--paper", "a7"}), HasSubstr("a4"));
  EXPECT_THAT(error({"checkerboard_6x5_110mm", "--squares", "7x6", "--square-mm", "20"}),
              AllOf(HasSubstr("--squares: contradicts the preset checkerboard_6x5_110mm"),
                    HasSubstr("--square-mm: contradicts")));
  EXPECT_THAT(error({"checkerboard_6x5_110mm", "--type", "charuco"}), HasSubstr("--type: contradicts"));
  EXPECT_THAT(error({"checkerboard_9x9"}), HasSubstr("checkerboard_6x5_110mm"));
  EXPECT_FALSE(fs::exists(file));
}

TEST(DrivenRun, MistakesAreNamed) {
  const TempFolder scratch;
  const auto error = [&](const std::string& config) {
    const ProcessOutput output = rigproof_command(
        {"generate", scratch.write("c.yaml", config).string(), "--dry-run", "-o", (scratch / "run").string()});
    EXPECT_EQ(output.exit_code, 2) << output.out;
    return output.err;
  };
  EXPECT_THAT(error("motion: fly\n"), AllOf(HasSubstr("motion"), HasSubstr("teleport, drive")));
  EXPECT_THAT(error("motion: drive\nodometry: {declared: true}\n"), HasSubstr("odometry.declared"));
  EXPECT_THAT(error("odometry: {model: wheels, scale: 1.1}\n"), HasSubstr("must be 1 with wheels"));
  EXPECT_THAT(error("drive: {max_speed_m_s: 0}\n"), AllOf(HasSubstr("max_speed_m_s"), HasSubstr("0.05")));
  // Ice, and a hollow that the robot cannot leave: every way is named, and the run ends.
  EXPECT_THAT(error("motion: drive\nposes: 2\nviewpoints: {planner: list, list: [{x_m: 0, y_m: 0}, {x_m: 3, y_m: 0}]}\n"
                    "drive: {friction: 0.02, max_plans: 2, ramps: [{height_cm: -25, level_m: 0.6}]}\n"),
              AllOf(HasSubstr("viewpoint 2"), HasSubstr("cannot be reached"), HasSubstr("stuck")));
  EXPECT_THAT(error("board: {type: aprilgrid, squares: [30, 29]}\n"), HasSubstr("870 markers"));
}

}  // namespace
}  // namespace rigproof
