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

/// A folder of its own under the system's temporary one, removed with everything in it at the end.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

}  // namespace rigproof
