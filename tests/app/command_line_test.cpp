// What the command line says of itself: help, mistakes, completion, the manual.
#include <cstdlib>

#include "cli_fixture.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(CommandLine, HelpListsCommandsInGroups) {
  const ProcessOutput help = rigproof_command({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out,
              AllOf(HasSubstr("\nFrom a robot to its frames:\n  board "), HasSubstr("\nExperiments:\n  sweep "),
                    HasSubstr("\nThe tool itself:\n  doctor "), Not(HasSubstr("Subcommands:"))));
}

TEST(CommandLine, MistypedOptionsAndCommandsNameTheNearest) {
  const ProcessOutput options = rigproof_command({"calibrate", "monday", "--methd=ml", "--jnit", "out.xml"});
  EXPECT_EQ(options.exit_code, 2);
  EXPECT_THAT(options.err, AllOf(HasSubstr("--methd: there is no such option; did you mean \"--method\"?"),
                                 HasSubstr("--jnit: there is no such option; did you mean \"--junit\"?"),
                                 HasSubstr("`rigproof calibrate --help`")));
  const ProcessOutput command = rigproof_command({"sweep", "strat", "a.yaml"});
  EXPECT_EQ(command.exit_code, 2);
  EXPECT_THAT(command.err, HasSubstr("\"strat\": there is no such command; did you mean \"start\"?"));
  EXPECT_THAT(rigproof_command({"init", "--squaers", "6x5"}).err, HasSubstr("did you mean \"--squares\"?"))
      << "before what is missing";
}

TEST(CommandLine, MistypedValuesNameTheNearest) {
  const auto expect_near = [](const std::vector<std::string>& command, const char* value) {
    const ProcessOutput output = rigproof_command(command);
    EXPECT_EQ(output.exit_code, 2);
    EXPECT_THAT(output.err, HasSubstr("did you mean \"" + std::string(value) + "\"? known: ")) << command[0];
  };
  expect_near({"calibrate", "monday", "--ground", "dpth"}, "depth");
  expect_near({"board", "--paper", "a5"}, "a4");
  expect_near({"completion", "bsh"}, "bash");
  expect_near({"calibrate", "monday", "--accept", "defalt"}, "default");
  expect_near({"run", "demo", "--budget", "cii"}, "ci");
  EXPECT_THAT(rigproof_command({"run", "demo", "--budget", "cii"}).err, Not(HasSubstr("bench-v1"))) << "budgets alone";
}

/// Bash with the completion that the program prints, in a folder of its own.
class BashCompletion {
 public:
  BashCompletion() { std::filesystem::create_directories(folder()); }

  /// What is offered for a line of words, the last of which is being typed.
  std::string of(const std::string& words) const {
    const std::string call = "source " + script_ + "; COMP_WORDS=(" + words +
                             "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _rigproof; echo \"${COMPREPLY[*]}\"";
    const ProcessOutput output = run_process({"/bin/bash", "-c", call}, folder().string());
    EXPECT_EQ(output.err, "");
    return output.out;
  }
  void write(const std::string& name) const { scratch_.write("here/" + name, ""); }

 private:
  std::filesystem::path folder() const { return scratch_ / "here"; }

  TempFolder scratch_;
  std::string script_ = scratch_.write("completion.sh", rigproof_command({"completion", "bash"}).out).string();
};

TEST(CommandLine, BashCompletesCommandsOptionsAndChoices) {
  const BashCompletion completion;
  EXPECT_EQ(completion.of("rigproof cal"), "calibrate\n");
  EXPECT_EQ(completion.of("rigproof calibrate monday --gr"), "--ground\n");
  EXPECT_EQ(completion.of("rigproof calibrate --ground ''"), "depth images auto\n");
  EXPECT_EQ(completion.of("rigproof calibrate --junit ''"), "\n") << "names of files, by the shell";
  EXPECT_EQ(completion.of("rigproof sweep s"), "start slurm status summary\n");
  EXPECT_EQ(completion.of("rigproof sweep start --dry"), "--dry-run\n");
  EXPECT_EQ(completion.of("rigproof completion ''"), "bash zsh fish\n");
}

TEST(CommandLine, BashCompletesPresetsMethodsAndSchemas) {
  const TempFolder scratch;
  scratch.write("mine/models/boards/checkerboard_of_mine.yaml", "");
  ::setenv("RIGPROOF_PATH", (scratch / "mine").c_str(), 1);
  const BashCompletion completion;
  ::unsetenv("RIGPROOF_PATH");
  EXPECT_EQ(completion.of("rigproof init --sensor d4"), "d415 d435 d455\n");
  EXPECT_THAT(completion.of("rigproof board ch"),
              AllOf(HasSubstr("checkerboard_5x4_100mm"), HasSubstr("checkerboard_of_mine")));
  EXPECT_EQ(completion.of("rigproof generate dem"), "demo\n");
  EXPECT_EQ(completion.of("rigproof generate bud"), "\n") << "is no run";
  EXPECT_EQ(completion.of("rigproof sweep start sweeps/"), "sweeps/geometric\n");
  EXPECT_EQ(completion.of("rigproof calibrate --method ml"), "ml\n");
  EXPECT_EQ(completion.of("rigproof validate runs/demo --budget c"), "ci\n");
  EXPECT_EQ(completion.of("rigproof run --accept d"), "default\n");
  EXPECT_EQ(completion.of("rigproof schema ri"), "rig\n");
  EXPECT_EQ(completion.of("rigproof paper ''"), "table1 quantity odometry table3 why\n");
  EXPECT_EQ(completion.of("rigproof bench export stra"), "straight_line\n");
}

// As bash hands them over, where "=" parts words and where the user has told it not to.
TEST(CommandLine, BashCompletesValuesBehindAnEqualsSign) {
  const BashCompletion completion;
  EXPECT_EQ(completion.of("rigproof calibrate --ground ="), "depth images auto\n");
  EXPECT_EQ(completion.of("rigproof calibrate --ground = im"), "images\n");
  EXPECT_EQ(completion.of("rigproof calibrate --ground=im"), "--ground=images\n");
  EXPECT_EQ(completion.of("rigproof calibrate --junit = ''"), "\n") << "names of files, by the shell";
}

TEST(CommandLine, BashCompletesFilesBesidePresets) {
  const BashCompletion completion;
  completion.write("demo of mine.yaml");
  EXPECT_EQ(completion.of("rigproof generate dem"), "demo demo of mine.yaml\n");
}

TEST(CommandLine, EveryShellAndTheManualKnowEveryCommand) {
  const std::string manual = rigproof_command({"manual"}).out;
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const ProcessOutput script = rigproof_command({"completion", shell});
    EXPECT_EQ(script.exit_code, 0);
    for (const char* word : {"calibrate", "export", "summary", "images-per-stop"})
      EXPECT_THAT(script.out, HasSubstr(word)) << shell;
  }
  EXPECT_THAT(manual, AllOf(HasSubstr(".TH RIGPROOF 1"), HasSubstr(".SS \"rigproof sweep start\""),
                            HasSubstr("\\fB\\-\\-images\\-per\\-stop\\fR")));
  const ProcessOutput wrong = rigproof_command({"completion", "tcsh"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("bash"));
}

}  // namespace
}  // namespace rigproof
