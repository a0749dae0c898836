// A lock on a folder that ends with the process, however that ends.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "rigproof/core/error.h"

namespace rigproof {

/// Another process holds the folder; with ExitCode::kTryAgain.
class FolderInUse : public Error {
 public:
  explicit FolderInUse(const std::string& message) : Error(message, ExitCode::kTryAgain) {}
};

/// Holds a folder for one process; processes that are forked from it hold it, too, until they end.
class FolderLock {
 public:
  enum class Kind {
    kAlone,  ///< nobody else may hold it
    kShared  ///< others may hold it shared, too
  };

  /// Creates the folder where it is missing. Waits for a moment for processes of a killed program to end. On a file
  /// system without locks there is none.
  /// @param refusal what is said, after the folder's name, if another process holds it: "another rigproof ..."
  /// Throws FolderInUse then, and Error if the folder cannot be made.
  FolderLock(const std::filesystem::path& folder, const std::string& refusal, Kind kind = Kind::kAlone,
             std::chrono::milliseconds patience = std::chrono::seconds(5));
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// False on a file system without locks.
  bool holds() const { return holds_; }
  /// Whether some process holds the folder alone.
  static bool is_held(const std::filesystem::path& folder);

 private:
  int descriptor_ = -1;
  bool holds_ = false;
};

}  // namespace rigproof
