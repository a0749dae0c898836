// What lies in a folder.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "rigproof/core/files.h"

namespace rigproof {

/// Hash of every file below a folder, temporary ones included, by path relative to it.
inline std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> hashes;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    hashes[std::filesystem::relative(entry.path(), folder).generic_string()] = sha256_hex_of_file(entry.path());
  }
  return hashes;
}

}  // namespace rigproof
