#include "rigproof/study/workflow/folder_in_making.h"

#include <system_error>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"

namespace rigproof {

namespace fs = std::filesystem;

FolderInMaking::FolderInMaking(const fs::path& folder)
    : folder_(folder.has_filename() ? folder : folder.parent_path()), making_(folder_.string() + ".partial") {
  std::error_code error;
  const fs::file_status there = fs::symlink_status(folder_, error);  // a link would be replaced by the folder
  if (fs::exists(there) && !(fs::is_directory(there) && fs::is_empty(folder_, error)))
    throw Error(folder_.string() + ": there is something already; name a new folder");
  fs::remove_all(making_, error);
  if (error) throw_system_error(making_, "remove what an earlier try left", error.value());
  create_folder(making_);
}

FolderInMaking::~FolderInMaking() {
  std::error_code ignored;
  if (!done_) fs::remove_all(making_, ignored);
}

void FolderInMaking::finish() {
  std::vector<fs::path> all;
  for (const fs::directory_entry& entry : folder_tree(making_)) all.push_back(entry.path());
  sync_files(all);
  std::error_code error;
  fs::remove(folder_, error);
  fs::rename(making_, folder_, error);
  if (error) throw_system_error(folder_, "write", error.value());
  try {
    sync_files({folder_});
  } catch (const Error&) {
    fs::rename(folder_, making_, error);  // else the same command would find something there
    throw;
  }
  done_ = true;
}

}  // namespace rigproof
