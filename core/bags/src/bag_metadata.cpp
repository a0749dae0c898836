#include "bag_metadata.h"

#include <algorithm>
#include <fstream>
#include <set>

#include "rigproof/bags/bag.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/text.h"
#include "rigproof/core/yaml.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetadata = "metadata.yaml";
constexpr const char* kRoot = "rosbag2_bagfile_information";

bool has_bag_name(const fs::path& file) {
  const std::set<std::string> known = {".mcap", ".db3", ".bag"};
  return known.count((file.extension() == ".zstd" ? file.stem() : file).extension().string()) > 0;
}

// "bag_2.mcap" before "bag_10.mcap".
bool numbered_before(const fs::path& a, const fs::path& b) {
  const std::string one = a.filename().string(), other = b.filename().string();
  return one.size() != other.size() ? one.size() < other.size() : one < other;
}

std::vector<fs::path> bag_files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const fs::directory_entry& entry : folder_entries(folder))
    if (has_bag_name(entry.path()) && entry.is_regular_file(ignored)) files.push_back(entry.path());
  std::sort(files.begin(), files.end(), numbered_before);
  return files;
}

bool has_metadata(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / kMetadata, ignored);
}

// Where a name of metadata.yaml lies: early versions wrote the folder's name before it.
fs::path place_of(const fs::path& folder, const std::string& name) {
  std::error_code ignored;
  const fs::path there = path_inside(folder, name);
  if (fs::exists(there, ignored)) return there;
  const fs::path by_name = folder / fs::path(name).filename();
  return fs::exists(by_name, ignored) ? by_name : there;
}

BagFiles files_of_metadata(const fs::path& folder) {
  const YamlTree tree = read_yaml_file(folder / kMetadata);
  const YamlTree* root = tree.find(kRoot);
  const YamlTree* names = root == nullptr ? nullptr : root->find("relative_file_paths");
  if (names == nullptr || !names->is_sequence() || names->items.empty())
    throw Error((folder / kMetadata).string() + ": " + kRoot +
                ".relative_file_paths: must be a list of the bag's files; `ros2 bag reindex " +
                folder.filename().string() + "` writes it anew");
  BagFiles bag;
  Problems problems;
  for (const YamlTree& name : names->items) {
    std::error_code ignored;
    const fs::path file = place_of(folder, name.scalar);
    bag.files.push_back(file);
    if (!fs::is_regular_file(file, ignored))
      problems.add({name.file, name.line, "relative_file_paths", for_message(name.scalar),
                    "there is no such file in the folder; copy it there, or take its line out to read the others"});
  }
  problems.throw_if_any();
  return bag;
}

BagFiles files_of_folder(const fs::path& folder) {
  if (has_metadata(folder)) return files_of_metadata(folder);
  BagFiles bag;
  bag.files = bag_files_in(folder);
  if (bag.files.empty())
    throw Error(folder.string() + ": holds no bag: neither metadata.yaml nor .mcap nor .db3 files");
  bag.notes.push_back("there is no metadata.yaml: all " + std::to_string(bag.files.size()) +
                      " files of the folder are read");
  return bag;
}

}  // namespace

BagContainer container_of(const fs::path& file) {
  char bytes[16] = {};
  std::ifstream(file, std::ios::binary).read(bytes, sizeof bytes);
  const std::string_view head(bytes, sizeof bytes);
  if (head.substr(0, 8) == std::string_view("\x89MCAP0\r\n", 8)) return BagContainer::kMcap;
  if (head == std::string_view("SQLite format 3\0", 16)) return BagContainer::kSqlite;
  if (head.substr(0, 8) == "#ROSBAG ") return BagContainer::kRos1;
  if (head.substr(0, 4) == "\x28\xB5\x2F\xFD") return BagContainer::kZstd;
  return BagContainer::kNone;
}

bool is_bag(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) return has_bag_name(path) || container_of(path) != BagContainer::kNone;
  if (!fs::is_directory(path, ignored)) return false;
  try {
    if (has_metadata(path)) return read_yaml_file(path / kMetadata).find(kRoot) != nullptr;
    return !bag_files_in(path).empty();
  } catch (const Error&) {
    return true;  // reading it says why
  }
}

BagFiles find_bag_files(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return files_of_folder(path);
  if (!fs::is_regular_file(path, ignored)) throw Error(path.string() + ": no such file or folder");
  BagFiles bag;
  bag.files.push_back(path);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (has_metadata(folder) && bag_files_in(folder).size() > 1)
    bag.notes.push_back(path.filename().string() + " is one of " + std::to_string(bag_files_in(folder).size()) +
                        " files of its folder; give the folder to read them all");
  return bag;
}

}  // namespace rigproof
