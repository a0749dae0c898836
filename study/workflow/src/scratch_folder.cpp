#include "rigproof/study/workflow/scratch_folder.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// Tells such a folder from one whose name only looks like it.
const char* const kMark = ".rigproof_scratch";
constexpr const char* kRefusal = "is in use";

fs::path temporary_folder() {
  std::error_code error;
  const fs::path folder = fs::temp_directory_path(error);
  if (!error) return folder;
  const char* given = std::getenv("TMPDIR");
  throw_system_error(given != nullptr ? given : "/tmp", "use it as the folder of temporary files (TMPDIR)",
                     error.value());
}

bool is_own_scratch(const fs::path& folder) {
  struct stat status {};
  std::error_code ignored;
  return ::lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == ::geteuid() &&
         fs::is_regular_file(fs::symlink_status(folder / kMark, ignored));
}

std::vector<fs::path> own_scratch_folders(const std::string& prefix) {
  std::vector<fs::path> folders;
  std::error_code error;
  for (fs::directory_iterator it(temporary_folder(), error), end; !error && it != end; it.increment(error))
    if (it->path().filename().string().rfind(prefix, 0) == 0 && is_own_scratch(it->path()))
      folders.push_back(it->path());
  return folders;
}

// The mark last, so that what cannot be removed now is found by the next owner.
void remove_scratch(const fs::path& folder) {
  for (int attempt = 0; attempt < 2; ++attempt) {
    std::error_code error;
    std::vector<fs::path> held;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
      if (it->path().filename() != kMark) held.push_back(it->path());
    for (const fs::path& path : held)
      if (!error) fs::remove_all(path, error);
    if (!error) fs::remove_all(folder, error);
    if (!error) return;
  }
}

void remove_forsaken(const std::string& prefix) {
  for (const fs::path& folder : own_scratch_folders(prefix)) {
    try {
      const FolderLock lock(folder, kRefusal, FolderLock::Kind::kAlone, std::chrono::milliseconds(0));
      if (lock.holds()) remove_scratch(folder);
    } catch (const Error&) {
      // Its owner lives, or another program is removing it.
    }
  }
}

}  // namespace

ScratchFolder::ScratchFolder(const std::string& purpose) {
  const std::string prefix = "rigproof-" + purpose + "-";
  remove_forsaken(prefix);
  std::string name = (temporary_folder() / (prefix + "XXXXXX")).string();
  if (::mkdtemp(name.data()) == nullptr) throw_system_error(name, "make a temporary folder", errno);
  path_ = name;
  try {
    lock_.emplace(path_, kRefusal);
    write_file_atomically_unsynced(path_ / kMark, "");  // last: one without it is left alone
  } catch (...) {
    remove_scratch(path_);
    throw;
  }
}

ScratchFolder::~ScratchFolder() { remove_scratch(path_); }

}  // namespace rigproof
