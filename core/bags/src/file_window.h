// A file read front to back through a window, or at any place, without a copy of the whole in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "unpack.h"

namespace rigproof {

class FileWindow {
 public:
  /// Throws Error.
  explicit FileWindow(const std::filesystem::path& file);
  ~FileWindow();
  FileWindow(const FileWindow&) = delete;
  FileWindow& operator=(const FileWindow&) = delete;

  std::uint64_t size() const { return size_; }
  /// Takes note that the file has grown. False if another file has its name now, or it is shorter.
  bool has_grown_or_stayed();
  /// Bytes of the file, which has them; valid until the next call. Throws Error if they cannot be read.
  std::string_view at(std::uint64_t position, std::size_t length);

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  RawBuffer buffer_;
  std::uint64_t begin_ = 0;
  std::size_t filled_ = 0;
};

}  // namespace rigproof
