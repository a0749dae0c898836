// What the command line says of itself: help, mistakes, completion, the manual.
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

// What bash offers for a line of words, the last of which is being typed.
std::string completed(const std::string& script, const std::string& words) {
  const std::string call = "source " + script + "; COMP_WORDS=(" + words +
                           "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _rigproof; echo \"${COMPREPLY[*]}\"";
  const ProcessOutput output = run_process({"/bin/bash", "-c", call});
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
