// A folder under the system's temporary one, gone with its owner.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "rigproof/core/folder_lock.h"

namespace rigproof {

/// Locked while its owner lives. Those of the same purpose and user whose owner was killed are removed first.
class ScratchFolder {
 public:
  /// @param purpose a word
  /// Throws Error if the folder cannot be made.
  explicit ScratchFolder(const std::string& purpose);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::optional<FolderLock> lock_;
};

}  // namespace rigproof
