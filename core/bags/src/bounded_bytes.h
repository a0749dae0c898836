// Little-endian numbers and length-prefixed texts out of a piece of memory that may end anywhere.
#pragma once

#include <cstdint>
#include <cstring>
#include <string_view>

namespace rigproof {

/// Reading beyond the end gives zeros and empty texts, and makes it bad.
class BoundedBytes {
 public:
  explicit BoundedBytes(std::string_view bytes) : bytes_(bytes) {}

  template <typename Number>
  Number number() {
    Number value{};
    const std::string_view raw = take(sizeof(Number));
    if (raw.size() == sizeof(Number)) std::memcpy(&value, raw.data(), sizeof(Number));  // x86 and ARM: as in the file
    return value;
  }
  /// Behind its length of 32 bits.
  std::string_view text() { return take(number<std::uint32_t>()); }
  std::string_view take(std::uint64_t length) {
    if (length > bytes_.size() - at_) {
      good_ = false;
      at_ = bytes_.size();
      return {};
    }
    const std::string_view piece = bytes_.substr(at_, static_cast<std::size_t>(length));
    at_ += static_cast<std::size_t>(length);
    return piece;
  }
  std::string_view rest() { return take(bytes_.size() - at_); }
  std::size_t position() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }
  bool good() const { return good_; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace rigproof
