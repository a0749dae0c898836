// Processes of our own: forked, watched, and never left behind.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rigproof {

struct ProcessEnd {
  int signal = 0;  ///< that ended it; 0 = it ended by itself
  int exit_code = 0;

  bool is_good() const { return signal == 0 && exit_code == 0; }
  /// "ended with exit code 3", "was ended by signal 11 (Segmentation fault)".
  std::string in_words() const;
};

/// A process that is forked, with whatever it starts in turn: a process group of its own, so that Ctrl-C is for the
/// owner alone, and killed when its owner ends, in whatever way.
class ChildProcess {
 public:
  /// The child runs `work` and ends with what it returns, or with 70 at an exception; nothing that the owner does at
  /// its end is done in it. Where the owner has threads, `work` may only call what is safe between fork and exec.
  /// Throws Error with ExitCode::kTryAgain if the system has no process left.
  explicit ChildProcess(const std::function<int()>& work);
  /// Kills it if it still runs.
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;

  bool is_running() const { return pid_ >= 0; }
  pid_t pid() const { return pid_; }
  /// How it ended, once; nothing while it runs.
  std::optional<ProcessEnd> poll();
  /// How it ended, once.
  ProcessEnd wait();
  /// To the process alone.
  void send(int signal) const;
  /// To whatever it started and left, too.
  void kill_all() const;

 private:
  pid_t pid_ = -1;  ///< -1 once its end was told
  pid_t group_ = -1;
};

struct ProgramRun {
  std::vector<std::string> argv;  ///< argv[0] is looked up on PATH
  std::filesystem::path folder;   ///< in which it works
  std::filesystem::path out_file, error_file;
  double time_limit_s = 0.0;
  std::function<bool()> keep_going;  ///< asked every 20 ms; false kills the program, too
};

struct ProgramReport {
  std::string failure;  ///< why it did not end well, in words; empty if it exited with 0
  bool interrupted = false;
};

/// Runs a program with standard output and error in the two files and nothing on its standard input. All that it
/// started is killed with it, daemons too: at the limit, when it ends, and when the caller does. A file that it writes
/// may grow to 4 GB.
ProgramReport run_program(const ProgramRun& run);

}  // namespace rigproof
