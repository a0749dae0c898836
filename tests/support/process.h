// Runs a command as a user would and captures what it says.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rigproof/core/child_process.h"
#include "temp_folder.h"

namespace rigproof {

struct ProcessOutput {
  int exit_code = -1;  ///< 128 + signal if it was killed
  std::string out;
  std::string err;
};

/// A command that works beside the test. It ends with the test at the latest, and so does all that it started.
class BackgroundProcess {
 public:
  /// Starts argv[0] with the arguments in `folder` ("" = the present one).
  explicit BackgroundProcess(const std::vector<std::string>& argv, const std::string& folder = "");

  /// Returns once `ready` says so. Throws std::runtime_error with what the command said if it ends before that, or if a
  /// minute passes.
  void wait_until(const std::function<bool()>& ready);
  /// Returns once the command has a handler of its own for the signal. Throws as wait_until().
  void wait_until_it_handles(int signal);
  void send(int signal) const { child_.send(signal); }
  /// Waits for its end, once. Throws std::runtime_error after five minutes.
  ProcessOutput wait();

 private:
  std::string said() const;

  TempFolder scratch_;
  ChildProcess child_;
};

/// Runs a command and waits for it.
ProcessOutput run_process(const std::vector<std::string>& argv, const std::string& folder = "");

}  // namespace rigproof
