// A folder under the system's temporary one, gone with its owner.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>

#include "rigproof/core/error.h"

namespace rigproof {

class ScratchFolder {
 public:
  explicit ScratchFolder(const std::string& purpose) {
    std::string name = (std::filesystem::temp_directory_path() / ("rigproof-" + purpose + "-XXXXXX")).string();
    if (::mkdtemp(name.data()) == nullptr) throw Error(name + ": a temporary folder cannot be made");
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace rigproof
