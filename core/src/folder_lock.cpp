#include "rigproof/core/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <thread>

#include "rigproof/core/folders.h"

namespace rigproof {
namespace {

int open_folder(const std::filesystem::path& folder) {
  return ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder, const std::string& refusal, Kind kind,
                       std::chrono::milliseconds patience) {
  create_folder(folder);
  descriptor_ = open_folder(folder);
  if (descriptor_ < 0) throw_system_error(folder, "open", errno);
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (::flock(descriptor_, (kind == Kind::kAlone ? LOCK_EX : LOCK_SH) | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return;  // a file system without locks: go on without
    if (std::chrono::steady_clock::now() > deadline) {
      ::close(descriptor_);
      throw FolderInUse(folder.string() + ": " + refusal);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  holds_ = true;
}

FolderLock::~FolderLock() { ::close(descriptor_); }

bool FolderLock::is_held(const std::filesystem::path& folder) {
  const int descriptor = open_folder(folder);
  if (descriptor < 0) return false;
  const bool held = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return held;
}

}  // namespace rigproof
