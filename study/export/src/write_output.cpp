#include <system_error>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
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

}  // namespace

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
