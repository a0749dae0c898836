// ROS 2 bags (rosbag2) as streams of messages: MCAP and SQLite, one file or many, compressed or not. Memory stays flat:
// one chunk of MCAP (or one row of SQLite) is held at a time. What is read may be hostile: every length is bounded.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace rigproof {

/// A topic of a bag. Two types on one name are two topics.
struct BagTopic {
  std::string name;      ///< "/left/image_raw"
  std::string type;      ///< "sensor_msgs/msg/Image"
  std::string encoding;  ///< of its messages: "cdr"
};

/// Where a message lies, so that it can be read again without what lies before it.
struct BagPlace {
  std::uint32_t file = 0;    ///< index of the bag's file
  std::uint64_t chunk = 0;   ///< MCAP: byte of the chunk's record (or of the message's own); SQLite: row
  std::uint64_t offset = 0;  ///< MCAP: byte in the unpacked chunk
};
bool operator<(const BagPlace& a, const BagPlace& b);

struct BagMessage {
  std::size_t topic = 0;         ///< index into Bag::topics()
  std::int64_t log_time_ns = 0;  ///< when it was recorded
  BagPlace place;
  std::string_view data;  ///< unpacked; valid during the call
};

/// True if the file or folder looks like a bag, of ROS 1 or 2, whole or not.
bool is_bag(const std::filesystem::path& path);

class BagFile;

/// A bag that is read once through, again where one wants, and further as it grows.
class Bag {
 public:
  /// @param path one file (.mcap, .db3, either also as .zstd), or the folder of a bag: the files that its metadata.yaml
  /// names, or all that it holds where there is none
  /// @param scratch folder for what has to be unpacked before it can be read (.zstd); made when it is needed
  /// Throws Error: no bag, a bag of ROS 1, files that are missing.
  Bag(const std::filesystem::path& path, const std::filesystem::path& scratch);
  ~Bag();
  Bag(const Bag&) = delete;
  Bag& operator=(const Bag&) = delete;

  /// Those met so far, all of them once read() is through.
  const std::vector<BagTopic>& topics() const { return topics_; }
  /// What a user has to know of how it was read: that it was not finished, or has more files than were named.
  const std::vector<std::string>& notes() const { return notes_; }
  /// Of all its files.
  std::uint64_t size_bytes() const;
  /// Unpacked, of what read() has gone through.
  std::uint64_t unpacked_bytes() const { return unpacked_bytes_; }

  /// Called with (bytes read, bytes in all) while reading; returns false to interrupt, which throws Error (kTryAgain).
  std::function<bool(std::uint64_t, std::uint64_t)> progress;

  using Take = std::function<void(const BagMessage&)>;
  /// All messages of the topics that are wanted, in the order in which they were written. A bag that was never finished
  /// is read as far as it goes (see notes). Throws Error for damage, with file and byte and what to do.
  /// Called again, after goes_on(): what has come since.
  void read(const std::function<bool(const BagTopic&)>& wants, const Take& take);
  /// Takes note of what has come since, in its files and in further ones. False where that cannot be read on its own:
  /// files were replaced, or are compressed as a whole; then the bag is to be opened anew. Throws Error.
  bool goes_on();
  /// The messages at some places, in the order of the bag, each place once. Only after read().
  void read_at(std::vector<BagPlace> places, const Take& take);

 private:
  friend class BagFile;
  std::size_t topic_index(const BagTopic& topic);
  void deliver(BagMessage message, const Take& take);
  void note_progress(std::uint64_t bytes_of_file);
  void open_further(const std::vector<std::filesystem::path>& files);

  std::filesystem::path path_, scratch_;
  std::vector<std::filesystem::path> names_;  // of the files
  std::vector<std::unique_ptr<BagFile>> files_;
  std::vector<BagTopic> topics_;
  std::vector<std::string> notes_;
  std::string unpacked_;  // of a message that is compressed by itself
  std::uint64_t unpacked_bytes_ = 0;
  std::uint64_t bytes_before_ = 0;  // of the files that are read through
};

}  // namespace rigproof
