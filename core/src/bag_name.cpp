#include "rigproof/core/bag_name.h"

#include <algorithm>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

bool has_bag_name(const fs::path& file) {
  const fs::path plain = file.extension() == ".zstd" ? file.stem() : file.filename();
  return plain.extension() == ".mcap" || plain.extension() == ".db3" || plain.extension() == ".bag";
}

}  // namespace

bool is_named_as_bag(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) return has_bag_name(path);
  if (!fs::is_directory(path, ignored)) return false;
  const std::vector<fs::directory_entry> entries = folder_entries(path);
  return std::any_of(entries.begin(), entries.end(),
                     [](const fs::directory_entry& entry) { return has_bag_name(entry.path()); });
}

void refuse_bag(const fs::path& path) {
  if (!is_named_as_bag(path)) return;
  throw Error(path.string() + ": is a bag of ROS; `rigproof init " + shell_word(path.string()) +
              " -o monday` makes a recording of it, in the folder monday");
}

}  // namespace rigproof
