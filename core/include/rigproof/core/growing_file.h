// A file of any size that appears whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace rigproof {

/// Grows under a temporary name beside the file that it becomes, as files.h has it. What is not finished leaves
/// nothing.
class GrowingFile {
 public:
  /// Creates missing folders. Only a regular file is replaced. Throws Error that names the file and the cause, as do
  /// append() and finish().
  explicit GrowingFile(std::filesystem::path file);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  void append(std::string_view bytes);
  /// Makes it last and gives it its name.
  void finish();

 private:
  void write_out();

  std::filesystem::path file_, temporary_;
  int descriptor_ = -1;
  std::string unwritten_;
};

}  // namespace rigproof
