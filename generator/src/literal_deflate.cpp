#include "literal_deflate.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <queue>
#include <utility>

namespace rigproof {
namespace {

constexpr int kLiterals = 256, kEndOfBlock = 256, kSymbols = 257;
// Deflate allows 15; with 14 four codes fit into a word beside what is left over.
constexpr int kMaxLength = 14;

std::vector<std::uint32_t> count_bytes(const std::uint8_t* bytes, std::size_t count) {
  // Four counters, because equal neighbours would wait for each other.
  std::array<std::array<std::uint32_t, kLiterals>, 4> counts{};
  for (std::size_t i = 0; i < count; ++i) ++counts[i & 3U][bytes[i]];
  std::vector<std::uint32_t> sums(kSymbols);
  for (std::size_t i = 0; i < kLiterals; ++i) sums[i] = counts[0][i] + counts[1][i] + counts[2][i] + counts[3][i];
  sums[kEndOfBlock] = 1;
  return sums;
}

// Depths of the leaves of a Huffman tree.
std::vector<int> tree_depths(const std::vector<std::uint32_t>& frequencies) {
  using Node = std::pair<std::uint64_t, std::size_t>;  // weight, number
  std::priority_queue<Node, std::vector<Node>, std::greater<>> queue;
  const std::size_t leaves = frequencies.size();
  std::vector<std::size_t> parent(2 * leaves);
  for (std::size_t i = 0; i < leaves; ++i) {
    if (frequencies[i] > 0) queue.push({frequencies[i], i});
  }
  std::size_t next = leaves;
  while (queue.size() > 1) {
    const Node a = queue.top();
    queue.pop();
    const Node b = queue.top();
    queue.pop();
    parent[a.second] = parent[b.second] = next;
    queue.push({a.first + b.first, next++});
  }
  std::vector<int> depth(next);
  for (std::size_t i = next - 1; i-- > 0;) {  // the root is the last node, parents have larger numbers
    if (i >= leaves || frequencies[i] > 0) depth[i] = depth[parent[i]] + 1;
  }
  depth.resize(leaves);
  return depth;
}

std::uint16_t reversed(std::uint32_t code, int length) {
  std::uint32_t result = 0;
  for (int i = 0; i < length; ++i) result |= ((code >> i) & 1U) << (length - 1 - i);
  return static_cast<std::uint16_t>(result);
}

// The canonical code of RFC 1951, section 3.2.2.
std::vector<HuffmanCode> canonical_codes(const std::vector<int>& lengths) {
  std::array<std::uint32_t, kMaxLength + 2> count{}, next{};
  for (const int length : lengths) ++count[static_cast<std::size_t>(length)];
  count[0] = 0;
  for (std::size_t length = 1; length <= kMaxLength; ++length)
    next[length] = (next[length - 1] + count[length - 1]) << 1U;
  std::vector<HuffmanCode> codes(lengths.size());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (lengths[i] == 0) continue;
    codes[i] = {reversed(next[static_cast<std::size_t>(lengths[i])]++, lengths[i]),
                static_cast<std::uint16_t>(lengths[i])};
  }
  return codes;
}

}  // namespace

std::vector<int> huffman_lengths(std::vector<std::uint32_t> frequencies, int max_length) {
  for (;;) {
    std::vector<int> lengths = tree_depths(frequencies);
    if (*std::max_element(lengths.begin(), lengths.end()) <= max_length) return lengths;
    // Evening out the frequencies makes the tree flatter; in the end they are all one.
    for (std::uint32_t& frequency : frequencies) frequency = (frequency + 1) / 2;
  }
}

std::uint8_t* LiteralDeflate::flush(std::uint8_t* out) {
  std::memcpy(out, &bits_, sizeof bits_);  // little-endian, as every machine that this builds for
  out += bit_count_ / 8;
  bits_ >>= static_cast<unsigned>(bit_count_ & ~7);
  bit_count_ &= 7;
  return out;
}

// The inner loop: its state is in local variables, since the bytes written might alias members.
std::uint8_t* LiteralDeflate::append_literals(const std::uint8_t* piece, std::size_t bytes,
                                              const std::vector<HuffmanCode>& codes, std::uint8_t* out) {
  std::array<std::uint32_t, kLiterals> packed{};
  for (std::size_t i = 0; i < kLiterals; ++i) packed[i] = codes[i].bits | (std::uint32_t{codes[i].length} << 16U);
  std::uint64_t bits = bits_;
  unsigned count = static_cast<unsigned>(bit_count_);
  const auto add = [&](std::uint8_t byte) {
    const std::uint32_t code = packed[byte];
    bits |= std::uint64_t{code & 0xFFFFU} << count;
    count += code >> 16U;
  };
  const auto write = [&] {
    std::memcpy(out, &bits, sizeof bits);
    out += count / 8U;
    bits >>= count & ~7U;
    count &= 7U;
  };
  std::size_t i = 0;
  for (; i + 4 <= bytes; i += 4) {  // at most 7 bits are left over, four codes add at most 56
    add(piece[i]);
    add(piece[i + 1]);
    add(piece[i + 2]);
    add(piece[i + 3]);
    write();
  }
  for (; i < bytes; ++i) {
    add(piece[i]);
    write();
  }
  bits_ = bits;
  bit_count_ = static_cast<int>(count);
  return out;
}

std::uint8_t* LiteralDeflate::append(const std::uint8_t* piece, std::size_t bytes, bool last, std::uint8_t* out) {
  const std::vector<int> lengths = huffman_lengths(count_bytes(piece, bytes), kMaxLength);
  const std::vector<HuffmanCode> codes = canonical_codes(lengths);
  // Header: dynamic codes; 257 literal codes, 2 distance codes; all 19 lengths of the code of lengths, in which 0 to 15
  // take four bits each and repetitions (the first three of the order) are not used.
  put(last ? 1 : 0, 1);
  put(2, 2);
  put(0, 5);
  put(1, 5);
  put(15, 4);
  put(0, 9);
  out = flush(out);
  for (int i = 0; i < 16; ++i) {
    put(4, 3);
    out = flush(out);
  }
  for (const int length : lengths) {
    put(reversed(static_cast<std::uint32_t>(length), 4), 4);
    out = flush(out);
  }
  // Decoders want a complete code of distances, though none is sent: two of one bit.
  put(reversed(1, 4), 4);
  put(reversed(1, 4), 4);
  out = flush(out);
  out = append_literals(piece, bytes, codes, out);
  put(codes[kEndOfBlock].bits, codes[kEndOfBlock].length);
  out = flush(out);
  if (last && bit_count_ > 0) {
    bit_count_ = 8;
    out = flush(out);
  }
  return out;
}

}  // namespace rigproof
