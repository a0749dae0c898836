#include "rigproof/core/child_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <stdexcept>

#include "temp_folder.h"

namespace rigproof {
namespace {

TEST(ChildProcess, TellsHowItEnded) {
  EXPECT_EQ(ChildProcess([] { return 3; }).wait().in_words(), "ended with exit code 3");
  EXPECT_TRUE(ChildProcess([] { return 0; }).wait().is_good());
  EXPECT_EQ(ChildProcess([]() -> int { throw std::runtime_error("uncaught"); }).wait().exit_code, 70);
  const ProcessEnd killed = ChildProcess([] { return raise(SIGKILL); }).wait();
  EXPECT_EQ(killed.signal, SIGKILL);
  EXPECT_FALSE(killed.is_good());
  EXPECT_NE(killed.in_words().find("was ended by signal 9"), std::string::npos);
}

TEST(ChildProcess, TakesWhatItStartedWithIt) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  {
    ChildProcess child([&] {
      if (fork() == 0 && write(ends[1], "x", 1) == 1) pause();  // the grandchild holds the pipe open
      close(ends[1]);
      return pause();
    });
    close(ends[1]);
    char started = 0;
    ASSERT_EQ(read(ends[0], &started, 1), 1);
    EXPECT_FALSE(child.poll());
    child.kill_all();
    EXPECT_EQ(child.wait().signal, SIGKILL);
    EXPECT_FALSE(child.is_running());
  }
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 0);  // nobody is left to write
  close(ends[0]);
}

TEST(ChildProcess, ProgramRunsInItsFolderWithItsOutputInFiles) {
  const TempFolder folder;
  const ProgramRun run{
      {"sh", "-c", "pwd; echo wrong >&2; exit 4"}, folder.path(), folder / "out", folder / "err", 60.0, {}};
  EXPECT_EQ(run_program(run).failure, "ended with exit code 4");
  EXPECT_EQ(folder.read("out"), std::filesystem::canonical(folder.path()).string() + "\n");
  EXPECT_EQ(folder.read("err"), "wrong\n");
}

TEST(ChildProcess, ProgramIsStoppedAtItsLimitAndByItsOwner) {
  const TempFolder folder;
  ProgramRun run{{"sleep", "60"}, folder.path(), folder / "out", folder / "err", 0.05, {}};
  EXPECT_EQ(run_program(run).failure, "ran longer than its limit of 0.05 s");
  run.time_limit_s = 60.0;
  run.keep_going = [] { return false; };
  EXPECT_TRUE(run_program(run).interrupted);
  run.argv = {"/nowhere/to/be/found"};
  EXPECT_EQ(run_program(run).failure, "cannot be started: /nowhere/to/be/found: No such file or directory");
}

// Nobody tells the program that its owner was killed.
TEST(ChildProcess, AnOwnerThatIsKilledTakesTheProgramsDaemonsWithIt) {
  const TempFolder folder;
  const std::string pipe = folder / "held";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  pollfd alive{open(pipe.c_str(), O_RDONLY | O_NONBLOCK), POLLIN, 0};
  ASSERT_GE(alive.fd, 0);
  ChildProcess owner([&] {
    run_program({{"sh", "-c", "(setsid sh -c 'echo up > held; sleep 60 > held' &); sleep 60"},
                 folder.path(),
                 folder / "out",
                 folder / "err",
                 60.0,
                 {}});
    return 0;
  });
  ASSERT_EQ(poll(&alive, 1, 10000), 1);
  owner.send(SIGKILL);
  owner.wait();
  std::array<char, 8> said{};
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (read(alive.fd, said.data(), said.size()) != 0 && std::chrono::steady_clock::now() < end) usleep(1000);
  EXPECT_EQ(read(alive.fd, said.data(), said.size()), 0) << "the daemon still holds the pipe";
  close(alive.fd);
}

}  // namespace
}  // namespace rigproof
