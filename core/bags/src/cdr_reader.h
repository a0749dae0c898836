// Plain CDR as ROS 2 serialises messages, in either byte order, on Fast CDR; lengths are checked before memory is
// taken.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "fast_cdr.h"

namespace rigproof {

class CdrReader {
 public:
  /// @param bytes with the encapsulation of 4 bytes before them. Throws Error if that is no plain CDR. All methods
  /// throw Error or Fast CDR's exception where the message ends early.
  explicit CdrReader(std::string_view bytes);

  template <typename Number>
  Number number() {
    Number value{};
    cdr_ >> value;
    return value;
  }
  std::string text();
  /// uint8[]: a view into the message.
  std::string_view bytes();
  /// float64[].
  std::vector<double> numbers();
  template <std::size_t kSize>
  std::array<double, kSize> array() {
    std::array<double, kSize> values{};
    for (double& value : values) value = number<double>();
    return values;
  }
  /// Length of a sequence whose elements take at least so many bytes each.
  std::size_t length(std::size_t element_bytes);

 private:
  std::size_t left();

  fast_cdr::FastBuffer buffer_;
  fast_cdr::Cdr cdr_;
  const char* end_;
};

}  // namespace rigproof
