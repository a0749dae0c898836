// A folder that appears whole or not at all.
#pragma once

#include <filesystem>

namespace rigproof {

/// A folder that gets its name when it is whole, and is gone again if that never happens. What an earlier attempt left
/// is thrown away.
class FolderInMaking {
 public:
  /// Throws Error if there is something in its place but an empty folder.
  explicit FolderInMaking(const std::filesystem::path& folder);
  ~FolderInMaking();
  FolderInMaking(const FolderInMaking&) = delete;
  FolderInMaking& operator=(const FolderInMaking&) = delete;

  /// Where to write.
  const std::filesystem::path& path() const { return making_; }
  /// Everything in it lasts on the disk, then it gets its name, which lasts, too. Throws Error.
  void finish();

 private:
  std::filesystem::path folder_, making_;
  bool done_ = false;
};

}  // namespace rigproof
