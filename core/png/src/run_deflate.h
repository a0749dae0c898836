// Deflate (RFC 1951) with one kind of repetition: bytes that repeat with the period of a pixel, as flat areas do after
// filtering. Everything else is coded byte by byte. What a search would find beside these in a rendered or a noisy
// image is little, and not searching is several times faster.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rigproof {

struct HuffmanCode {
  std::uint16_t bits = 0;  ///< in the order in which they are sent, lowest first
  std::uint16_t length = 0;
};

/// Appends blocks to a stream of bits. The caller provides the zlib wrapper.
class RunDeflate {
 public:
  /// @param period bytes a pixel, 1 to 4: a run repeats the bytes of one pixel
  void begin(int period);
  /// Bytes that append() may write at most for a piece.
  static std::size_t bound(std::size_t bytes) { return 2 * bytes + 256; }
  /// Codes a piece as one block with its own Huffman code; returns the end of what was written. The last piece of a
  /// stream is padded to a whole byte.
  std::uint8_t* append(const std::uint8_t* piece, std::size_t bytes, bool last, std::uint8_t* out);

 private:
  // So many bytes coded one by one, then so many that repeat.
  struct Segment {
    std::uint32_t literals = 0, run = 0;
  };

  void put(std::uint32_t value, int count) {
    bits_ |= std::uint64_t{value} << bit_count_;
    bit_count_ += count;
  }
  void find_segments(const std::uint8_t* piece, std::size_t bytes);
  std::vector<std::uint32_t> count_symbols(const std::uint8_t* piece) const;
  std::uint8_t* append_header(const std::vector<int>& lengths, bool last, std::uint8_t* out);
  std::uint8_t* append_segments(const std::uint8_t* piece, const std::vector<HuffmanCode>& codes, std::uint8_t* out);
  std::uint8_t* flush(std::uint8_t* out);

  std::size_t period_ = 1;
  std::vector<Segment> segments_;
  std::vector<std::uint32_t> pairs_;  ///< codes of two bytes at a time
  std::uint64_t bits_ = 0;            ///< not yet written, lowest first
  int bit_count_ = 0;
};

/// Lengths of a Huffman code for symbols of the given frequencies, none longer than max_length; 0 for those that never
/// occur. At least two symbols must occur.
std::vector<int> huffman_lengths(std::vector<std::uint32_t> frequencies, int max_length);

}  // namespace rigproof
