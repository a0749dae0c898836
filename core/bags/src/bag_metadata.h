// Which files a bag is made of.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rigproof {

enum class BagContainer { kNone, kMcap, kSqlite, kRos1, kZstd };
/// By the first bytes.
BagContainer container_of(const std::filesystem::path& file);

struct BagFiles {
  std::vector<std::filesystem::path> files;  ///< in the order of recording
  std::vector<std::string> notes;
};
/// The files of a bag: the path itself, those that metadata.yaml in the folder names, or all in it. Throws Error.
BagFiles find_bag_files(const std::filesystem::path& path);

}  // namespace rigproof
