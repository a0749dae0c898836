// Bad input, as users meet it: one clear error that names what is wrong, the right exit code, nothing half-written.

#include <algorithm>
#include <cctype>
#include <csignal>
#include <sstream>

#include "cli_fixture.h"
#include "paths.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

constexpr int kBadInput = 2;
constexpr int kRefused = 3;

ProcessOutput calibrate(const fs::path& input, const TempFolder& scratch) {
  return rigproof_command({"calibrate", input.string(), "-m", "joint_memroc", "-o", (scratch / "results").string()});
}

void expect_error(const ProcessOutput& output, const testing::Matcher<const std::string&>& message) {
  EXPECT_EQ(output.exit_code, kBadInput) << output.out << output.err;
  EXPECT_THAT(output.err, message);
}

TEST(BadInput, NothingThere) {
  const TempFolder scratch;
  expect_error(calibrate(scratch / "nowhere", scratch), HasSubstr("nowhere"));
  fs::create_directories(scratch / "empty");
  expect_error(calibrate(scratch / "empty", scratch), AllOf(HasSubstr("empty"), HasSubstr("rig.yaml")));
}

TEST(BadInput, UnknownNamesTellTheNearest) {
  expect_error(rigproof_command({"calibrate", small_run().string(), "-m", "joint_memrok"}), HasSubstr("joint_memroc"));
  const TempFolder scratch;
  const fs::path config = scratch.write("c.yaml", "scene: indor_lab\n");
  expect_error(rigproof_command({"generate", config.string(), "-o", (scratch / "run").string()}),
               HasSubstr("indoor_lab"));
  EXPECT_FALSE(fs::exists(scratch / "run"));
  expect_error(rigproof_command({"calibrat"}), HasSubstr("rigproof: \"calibrat\""));
  expect_error(rigproof_command({"calibrat"}), HasSubstr("did you mean \"calibrate\"?"));
}

TEST(BadInput, MistakesOnTheCommandLineSayWhereHelpIs) {
  expect_error(rigproof_command({}), HasSubstr("Usage: rigproof"));
  expect_error(rigproof_command({"calibrate"}),
               AllOf(HasSubstr("rigproof: INPUT is required"), HasSubstr("rigproof calibrate --help")));
  expect_error(rigproof_command({"calibrate", "x", "--foo"}), HasSubstr("--foo"));
  expect_error(rigproof_command({"--foo"}), HasSubstr("rigproof --help"));
}

TEST(BadInput, NumbersOnTheCommandLineHaveBounds) {
  for (const char* reach : {"1e9", "-1", "0", "nan", "far"})
    expect_error(rigproof_command({"suggest", small_run().string(), "--reach", reach}),
                 HasSubstr(std::string("--reach: ") + reach + ": allowed is 0.01 to 1000\n"));
  expect_error(rigproof_command({"suggest", small_run().string(), "--clearance", "-1"}),
               HasSubstr("--clearance: -1: allowed is 0 to 1000\n"));
  expect_error(rigproof_command({"suggest", small_run().string(), "--area", "-1", "1e9", "0", "1"}),
               HasSubstr("--area: 1e9: allowed is -1000 to 1000\n"));
}

TEST(BadInput, SettingsOfMl) {
  const auto message = [](const std::vector<std::string>& methods) {
    std::vector<std::string> arguments = {"calibrate", small_run().string()};
    for (const std::string& method : methods) arguments.insert(arguments.end(), {"-m", method});
    const ProcessOutput output = rigproof_command(arguments);
    EXPECT_EQ(output.exit_code, 2);
    return output.err;
  };
  EXPECT_THAT(message({"ml:focal_sigma_percent=-1,clock_ms=3"}),
              testing::AllOf(HasSubstr("focal_sigma_percent"), HasSubstr("-1"), HasSubstr("clock_offset_sigma_ms")));
  EXPECT_THAT(message({"ml", "ml:focal_sigma_percent=1,name=ml"}), HasSubstr("two methods of the name ml;"));
  EXPECT_THAT(message({"ml:told=exact", "ml:told=exact"}), HasSubstr("two methods of the name ml-told_exact;"));
  EXPECT_THAT(message({"ml:none.yaml"}), HasSubstr("none.yaml"));
  EXPECT_THAT(message({"ml:focal_sigma_percent=1,name=memroc"}), HasSubstr("name of another method"));
}

TEST(BadInput, EveryProblemOfAConfigurationAtOnce) {
  const TempFolder scratch;
  const fs::path config = scratch.write("c.yaml", "poses: -3\nodometry: {lamda: 2}\nseed: x\n");
  expect_error(rigproof_command({"generate", config.string(), "-o", (scratch / "run").string()}),
               AllOf(HasSubstr("c.yaml:1"), HasSubstr("-3"), HasSubstr("c.yaml:2"), HasSubstr("lamda"),
                     HasSubstr("lambda"), HasSubstr("c.yaml:3"), HasSubstr("seed")));
}

TEST(BadInput, OverridesThatNothingLooksAtAreNamed) {
  const ProcessOutput output =
      rigproof_command({"generate", "--dry-run", "--set", "board.z_m=1", "--set", "odometry.wheels.slip_percent=1",
                        "--set", "render.readout_ms=20", "--set", "viewpoints.list=[{x_m: 1}]", "--set", "poses=4"});
  EXPECT_EQ(output.exit_code, 2) << output.out;
  EXPECT_EQ(output.err,
            "rigproof: --set: board.z_m: 1: is not used without board.place=given\n"
            "--set: odometry.wheels.slip_percent: 1: is not used without odometry.model=wheels\n"
            "--set: render.readout_ms: 20: is not used without motion=drive and drive.capture=moving\n"
            "--set: viewpoints.list: [{x_m: 1}]: is not used without viewpoints.planner=list\n");
  const ProcessOutput used = rigproof_command(
      {"generate", "--dry-run", "--set", "board.z_m=1", "--set", "board.place=given", "--set", "poses=4"});
  EXPECT_EQ(used.exit_code, 0) << used.err;
}

TEST(BadInput, NamesThatAreNoUtf8) {
  const TempFolder scratch;
  const fs::path board = scratch / "caf\xe9.pdf";
  const ProcessOutput drawn = rigproof_command({"board", "checkerboard_6x5_110mm", "--json", "-o", board.string()});
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_THAT(drawn.out, HasSubstr("caf\xEF\xBF\xBD.pdf"));
  EXPECT_TRUE(fs::exists(board));
  const fs::path config = scratch.write("na\xefve \"quoted\".yaml", "scene: office\n");
  const ProcessOutput planned =
      rigproof_command({"generate", config.string(), "--dry-run", "--json", "--set", "poses=4"});
  EXPECT_EQ(planned.exit_code, 0) << planned.err;
  const fs::path copy = copy_of_recording(scratch);
  fs::rename(copy / "left/color/000003.png", copy / "left/color/bild\xe9.png");
  fs::resize_file(copy / "left/color/bild\xe9.png", 500);
  edit_file(copy / "left/frames.csv", "color/000003.png", "color/bild\xe9.png");
  const ProcessOutput solved =
      rigproof_command({"calibrate", copy.string(), "--json", "-o", (scratch / "results").string()});
  EXPECT_EQ(solved.exit_code, 0) << solved.err;
  EXPECT_THAT(solved.out, HasSubstr("bild\xEF\xBF\xBD.png"));
  EXPECT_THAT(scratch.read("results/ml.yaml"), HasSubstr("bild\xEF\xBF\xBD.png"));
}

TEST(BadInput, SpoiledImagesAreLeftOutWithAReason) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  const fs::path color = recording / "left/color";
  fs::remove(color / "000000.png");
  write_whole_file(color / "000001.png", read_whole_file(color / "000001.png").substr(0, 5000));
  write_whole_file(color / "000002.png", "this is no image");
  fs::copy_file(recording / "left/depth/000003.png", color / "000003.png", fs::copy_options::overwrite_existing);
  const ProcessOutput output = calibrate(recording, scratch);
  EXPECT_EQ(output.exit_code, 0) << output.out << output.err;
  EXPECT_THAT(output.out, HasSubstr("left out"));
  const std::string result = read_whole_file(scratch / "results/joint_memroc.yaml");
  for (const char* file : {"000000.png", "000001.png", "000002.png"}) EXPECT_THAT(result, HasSubstr(file));
}

TEST(BadInput, ImagesOfAnotherSize) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  edit_file(recording / "rig.yaml", "width_px: 640", "width_px: 800");
  expect_error(calibrate(recording, scratch), AllOf(HasSubstr("640"), HasSubstr("800"), HasSubstr("left")));
  EXPECT_FALSE(fs::exists(scratch / "results"));
}

TEST(BadInput, SpoiledOdometry) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  const std::string good = read_whole_file(recording / "odometry.csv");
  write_whole_file(recording / "odometry.csv", good + "nan,0,0,0\n2,0,0\n");
  expect_error(calibrate(recording, scratch),
               AllOf(HasSubstr("odometry.csv:12"), HasSubstr("odometry.csv:13"), HasSubstr("nan")));
  write_whole_file(recording / "odometry.csv", good + "1,0,0,0\n");
  expect_error(calibrate(recording, scratch), HasSubstr("odometry.csv:12"));
  std::string shifted;
  std::istringstream lines(good);
  for (std::string line; std::getline(lines, line);)
    shifted += (std::isdigit(line[0]) != 0 ? "9000" : "") + line + "\n";
  write_whole_file(recording / "odometry.csv", shifted);
  expect_error(calibrate(recording, scratch),
               AllOf(HasSubstr("odometry.csv"), HasSubstr("no frame meets it"), HasSubstr("9000")));
  fs::remove(recording / "odometry.csv");
  expect_error(calibrate(recording, scratch), HasSubstr("odometry.csv"));
}

TEST(BadInput, SquaresGivenForCorners) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  edit_file(recording / "rig.yaml", "squares: [5, 4]", "squares: [4, 3]");
  const ProcessOutput output = calibrate(recording, scratch);
  EXPECT_THAT(output.exit_code, AnyOf(kBadInput, kRefused));
  EXPECT_THAT(output.out + output.err, HasSubstr("[5, 4]"));
}

TEST(BadInput, BoardInNoImage) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  edit_file(recording / "rig.yaml", "squares: [5, 4]", "squares: [9, 8]");
  const ProcessOutput output = calibrate(recording, scratch);
  EXPECT_THAT(output.exit_code, AnyOf(kBadInput, kRefused));
  EXPECT_THAT(output.out + output.err, HasSubstr("board"));
}

TEST(BadInput, OneCameraWithoutAnyBoardLeavesTheOthers) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  const std::string picture = read_whole_file(recording / "right/color/000000.png");
  for (const auto& entry : fs::directory_iterator(recording / "right/color")) write_whole_file(entry, "no image");
  const ProcessOutput output = calibrate(recording, scratch);
  EXPECT_EQ(output.exit_code, kRefused) << output.out << output.err;
  EXPECT_THAT(output.out, AllOf(HasSubstr("right"), HasSubstr("REFUSED")));
  EXPECT_THAT(read_whole_file(scratch / "results/joint_memroc.yaml"),
              AllOf(HasSubstr("child: left"), HasSubstr("child: center")));
}

TEST(BadInput, UnwritableOutput) {
  const TempFolder scratch;
  scratch.write("file", "in the way");
  expect_error(
      rigproof_command({"calibrate", small_run().string(), "-m", "joint_memroc", "-o", (scratch / "file/x").string()}),
      HasSubstr("file/x"));
  expect_error(rigproof_command({"generate", "--set", "poses=3", "-o", "/proc/rigproof"}), HasSubstr("/proc/rigproof"));
}

// Solving takes minutes, rendering longer: where the result cannot go is told before.
TEST(BadInput, ResultsThatCouldNotBeWrittenAreRefusedBeforeAnythingIsLookedAt) {
  const TempFolder scratch;
  const fs::path result = scratch.write("results/ml.yaml", "mine");
  fs::permissions(result, fs::perms(0444));
  const ProcessOutput calibrated =
      rigproof_command({"calibrate", small_run().string(), "-o", (scratch / "results").string()});
  expect_error(calibrated, AllOf(HasSubstr("ml.yaml: cannot write"), HasSubstr("read-only")));
  EXPECT_THAT(calibrated.out, Not(HasSubstr("cameras")));
  expect_error(rigproof_command({"calibrate", small_run().string(), "--accept", "default", "-o",
                                 (scratch / "fine").string(), "--junit", scratch.path().string()}),
               HasSubstr("there is a folder of this name"));
  EXPECT_FALSE(fs::exists(scratch / "fine"));
  const ProcessOutput run = rigproof_command({"run", "--set", "poses=3", "-o", (scratch / "run").string(), "--junit",
                                              (scratch / "results/ml.yaml/gate.xml").string()});
  expect_error(run, HasSubstr("is no folder"));
  EXPECT_FALSE(fs::exists(scratch / "run"));
}

// A limit on the size of files stands in for a full disk: writing fails in the same place.
TEST(BadInput, FullDisk) {
  const TempFolder scratch;
  const fs::path run = scratch / "run";
  const ProcessOutput output = run_process({"sh", "-c",
                                            "trap '' XFSZ; ulimit -f 20; exec " + program_path() +
                                                " generate --set poses=3 --set image_scale=0.5 -o " + run.string()});
  expect_error(output, HasSubstr(run.string()));
  for (const auto& entry : fs::recursive_directory_iterator(scratch.path()))
    EXPECT_LE(entry.is_regular_file() ? entry.file_size() : 0U, 20U * 1024U) << entry.path();
}

TEST(BadInput, NoEgl) {
  const TempFolder scratch;
  const ProcessOutput output = run_process({"env", "__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent.json", program_path(),
                                            "generate", "--set", "poses=3", "-o", (scratch / "run").string()});
  expect_error(output, AllOf(HasSubstr("EGL"), HasSubstr("libgl1-mesa-dri")));
}

TEST(BadInput, TablesThatAreNone) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  const std::string odometry = read_whole_file(recording / "odometry.csv");
  const std::string picture = read_whole_file(recording / "left/color/000000.png");
  write_whole_file(recording / "odometry.csv", picture);
  const ProcessOutput binary = calibrate(recording, scratch);
  expect_error(binary, HasSubstr("odometry.csv: is no text"));
  EXPECT_EQ(std::count(binary.err.begin(), binary.err.end(), '\n'), 1) << binary.err;
  write_whole_file(recording / "odometry.csv", odometry);
  write_whole_file(recording / "left/frames.csv", "");
  expect_error(calibrate(recording, scratch), HasSubstr("left/frames.csv: is empty"));
  write_whole_file(recording / "left/frames.csv", "file,stamp\n");
  expect_error(calibrate(recording, scratch), AllOf(HasSubstr("frames.csv:1"), HasSubstr("stamp_s")));
}

TEST(BadInput, SpoiledDepthIsToldApartFromImages) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  const fs::path depth = recording / "left/depth";
  fs::copy_file(recording / "left/color/000000.png", depth / "000000.png", fs::copy_options::overwrite_existing);
  write_whole_file(depth / "000001.png", read_whole_file(depth / "000001.png").substr(0, 3000));
  fs::remove(depth / "000002.png");
  const ProcessOutput output = calibrate(recording, scratch);
  EXPECT_EQ(output.exit_code, 0) << output.out << output.err;
  EXPECT_EQ(output.err, "");
  EXPECT_THAT(output.out, AllOf(HasSubstr("10 used  depth of 3 left out"), HasSubstr("not a 16-bit grey PNG (0)"),
                                HasSubstr("truncated PNG (1)"), HasSubstr("no depth image of this name (2)")));
}

TEST(BadInput, OdometryWithAGapCostsOnlyTheFramesInIt) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  std::istringstream lines(read_whole_file(recording / "odometry.csv"));
  std::string kept;
  int number = 0;
  for (std::string line; std::getline(lines, line); ++number)
    if (number < 4 || number > 6) kept += line + "\n";
  write_whole_file(recording / "odometry.csv", kept);
  const ProcessOutput output = calibrate(recording, scratch);
  EXPECT_EQ(output.exit_code, 0) << output.out << output.err;
  EXPECT_THAT(output.out, AllOf(HasSubstr("3 cameras x 7 stops"), HasSubstr("3 left out: odometry gap of 8.00 s")));
}

TEST(BadInput, HostileFiles) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  std::string laughs = "a: &a [x, x, x, x, x, x, x, x]\n";
  for (char c = 'b'; c < 'l'; ++c) {
    const std::string last(1, static_cast<char>(c - 1));
    laughs += std::string(1, c) + ": &" + c + " [*" + last + ", *" + last + ", *" + last + ", *" + last + "]\n";
  }
  for (const std::string& text :
       {laughs, std::string(200000, '['), std::string("\0\1\2", 3), std::string("cameras: 3")}) {
    write_whole_file(recording / "rig.yaml", text);
    const ProcessOutput output = calibrate(recording, scratch);
    expect_error(output, HasSubstr("rig.yaml"));
    EXPECT_LT(output.err.size(), 2000U);
  }
  for (const char* text : {"", "[[[", "{\"format\": \"rigproof-observations\", \"version\": 1"}) {
    const ProcessOutput output = calibrate(scratch.write("observations.json", text), scratch);
    expect_error(output, AllOf(HasSubstr("observations.json"), testing::Not(HasSubstr("json.exception"))));
  }
  expect_error(rigproof_command({"validate", small_run().string(), (small_run() / "truth/truth.yaml").string()}),
               HasSubstr("rigproof-truth: must be"));
}

TEST(BadInput, FullStandardOutput) {
  const ProcessOutput output = run_process({"sh", "-c", program_path() + " methods > /dev/full"});
  expect_error(output, HasSubstr("standard output"));
}

TEST(BadInput, AFolderOfSomethingElseIsLeftAlone) {
  const TempFolder scratch;
  fs::create_directories(scratch / "thesis");
  write_whole_file(scratch / "thesis/thesis.tex", "precious");
  expect_error(rigproof_command({"generate", "--fresh", "--set", "poses=3", "-o", (scratch / "thesis").string()}),
               HasSubstr("thesis.tex"));
  EXPECT_EQ(scratch.read("thesis/thesis.tex"), "precious");
}

// ---- interrupted ---------------------------------------------------------------------------------------------------

TEST(BadInput, AnArchiveReplacesNothing) {
  const TempFolder scratch;
  scratch.write("thesis/chapter.txt", "a year's work");
  expect_error(rigproof_command({"generate", "--set", "poses=3", "-o", (scratch / "run").string(), "--archive",
                                 (scratch / "thesis").string()}),
               HasSubstr("exists already"));
  const std::string run = (scratch / "run").string();
  for (const std::string& archive : {run, run + "/archive", (scratch / ".").string()})
    expect_error(rigproof_command({"generate", "--set", "poses=3", "-o", run, "--archive", archive}),
                 HasSubstr("must neither lie in the run"));
  EXPECT_FALSE(fs::exists(scratch / "run"));
  expect_error(rigproof_command({"generate", "--set", "poses=3", "--shard-mib", "3"}), HasSubstr("--archive"));
}

std::vector<std::string> generate_command(const fs::path& run) {
  return {program_path(), "generate",          "--set", "poses=12",  "--set", "image_scale=0.5",
          "--set",        "sensor_noise=none", "-o",    run.string()};
}

bool holds_an_image(const fs::path& folder) {
  std::error_code none;
  for (fs::recursive_directory_iterator entry(folder, none), end; entry != end; entry.increment(none))
    if (entry->path().extension() == ".png") return true;
  return false;
}

// Starts a generation and sends the signal as soon as it has begun to write.
ProcessOutput interrupted_generation(const fs::path& run, int signal) {
  BackgroundProcess generation(generate_command(run));
  generation.wait_until([&] { return holds_an_image(run / "recording"); });
  generation.send(signal);
  return generation.wait();
}

TEST(Interrupt, TheSameCommandResumesToTheSameBytes) {
  const TempFolder scratch;
  const fs::path run = scratch / "run";
  const ProcessOutput interrupted = interrupted_generation(run, SIGTERM);
  EXPECT_EQ(interrupted.exit_code, 75) << interrupted.out << interrupted.err;
  EXPECT_THAT(interrupted.err, HasSubstr("resumes"));
  EXPECT_EQ(run_process(generate_command(run)).exit_code, 0);
  const fs::path killed = scratch / "killed";
  EXPECT_EQ(interrupted_generation(killed, SIGKILL).exit_code, 128 + SIGKILL);
  // Two at once: one of them waits or gives way, and nothing is spoiled.
  BackgroundProcess one(generate_command(killed)), other(generate_command(killed));
  const ProcessOutput first = one.wait(), second = other.wait();
  EXPECT_THAT((std::vector<int>{first.exit_code, second.exit_code}), testing::Contains(0)) << first.err << second.err;
  EXPECT_THAT(first.exit_code + second.exit_code, AnyOf(0, 2, 75)) << first.err << second.err;
  EXPECT_EQ(tree_content(run), tree_content(killed));
}

TEST(Interrupt, WhileDrivingItEndsSoonAndNothingIsWritten) {
  const TempFolder scratch;
  const fs::path run = scratch / "run";
  // Signals before the drive are heard as it begins.
  BackgroundProcess drive(
      {program_path(), "generate", "--set", "motion=drive", "--set", "poses=30", "-o", run.string()});
  drive.wait_until_it_handles(SIGTERM);
  drive.send(SIGTERM);
  const ProcessOutput interrupted = drive.wait();
  EXPECT_EQ(interrupted.exit_code, 75) << interrupted.out << interrupted.err;
  EXPECT_THAT(interrupted.err, HasSubstr("interrupted while driving; the same command starts the drive again"));
  EXPECT_FALSE(fs::exists(run));
}

TEST(BadInput, HostileFolder) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  edit_file(recording / "rig.yaml", "folder: left", "folder: ../../../etc");
  expect_error(calibrate(recording, scratch), HasSubstr("../../../etc"));
}

TEST(BadInput, ABagIsNoRunToValidate) {
  const TempFolder scratch;
  const std::string bag = scratch.write("monday.mcap", "x").string();
  expect_error(rigproof_command({"validate", bag}), HasSubstr("is a bag of ROS; `rigproof init " + bag));
}

TEST(BadInput, ForeignResultWithUnknownCamera) {
  const TempFolder scratch;
  const fs::path result = scratch.write(
      "theirs.yaml",
      "- {parent: base_footprint, child: lefty, translation_m: [0, 0, 0], quaternion_xyzw: [0, 0, 0, 1]}\n");
  expect_error(rigproof_command({"validate", small_run().string(), result.string()}),
               AllOf(HasSubstr(result.string() + ": "), HasSubstr("lefty"), HasSubstr("did you mean \"left\"?")));
  expect_error(rigproof_command({"validate", (small_run() / "recording").string(), result.string()}),
               HasSubstr("truth"));
}

// A pipeline shows what JUnit holds: a result that is not there must not look like one that nobody asked for.
TEST(BadInput, ResultsThatCannotBeReadStandInJUnit) {
  const TempFolder scratch;
  const std::string missing = (scratch / "missing.yaml").string(), junit = (scratch / "gate.xml").string();
  const fs::path broken = scratch.write("broken.yaml", "method: [");
  expect_error(rigproof_command({"validate", small_run().string(), missing, broken.string(), "--junit", junit}),
               AllOf(HasSubstr(missing), HasSubstr(broken.string())));
  EXPECT_THAT(read_whole_file(junit),
              AllOf(HasSubstr("errors=\"2\""), HasSubstr("<testsuite name=\"missing.yaml\" tests=\"1\""),
                    HasSubstr("<testsuite name=\"broken.yaml\""), HasSubstr("<error message=")));
}

// ---- drives that cannot answer -------------------------------------------------------------------------------------

/// Generates a run whose robot stands at the listed places [m, deg] of the scene, and calibrates it.
ProcessOutput calibrate_drive(const std::string& places, const TempFolder& scratch) {
  const fs::path config = scratch.write("drive.yaml",
                                        "image_scale: 0.5\nsensor_noise: none\nodometry: {lambda: 0}\n"
                                        "board: {place: given, x_m: 3, y_m: 0, z_m: 0.8, facing_deg: 180}\n"
                                        "viewpoints: {planner: list, order: drawn, list: [" +
                                            places + "]}\n");
  const ProcessOutput generated = rigproof_command({"generate", config.string(), "-o", (scratch / "run").string()});
  EXPECT_EQ(generated.exit_code, 0) << generated.err;
  return calibrate(scratch / "run", scratch);
}

void expect_refusal(const ProcessOutput& output, const testing::Matcher<const std::string&>& reason) {
  EXPECT_EQ(output.exit_code, kRefused) << output.out << output.err;
  EXPECT_THAT(output.out, AllOf(HasSubstr("REFUSED"), reason));
}

TEST(Refusal, TwoPoses) {
  const TempFolder scratch;
  expect_refusal(calibrate_drive("{x_m: 0, y_m: 0, yaw_deg: 0}, {x_m: 0.3, y_m: 0.2, yaw_deg: 8}", scratch),
                 AnyOf(HasSubstr("three"), HasSubstr("2 ")));
}

TEST(Refusal, StraightLine) {
  const TempFolder scratch;
  std::string places;
  for (int i = 0; i < 8; ++i)
    places += "{x_m: " + std::to_string(0.15 * i) + ", y_m: 0, yaw_deg: 0}" + (i < 7 ? ", " : "");
  expect_refusal(calibrate_drive(places, scratch),
                 AllOf(HasSubstr("straight"), HasSubstr("REFUSED  all cameras: x, y"), HasSubstr("USABLE   pose in"),
                       HasSubstr("between cameras: left-center")));
}

TEST(Refusal, TurnInPlace) {
  const TempFolder scratch;
  std::string places;
  for (int i = 0; i < 8; ++i)
    places += "{x_m: 0.5, y_m: 0, yaw_deg: " + std::to_string(-12 + 3 * i) + "}" + (i < 7 ? ", " : "");
  expect_refusal(calibrate_drive(places, scratch), AnyOf(HasSubstr("in place"), HasSubstr("one centre")));
}

}  // namespace
}  // namespace rigproof
