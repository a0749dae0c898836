// One file of a bag: what its container has to do.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rigproof/bags/bag.h"

namespace rigproof {

/// No message, chunk or row of a bag is larger [bytes]: a picture of 16 k x 16 k pixels fits.
inline constexpr std::uint64_t kMaxPiece = 256U << 20U;

/// What a container tells while it is read.
struct BagSink {
  /// Index of a topic in the bag.
  std::function<std::size_t(const BagTopic&)> topic;
  std::function<bool(std::size_t topic)> wants;
  Bag::Take take;
  /// Bytes of this file that are read.
  std::function<void(std::uint64_t)> progress;
  std::function<void(const std::string&)> note;
  /// Bytes that came out of a decoder, or straight from the file.
  std::function<void(std::uint64_t)> unpacked;
};

class BagFile {
 public:
  virtual ~BagFile() = default;
  virtual std::uint64_t size_bytes() const = 0;
  /// What has not been read before: of a file that grows, what has come since.
  /// @param index of this file in the bag, for places
  virtual void read(std::uint32_t index, const BagSink& sink) = 0;
  /// @param places of this file, ascending
  virtual void read_at(const std::vector<BagPlace>& places, const BagSink& sink) = 0;
  /// Takes note of what has come since. False if what was read is no more what the file begins with.
  virtual bool goes_on() = 0;
};

std::unique_ptr<BagFile> open_mcap_file(const std::filesystem::path& file);
std::unique_ptr<BagFile> open_sqlite_file(const std::filesystem::path& file);

}  // namespace rigproof
