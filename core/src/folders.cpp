#include "rigproof/core/folders.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

template <typename Iterator>
std::vector<fs::directory_entry> all_of(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::directory_entry> entries;
  Iterator it(folder, error);
  if (error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory) return entries;
  for (; !error && it != Iterator(); it.increment(error)) entries.push_back(*it);
  if (error) throw_system_error(folder, "read the folder", error.value());
  std::sort(entries.begin(), entries.end());
  return entries;
}

}  // namespace

void throw_system_error(const fs::path& file, const std::string& action, int error_number) {
  std::string cause = std::generic_category().message(error_number);
  if (error_number == ENOSPC || error_number == EDQUOT) cause = "the disk is full";
  if (error_number == EFBIG) cause = "the file would exceed the largest size allowed here";
  if (error_number == EACCES || error_number == EPERM) cause = "no permission";
  if (error_number == EROFS) cause = "the file system is read-only";
  // Whoever runs the batch may make room, or bring a share back; other programs may end.
  const std::array<int, 10> may_pass = {ENOSPC, EDQUOT, ESTALE,   EMFILE,    ENFILE,
                                        ENOMEM, EAGAIN, ENOTCONN, EHOSTDOWN, ETIMEDOUT};
  const bool passes = std::find(may_pass.begin(), may_pass.end(), error_number) != may_pass.end();
  throw Error(file.string() + ": cannot " + action + ": " + cause, passes ? ExitCode::kTryAgain : ExitCode::kBadInput);
}

void create_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw_system_error(folder, "create the folder", error.value());
}

void remove_tree(const fs::path& folder) {
  std::error_code error;
  fs::remove_all(folder, error);
  if (error) throw_system_error(folder, "remove", error.value());
}

std::vector<fs::directory_entry> folder_entries(const fs::path& folder) {
  return all_of<fs::directory_iterator>(folder);
}

std::vector<fs::directory_entry> folder_tree(const fs::path& folder) {
  return all_of<fs::recursive_directory_iterator>(folder);
}

}  // namespace rigproof
