#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/study/export/export.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// A rename would replace a file in spite of its own permissions.
void refuse_read_only(const fs::path& file, fs::perms permissions) {
  const fs::perms any_write = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
  if ((permissions & any_write) == fs::perms::none)
    throw Error(file.string() +
                ": cannot write: the file is read-only; allow writing (chmod u+w), or name another file");
}

// The folder that is there already and that what is missing would be made in.
fs::path nearest_folder(const fs::path& file) {
  fs::path folder = fs::absolute(file).parent_path();
  std::error_code ignored;
  while (folder.has_relative_path() && !fs::exists(folder, ignored)) folder = folder.parent_path();
  return folder;
}

}  // namespace

void check_can_be_written(const fs::path& file) {
  if (takes_bytes_itself(file)) return;
  std::error_code ignored;
  const fs::file_status there = fs::symlink_status(file, ignored);
  if (fs::is_directory(there)) throw Error(file.string() + ": cannot write: there is a folder of this name");
  if (fs::is_regular_file(there)) refuse_read_only(file, there.permissions());
  const fs::path folder = nearest_folder(file);
  if (!fs::is_directory(folder, ignored))
    throw Error(file.string() + ": cannot write: " + folder.string() + " is no folder");
  if (::access(folder.c_str(), W_OK) != 0) throw_system_error(file, "write", errno);
}

WrittenFile write_with_backup(const fs::path& file, const std::string& text) {
  std::error_code error;
  const fs::file_status there = fs::symlink_status(file, error);
  if (!fs::is_regular_file(there)) {
    write_file_atomically(file, text);
    return {file, std::nullopt, true};
  }
  const std::string before = read_text_file(file);
  if (before == text) return {file, std::nullopt, false};
  refuse_read_only(file, there.permissions());
  const fs::path backup = file.string() + ".bak";
  write_file_atomically(backup, before);
  fs::permissions(backup, there.permissions(), error);
  write_file_atomically(file, text);
  fs::permissions(file, there.permissions(), error);
  return {file, backup, true};
}

}  // namespace rigproof
