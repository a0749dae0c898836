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

// What bash offers for a line of words, the last of which is being typed.
std::string completed(const std::string& script, const std::string& words, const std::string& folder = "") {
  const std::string call = "source " + script + "; COMP_WORDS=(" + words +
                           "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _rigproof; echo \"${COMPREPLY[*]}\"";
  const ProcessOutput output =
      run_process({"/bin/bash", "-c", call}, folder.empty() ? TempFolder().path().string() : folder);
  EXPECT_EQ(output.err, "");
  return output.out;
}

TEST(CommandLine, BashCompletesCommandsOptionsAndChoices) {
  const TempFolder scratch;
  const std::string script = scratch.write("completion.sh", rigproof_command({"completion", "bash"}).out).string();
  EXPECT_EQ(completed(script, "rigproof cal"), "calibrate\n");
  EXPECT_EQ(completed(script, "rigproof calibrate monday --gr"), "--ground\n");
  EXPECT_EQ(completed(script, "rigproof calibrate --ground ''"), "depth images auto\n");
  EXPECT_EQ(completed(script, "rigproof calibrate --junit ''"), "\n") << "names of files, by the shell";
  EXPECT_EQ(completed(script, "rigproof sweep s"), "start slurm status summary\n");
  EXPECT_EQ(completed(script, "rigproof sweep start --dry"), "--dry-run\n");
  EXPECT_EQ(completed(script, "rigproof completion ''"), "bash zsh fish\n");
}

TEST(CommandLine, BashCompletesPresetsMethodsAndSchemas) {
  const TempFolder scratch;
  scratch.write("mine/models/boards/checkerboard_of_mine.yaml", "");
  ::setenv("RIGPROOF_PATH", (scratch / "mine").c_str(), 1);
  const std::string script = scratch.write("completion.sh", rigproof_command({"completion", "bash"}).out).string();
  ::unsetenv("RIGPROOF_PATH");
  EXPECT_EQ(completed(script, "rigproof init --sensor d4"), "d415 d435 d455\n");
  EXPECT_THAT(completed(script, "rigproof board ch"),
              AllOf(HasSubstr("checkerboard_5x4_100mm"), HasSubstr("checkerboard_of_mine")));
  EXPECT_EQ(completed(script, "rigproof generate dem"), "demo\n");
  EXPECT_EQ(completed(script, "rigproof generate bud"), "\n") << "is no run";
  EXPECT_EQ(completed(script, "rigproof sweep start sweeps/"), "sweeps/geometric\n");
  EXPECT_EQ(completed(script, "rigproof calibrate --method ml"), "ml\n");
  EXPECT_EQ(completed(script, "rigproof validate runs/demo --budget c"), "ci\n");
  EXPECT_EQ(completed(script, "rigproof run --accept d"), "default\n");
  EXPECT_EQ(completed(script, "rigproof schema ri"), "rig\n");
  EXPECT_EQ(completed(script, "rigproof paper ''"), "table1 quantity odometry table3 why\n");
  EXPECT_EQ(completed(script, "rigproof bench export stra"), "straight_line\n");
}

// As bash hands them over, where "=" parts words and where the user has told it not to.
TEST(CommandLine, BashCompletesValuesBehindAnEqualsSign) {
  const TempFolder scratch;
  const std::string script = scratch.write("completion.sh", rigproof_command({"completion", "bash"}).out).string();
  EXPECT_EQ(completed(script, "rigproof calibrate --ground ="), "depth images auto\n");
  EXPECT_EQ(completed(script, "rigproof calibrate --ground = im"), "images\n");
  EXPECT_EQ(completed(script, "rigproof calibrate --ground=im"), "--ground=images\n");
  EXPECT_EQ(completed(script, "rigproof calibrate --junit = ''"), "\n") << "names of files, by the shell";
}

TEST(CommandLine, BashCompletesFilesBesidePresets) {
  const TempFolder scratch;
  const std::string script = scratch.write("completion.sh", rigproof_command({"completion", "bash"}).out).string();
  scratch.write("demo of mine.yaml", "");
  EXPECT_EQ(completed("completion.sh", "rigproof generate dem", scratch.path().string()), "demo demo of mine.yaml\n");
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
