// Runs a command as a user would and captures what it says.
#pragma once

#include <string>
#include <vector>

namespace rigproof {

struct ProcessOutput {
  int exit_code = -1;  ///< 128 + signal if it was killed
  std::string out;
  std::string err;
};

/// Runs argv[0] with the arguments in `folder` ("" = the present one) and waits for it.
ProcessOutput run_process(const std::vector<std::string>& argv, const std::string& folder = "");

}  // namespace rigproof
