#include "run_deflate.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace rigproof {
namespace {

constexpr std::size_t kLiterals = 256, kEndOfBlock = 256, kSymbols = 286;
// Deflate allows 15; with 13 a pair of codes and its length fit into 32 bits, and two pairs into a word beside what is
// left over.
constexpr int kMaxLength = 13;
constexpr unsigned kPairLengthBits = 5;
// Bytes compared at a time; a shorter repetition is no run.
constexpr std::size_t kStride = 8;
constexpr std::uint32_t kLongestMatch = 258, kShortestMatch = 3;
// Frequencies come from one part in so many of the bytes: the code is longer by a few parts in a thousand.
constexpr std::size_t kCountedPart = 4;

// How deflate sends the length of a repetition (RFC 1951, section 3.2.5).
struct LengthSymbol {
  std::uint16_t symbol = 0;
  std::uint8_t extra = 0, extra_bits = 0;
};

constexpr std::array<LengthSymbol, kLongestMatch + 1> make_length_symbols() {
  std::array<LengthSymbol, kLongestMatch + 1> table{};
  std::uint32_t length = kShortestMatch;
  for (std::uint16_t symbol = 257; symbol < 285; ++symbol) {
    const auto bits = static_cast<std::uint8_t>(symbol < 265 ? 0 : (symbol - 261) / 4);
    for (std::uint32_t extra = 0; extra < (1U << bits) && length < kLongestMatch; ++extra)
      table[length++] = {symbol, static_cast<std::uint8_t>(extra), bits};
  }
  table[kLongestMatch] = {285, 0, 0};
  return table;
}

constexpr std::array<LengthSymbol, kLongestMatch + 1> kLengthSymbols = make_length_symbols();

// The next repetition to send of a run, so that never one or two bytes are left over.
std::uint32_t next_match(std::uint32_t left) {
  if (left <= kLongestMatch) return left;
  return std::min(kLongestMatch, left - kShortestMatch);
}

std::uint64_t load(const std::uint8_t* bytes) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

// Depths of the leaves of a Huffman tree. Leaves in order of frequency and inner nodes as they arise are two sorted
// queues, so that the two lightest nodes are always at their heads (van Leeuwen 1976).
std::vector<int> tree_depths(const std::vector<std::uint32_t>& frequencies) {
  std::vector<std::uint16_t> symbols;
  for (std::size_t i = 0; i < frequencies.size(); ++i)
    if (frequencies[i] > 0) symbols.push_back(static_cast<std::uint16_t>(i));
  std::sort(symbols.begin(), symbols.end(), [&](std::uint16_t a, std::uint16_t b) {
    return frequencies[a] != frequencies[b] ? frequencies[a] < frequencies[b] : a < b;
  });
  const std::size_t leaves = symbols.size(), nodes = 2 * leaves - 1;
  std::vector<std::uint64_t> weight(nodes);
  std::vector<std::size_t> parent(nodes);
  std::vector<int> depth(nodes, 0), result(frequencies.size(), 0);
  for (std::size_t i = 0; i < leaves; ++i) weight[i] = frequencies[symbols[i]];
  std::size_t leaf = 0, inner = leaves;
  for (std::size_t made = leaves; made < nodes; ++made) {
    const auto take = [&] {
      const bool take_leaf = leaf < leaves && (inner >= made || weight[leaf] <= weight[inner]);
      const std::size_t node = take_leaf ? leaf++ : inner++;
      parent[node] = made;
      return weight[node];
    };
    weight[made] = take();
    weight[made] += take();
  }
  for (std::size_t node = nodes - 1; node-- > 0;) depth[node] = depth[parent[node]] + 1;  // parents come later
  for (std::size_t i = 0; i < leaves; ++i) result[symbols[i]] = depth[i];
  return result;
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

// Codes of two bytes in a row, by both of them, lower byte first: bits above their number.
void pair_up(const std::vector<HuffmanCode>& codes, std::vector<std::uint32_t>* pairs) {
  pairs->resize(kLiterals * kLiterals);
  std::uint32_t* out = pairs->data();
  for (std::size_t second = 0; second < kLiterals; ++second) {
    for (std::size_t first = 0; first < kLiterals; ++first) {
      const std::uint32_t bits = codes[first].bits | (std::uint32_t{codes[second].bits} << codes[first].length);
      *out++ = (bits << kPairLengthBits) | std::uint32_t(codes[first].length + codes[second].length);
    }
  }
}

}  // namespace

std::vector<int> huffman_lengths(std::vector<std::uint32_t> frequencies, int max_length) {
  for (;;) {
    std::vector<int> lengths = tree_depths(frequencies);
    if (*std::max_element(lengths.begin(), lengths.end()) <= max_length) return lengths;
    // Lifting the rarest makes the tree flatter; in the end all are the same.
    std::uint32_t rarest = std::numeric_limits<std::uint32_t>::max();
    for (const std::uint32_t frequency : frequencies)
      if (frequency > 0) rarest = std::min(rarest, frequency);
    for (std::uint32_t& frequency : frequencies)
      if (frequency > 0) frequency = std::max(frequency, 2 * rarest);
  }
}

void RunDeflate::begin(int period) {
  period_ = static_cast<std::size_t>(period);
  bits_ = 0;
  bit_count_ = 0;
}

std::uint8_t* RunDeflate::flush(std::uint8_t* out) {
  std::memcpy(out, &bits_, sizeof bits_);  // little-endian, as every machine that this builds for
  out += bit_count_ / 8;
  bits_ >>= static_cast<unsigned>(bit_count_ & ~7);
  bit_count_ &= 7;
  return out;
}

void RunDeflate::find_segments(const std::uint8_t* piece, std::size_t bytes) {
  segments_.clear();
  std::size_t start = 0, i = period_;
  while (i + kStride <= bytes) {
    if (load(piece + i) != load(piece + i - period_)) {
      i += kStride;
      continue;
    }
    const std::size_t first = i;
    std::uint64_t difference = 0;
    for (i += kStride; i + kStride <= bytes && difference == 0;) {
      difference = load(piece + i) ^ load(piece + i - period_);
      i += difference == 0 ? kStride : static_cast<std::size_t>(__builtin_ctzll(difference)) / 8;
    }
    segments_.push_back({static_cast<std::uint32_t>(first - start), static_cast<std::uint32_t>(i - first)});
    start = i;
  }
  segments_.push_back({static_cast<std::uint32_t>(bytes - start), 0});
}

std::vector<std::uint32_t> RunDeflate::count_symbols(const std::uint8_t* piece) const {
  // Several counters, because equal neighbours would wait for each other.
  std::array<std::array<std::uint32_t, kLiterals>, 4> counts{};
  std::vector<std::uint32_t> sums(kSymbols);
  std::size_t counted = 0, literals = 0;
  for (const Segment& segment : segments_) {
    for (std::size_t i = 0; i < segment.literals; i += kStride * kCountedPart) {
      const std::size_t end = std::min<std::size_t>(i + kStride, segment.literals);
      for (std::size_t k = i; k < end; ++k) ++counts[k & 3U][piece[k]];
      counted += end - i;
    }
    literals += segment.literals;
    piece += segment.literals + segment.run;
    for (std::uint32_t left = segment.run, match = 0; left > 0; left -= match) {
      match = next_match(left);
      ++sums[kLengthSymbols[match].symbol];
    }
  }
  // What was not counted may still occur: every byte gets a code.
  for (std::size_t i = 0; i < kLiterals; ++i) {
    const std::uint64_t seen = std::uint64_t{counts[0][i]} + counts[1][i] + counts[2][i] + counts[3][i];
    sums[i] = 1 + static_cast<std::uint32_t>(counted == 0 ? 0 : seen * literals / counted);
  }
  sums[kEndOfBlock] = 1;
  return sums;
}

// Dynamic codes; all 19 lengths of the code of lengths are sent, in which 0 to 15 take four bits each and repetitions
// (the first three of the order) are not used.
std::uint8_t* RunDeflate::append_header(const std::vector<int>& lengths, bool last, std::uint8_t* out) {
  put(last ? 1 : 0, 1);
  put(2, 2);
  put(static_cast<std::uint32_t>(kSymbols) - 257, 5);
  put(4 - 1, 5);
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
  // Distances 1 to 4 have a symbol each. Decoders want a complete code: two of one bit, though only one is sent.
  const std::size_t used = period_ - 1, other = used == 0 ? 1 : 0;
  for (std::size_t distance = 0; distance < 4; ++distance)
    put(reversed(distance == used || distance == other ? 1 : 0, 4), 4);
  return flush(out);
}

// The inner loop: its state is in local variables, since the bytes written might alias members.
std::uint8_t* RunDeflate::append_segments(const std::uint8_t* piece, const std::vector<HuffmanCode>& codes,
                                          std::uint8_t* out) {
  pair_up(codes, &pairs_);
  const std::uint32_t* const pairs = pairs_.data();
  // Of the two distance codes, 0 is the smaller distance.
  const std::uint32_t distance_bit = period_ == 1 ? 0 : 1;
  std::uint64_t bits = bits_;
  auto count = static_cast<unsigned>(bit_count_);
  const auto add = [&](std::uint32_t code, unsigned length) {
    bits |= std::uint64_t{code} << count;
    count += length;
  };
  const auto add_pair = [&](const std::uint8_t* bytes) {
    const std::uint32_t pair = pairs[bytes[0] | (bytes[1] << 8U)];
    add(pair >> kPairLengthBits, pair & ((1U << kPairLengthBits) - 1));
  };
  const auto write = [&] {
    std::memcpy(out, &bits, sizeof bits);
    out += count / 8U;
    bits >>= count & ~7U;
    count &= 7U;
  };
  for (const Segment& segment : segments_) {
    const std::uint8_t* const end = piece + segment.literals;
    for (; piece + 4 <= end; piece += 4) {  // at most 7 bits are left over, two pairs add at most 52
      add_pair(piece);
      add_pair(piece + 2);
      write();
    }
    for (; piece < end; ++piece) {
      add(codes[*piece].bits, codes[*piece].length);
      write();
    }
    for (std::uint32_t left = segment.run, match = 0; left > 0; left -= match) {
      match = next_match(left);
      const LengthSymbol& length = kLengthSymbols[match];
      add(codes[length.symbol].bits, codes[length.symbol].length);
      add(length.extra | (distance_bit << length.extra_bits), length.extra_bits + 1U);
      write();
    }
    piece += segment.run;
  }
  bits_ = bits;
  bit_count_ = static_cast<int>(count);
  return out;
}

std::uint8_t* RunDeflate::append(const std::uint8_t* piece, std::size_t bytes, bool last, std::uint8_t* out) {
  find_segments(piece, bytes);
  const std::vector<int> lengths = huffman_lengths(count_symbols(piece), kMaxLength);
  const std::vector<HuffmanCode> codes = canonical_codes(lengths);
  out = append_header(lengths, last, out);
  out = append_segments(piece, codes, out);
  put(codes[kEndOfBlock].bits, codes[kEndOfBlock].length);
  out = flush(out);
  if (last && bit_count_ > 0) {
    bit_count_ = 8;
    out = flush(out);
  }
  return out;
}

}  // namespace rigproof
