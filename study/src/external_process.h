// Runs a program under a time limit, its output in files.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rigproof {

struct ProcessReport {
  std::string failure;  ///< why it did not end well, in words; empty if it exited with 0
  bool interrupted = false;
};

/// Runs argv[0], looked up on PATH, in `folder`, with standard output and error in the two files and nothing on its
/// standard input. At the limit the program and all that it started are killed. A file that it writes may grow to 4 GB.
/// @param keep_going asked every 20 ms; false kills the program, too
ProcessReport run_limited(const std::vector<std::string>& argv, const std::filesystem::path& folder,
                          const std::filesystem::path& out_file, const std::filesystem::path& error_file,
                          double time_limit_s, const std::function<bool()>& keep_going);

}  // namespace rigproof
