// Methods from outside: what they are given, what becomes of their answers, and of those that misbehave.
#include "rigproof/study/workflow/external.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>

#include "error_text.h"
#include "paths.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/files.h"
#include "rigproof/formats/format.h"
#include "rigproof/geometric/geometric.h"
#include "rigproof/validate/validate.h"
#include "small_recording.h"
#include "temp_folder.h"
#include "worded.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const char* const kAnswer =
    "- {parent: base_link, child: left, translation_m: [0.3, 0.1, 0.6], quaternion_xyzw: [-0.5, 0.5, -0.5, 0.5]}\n"
    "- {parent: base_link, child: right, translation_m: [0.3, -0.1, 0.6], quaternion_xyzw: [-0.5, 0.5, -0.5, 0.5]}\n";

class External : public testing::Test {
 protected:
  External() : recording_(small_recording(scratch_ / "recording")) {
    observations_.robot_frame = recording_.rig.robot_frame;
    observations_.cameras = recording_.rig.cameras;
    observations_.board = recording_.rig.board;
    observations_.source = (scratch_ / "run").string();
    scratch_.write("answer.yaml", kAnswer);
  }

  // A method that is a shell script; `more` are further lines of its description.
  std::shared_ptr<const Method> script(const std::string& text, const std::string& more = "") {
    scratch_.write("script.sh", text);
    const fs::path file = scratch_.write(
        "theirs.yaml", "command: [sh, \"{here}/script.sh\", \"{input}\", \"{output}\", \"{here}\"]\n" + more);
    return make_external_method(file, options_);
  }

  Result run(const Method& method) { return run_method(method, {observations_, &recording_, 1}); }
  Result run(const std::string& text, const std::string& more = "") { return run(*script(text, more)); }

  TempFolder scratch_;
  Recording recording_;
  Observations observations_;
  ExternalOptions options_;
};

std::string text(const std::vector<Finding>& findings) { return testing::PrintToString(worded(findings)); }

TEST_F(External, AnAnswerIsAResultUnderTheMethodsName) {
  const Result result = run("cp \"$3/answer.yaml\" \"$2\"");
  EXPECT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
  EXPECT_EQ(result.method, "theirs");
  ASSERT_EQ(result.camera_to_robot.size(), 2U);
  EXPECT_EQ(result.camera_to_robot[1].T_parent_child.translation, Eigen::Vector3d(0.3, -0.1, 0.6));
}

TEST_F(External, GetsACopyOfTheRecordingAndNothingElse) {
  scratch_.write("recording/truth.yaml", "the truth");
  scratch_.write("truth/truth.yaml", "the truth");
  const Result result =
      run("find .. -type f | sort > \"$3/found.txt\"; echo $PWD > \"$3/where.txt\"; echo spoilt > \"$1/rig.yaml\"\n"
          "cp \"$3/answer.yaml\" \"$2\"");
  EXPECT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
  const std::string found = scratch_.read("found.txt");
  EXPECT_THAT(found, HasSubstr("recording/left/color/000002.png"));
  EXPECT_THAT(found, HasSubstr("recording/left/depth/000000.png"));
  EXPECT_THAT(found, HasSubstr("recording/odometry.csv"));
  EXPECT_THAT(found, testing::Not(HasSubstr("truth")));
  // 6 images, 3 depth images, rig, odometry, two lists of frames; its own two captured outputs, and the scratch mark.
  EXPECT_EQ(std::count(found.begin(), found.end(), '\n'), 16);
  EXPECT_THAT(scratch_.read("recording/rig.yaml"), HasSubstr("base_link"));
  std::string where = scratch_.read("where.txt");
  where.pop_back();
  EXPECT_FALSE(fs::exists(where)) << "its working folder is still there";
}

TEST_F(External, GetsObservationsThatNameNoFolder) {
  const Result result = run("cp \"$1\" \"$3/copy.json\"; cp \"$3/answer.yaml\" \"$2\"", "input: observations\n");
  EXPECT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
  const Observations copy = load_observations(scratch_ / "copy.json");
  EXPECT_EQ(copy.cameras.size(), 2U);
  EXPECT_EQ(copy.source, "");
}

TEST_F(External, TakesSeveralBoardsIfItSaysSo) {
  Board marked;
  marked.type = "charuco";
  marked.dictionary = "DICT_4X4_50";
  observations_.board = marked;
  marked.dictionary = "DICT_5X5_50";
  observations_.more_boards = {marked};
  const std::string answer = "cp \"$1\" \"$3/copy.json\"; cp \"$3/answer.yaml\" \"$2\"";
  const Result refused = run(answer, "input: observations\n");
  EXPECT_EQ(refused.status, ResultStatus::kRefused);
  EXPECT_THAT(text(refused.reasons), HasSubstr("has 2 boards"));
  const Result result = run(answer, "input: observations\nseveral_boards: true\n");
  EXPECT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
  EXPECT_EQ(load_observations(scratch_ / "copy.json").boards(), 2);
  EXPECT_THAT(error_text([&] { script("true", "input: memroc\nseveral_boards: true\n"); }),
              HasSubstr("several_boards: true: must be false with input memroc"));
}

TEST_F(External, GetsTheMemrocLayout) {
  const Result result = run("cp -r \"$1\" \"$3/copy\"; cp \"$3/answer.yaml\" \"$2\"", "input: memroc\n");
  EXPECT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
  EXPECT_EQ(open_input(scratch_ / "copy").recording->frames[1].size(), 3U);
}

TEST_F(External, NeedsARecordingUnlessItWantsObservations) {
  const auto wants_images = script("true");
  EXPECT_THAT(worded(wants_images->why_not({observations_})), HasSubstr("It needs the images"));
  EXPECT_EQ(run_method(*wants_images, {observations_}).status, ResultStatus::kRefused);
  const auto wants_none = script("cp \"$3/answer.yaml\" \"$2\"", "input: observations\n");
  EXPECT_EQ(run_method(*wants_none, {observations_}).status, ResultStatus::kSolved);
}

TEST_F(External, ReadsMatricesFromItsStandardOutput) {
  const std::string lines =
      "echo 'camera 1, 4 5 6'; echo 'X = [0, 0, 1, 0.3; '; echo '-1, 0, 0, 0.1;'; echo '0, -1, 0, 0.6;'; "
      "echo '0, 0, 0, 1]'; echo 'camera 2'; echo '0 0 1 0.3'; echo '-1 0 0 -0.1'; echo '0 -1 0 0.6'\n";
  const std::string more = "output: matrices\noutput_file: \"-\"\n";
  const Result result = run(lines, more);
  ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
  ASSERT_EQ(result.camera_to_robot.size(), 2U);
  EXPECT_EQ(result.camera_to_robot[0].child, "left");
  EXPECT_EQ(result.camera_to_robot[1].T_parent_child.translation, Eigen::Vector3d(0.3, -0.1, 0.6));
  EXPECT_TRUE(
      result.camera_to_robot[0].T_parent_child.rotation_matrix().row(0).isApprox(Eigen::RowVector3d(0.0, 0.0, 1.0)));
  const Result inverted = run(lines, more + "direction: camera_from_robot\ncameras: [right, left]\n");
  ASSERT_EQ(inverted.camera_to_robot.size(), 2U);
  EXPECT_EQ(inverted.camera_to_robot[0].child, "right");
  const Rigid3 T = inverted.camera_to_robot[0].T_parent_child * result.camera_to_robot[0].T_parent_child;
  EXPECT_TRUE(T.matrix().isIdentity(1e-12));
  const std::string far = "echo '0 0 1 1e308'; echo '-1 0 0 0.1'; echo '0 -1 0 0.6'\n";
  EXPECT_THAT(text(run(far + far, more).reasons), HasSubstr("a translation of 1e+308 m; allowed are at most 1e+06 m"));
  EXPECT_THAT(text(run("echo '0 0 1 0.3'; echo '-1 0 0 -0.1'; echo '0 -1 0 0.6'", more).reasons),
              HasSubstr("1 rigid 4x4 matrices in its standard output for 2 cameras"));
}

TEST_F(External, AMissingProgramIsAFailedRow) {
  const fs::path file = scratch_.write("gone.yaml", "command: [/no/such/program, \"{input}\"]\n");
  const Result result = run(*make_external_method(file, {}));
  EXPECT_EQ(result.status, ResultStatus::kRefused);
  EXPECT_THAT(text(result.reasons), HasSubstr("cannot be started: /no/such/program: No such file or directory"));
}

TEST_F(External, ACrashIsAFailedRow) {
  EXPECT_THAT(text(run("kill -SEGV $$").reasons), HasSubstr("ended by signal 11"));
  const Result result = run("echo first >&2; echo 'the board is missing' >&2; exit 3");
  EXPECT_EQ(result.status, ResultStatus::kRefused);
  EXPECT_THAT(text(result.reasons), HasSubstr("exit code 3"));
  EXPECT_THAT(text(result.notes), HasSubstr("it said: the board is missing"));
}

// What the method started holds the pipe open for as long as it lives.
class Held {
 public:
  explicit Held(const fs::path& pipe) {
    if (mkfifo(pipe.c_str(), 0600) == 0) alive_.fd = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  }
  ~Held() { close(alive_.fd); }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;
  // False if it was never opened, too.
  bool is_let_go() { return poll(&alive_, 1, 10000) == 1 && (alive_.revents & POLLHUP) != 0; }

 private:
  pollfd alive_{-1, POLLIN, 0};
};

TEST_F(External, AHangIsEndedWithEverythingThatItStarted) {
  const auto start = std::chrono::steady_clock::now();
  Held held(scratch_ / "held");
  const Result result = run("sleep 60 > \"$3/held\" & sleep 60", "time_limit_s: 0.3\n");
  EXPECT_THAT(text(result.reasons), HasSubstr("ran longer than its limit of 0.3 s"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
  EXPECT_TRUE(held.is_let_go());
}

// A daemon leaves its parent, its group and its session, and listens to nobody; "up" says that it holds the pipe.
const std::string kDaemon =
    "(setsid sh -c 'trap \"\" TERM HUP; exec > \"$0/held\"; touch \"$0/up\"; sleep 60' \"$3\" &)\n"
    "until [ -e \"$3/up\" ]; do sleep 0.01; done\n";

TEST_F(External, ADaemonIsEndedByAnInterrupt) {
  Held held(scratch_ / "held");
  options_.keep_going = [this] { return !fs::exists(scratch_ / "up"); };
  EXPECT_EQ(error_text([&] { run(kDaemon + "sleep 60"); }), "interrupted");
  EXPECT_TRUE(held.is_let_go());
}

TEST_F(External, ADaemonIsEndedWithTheProgram) {
  Held held(scratch_ / "held");
  const Result result = run(kDaemon + "cp \"$3/answer.yaml\" \"$2\"");
  EXPECT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
  EXPECT_TRUE(held.is_let_go());
}

TEST_F(External, AProgramThatEndsItsGroupEndsOnlyItself) {
  EXPECT_THAT(text(run("kill -TERM 0").reasons), HasSubstr("ended by signal 15"));
}

TEST_F(External, GarbageIsAFailedRow) {
  const auto reasons = [this](const std::string& script_text) { return text(run(script_text).reasons); };
  EXPECT_THAT(reasons("true"), HasSubstr("wrote no result.yaml"));
  EXPECT_THAT(reasons("echo hello > \"$2\""), HasSubstr("is no result"));
  EXPECT_THAT(reasons("head -c 100000 /dev/urandom > \"$2\""), HasSubstr("is no result"));
  EXPECT_THAT(reasons("head -c 20000000 /dev/zero > \"$2\""), HasSubstr("More than 16 MB"));
  EXPECT_THAT(reasons("ln -s /etc/passwd \"$2\""), HasSubstr("wrote no result.yaml"));
  EXPECT_THAT(reasons("sed 's/right/nose/; s/base_link/body/' \"$3/answer.yaml\" > \"$2\""),
              HasSubstr("Neither body nor nose is a camera of the rig (left, right)"));
  EXPECT_THAT(reasons("sed 's/0.6/nan/' \"$3/answer.yaml\" > \"$2\""), HasSubstr("is no result"));
  const Result partial = run("head -n 1 \"$3/answer.yaml\" > \"$2\"");
  EXPECT_EQ(partial.status, ResultStatus::kPartial);
  EXPECT_THAT(text(partial.reasons), HasSubstr("right: it gave no pose"));
}

TEST_F(External, KeepsWhatItSaid) {
  options_.log_folder = scratch_ / "results";
  run("echo to out; echo to error >&2; cp \"$3/answer.yaml\" \"$2\"");
  EXPECT_EQ(scratch_.read("results/theirs.log"), "--- standard_output.txt\nto out\n--- standard_error.txt\nto error\n");
}

TEST_F(External, AnInterruptEndsIt) {
  int asked = 0;
  options_.keep_going = [&asked] { return ++asked < 15; };
  const auto method = script("sleep 60");
  try {
    run(*method);
    FAIL() << "went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kTryAgain);
  }
}

TEST_F(External, ADescriptionSaysEverythingThatIsWrongWithIt) {
  const fs::path file = scratch_.write("bad.yaml", "comand: [x]\ninput: pictures\nname: ../up\n");
  const std::string error = error_text([&] { make_external_method(file, {}); });
  for (const char* part : {"did you mean \"command\"", "input", "must name a program", "must be letters"})
    EXPECT_THAT(error, HasSubstr(part));
  const fs::path taken = scratch_.write("ml.yaml", "command: [x]\n");
  EXPECT_THAT(error_text([&] { make_external_method(taken, {}); }), HasSubstr("a method of our own"));
}

TEST_F(External, StandsBesideMethodsOfOurOwn) {
  script("true");
  const auto methods = methods_by_name({"memroc", "external:" + (scratch_ / "theirs.yaml").string()});
  ASSERT_EQ(methods.size(), 2U);
  EXPECT_EQ(methods[0]->traits().name, "memroc");
  EXPECT_EQ(methods[1]->traits().name, "theirs");
  EXPECT_EQ(methods_by_name({})[0]->traits().name, "ml");
  EXPECT_THAT(error_text([] { methods_by_name({"external:/no/such.yaml"}); }), HasSubstr("/no/such.yaml"));
}

// The example of docs/guides/external-methods.md.
TEST(ExternalExample, TwentyLinesOfPythonFindHeightAndTilt) {
  GeometricConfig config;
  config.stops = 20;
  const GeometricRun drawn = draw_geometric_run(config);
  const fs::path example = source_path("docs/examples/ground_only.yaml");
  const Result result = run_method(*make_external_method(example, {}), {drawn.observations});
  ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons) << text(result.notes);
  EXPECT_EQ(result.method, "ground_only");
  const Comparison comparison = compare(result, drawn.truth);
  ASSERT_EQ(comparison.camera_to_robot.size(), 3U);
  for (const TransformError& error : comparison.camera_to_robot) {
    EXPECT_FALSE(error.observable[0]);
    // Twenty planes of 300 points: 0.3 mm and 0.01 deg; five times that is a mistake in the method.
    EXPECT_LT(std::abs(error.error(2)), 1.5e-3);
    EXPECT_LT(error.error.tail<3>().norm(), deg_to_rad(0.05));
  }
}

}  // namespace
}  // namespace rigproof
