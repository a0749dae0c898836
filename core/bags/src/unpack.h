// Decompression that does not trust what it is given.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace rigproof {

/// Bytes that are not set to zero before they are written. Grows, never shrinks.
class RawBuffer {
 public:
  char* reserve(std::size_t size);
  char* data() { return bytes_.get(); }

 private:
  std::unique_ptr<char[]> bytes_;  // NOLINT(modernize-avoid-c-arrays): a vector would be zeroed
  std::size_t capacity_ = 0;
};

/// Unpacks whole frames into exactly `size` bytes. Returns what is wrong, or nothing.
class Unpacker {
 public:
  Unpacker();
  ~Unpacker();
  Unpacker(const Unpacker&) = delete;
  Unpacker& operator=(const Unpacker&) = delete;

  std::string unpack_zstd(std::string_view packed, char* to, std::size_t size);
  std::string unpack_lz4(std::string_view packed, char* to, std::size_t size);

 private:
  struct Contexts;
  std::unique_ptr<Contexts> contexts_;
};

bool is_zstd(std::string_view bytes);
/// One message or row, of at most kMaxPiece unpacked. Throws Error without a file name.
std::string unpack_zstd_message(std::string_view packed);
/// A whole file as a stream. Throws Error.
void unpack_zstd_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// CRC-32 as zlib computes it.
std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before = 0);

}  // namespace rigproof
