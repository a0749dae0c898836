// A bag of ROS 2 as one MCAP file, as rosbag2 writes it: packed chunks with an index and checksums, every topic with
// the definition of its messages.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace rigproof {

enum class BagPacking { kNone, kLz4, kZstd };

class BagWriter {
 public:
  /// Throws Error if there is something already, or nothing can be written.
  BagWriter(const std::filesystem::path& file, BagPacking packing);
  /// Without finish() nothing remains.
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  /// @param type one of messages.h
  /// @param message with its encapsulation, as message_bytes() makes it
  void write(const std::string& topic, const std::string& type, std::int64_t log_time_ns, std::string_view message);
  /// Completes the file and gives it its name. Throws Error.
  void finish();

 private:
  class File;
  std::unique_ptr<File> file_;
};

}  // namespace rigproof
