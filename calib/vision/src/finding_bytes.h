// The bytes in which findings and their keys are written: every bit of a number counts.
// What a thing consists of is told once, as parts(archive, thing): a Writer writes them and a Reader reads them back.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "rigproof/core/rig.h"

namespace rigproof::detection {

/// Numbers and texts one after the other.
class Writer {
 public:
  explicit Writer(std::uint32_t format) { number(format); }

  template <typename Number>
  void number(const Number& value) {
    static_assert(std::is_arithmetic_v<Number>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void flag(bool value) { number(static_cast<std::uint8_t>(value)); }
  /// Of what comes next.
  void kind(const std::string& value) { text(value); }
  void number_or_text(const std::variant<double, std::string>& value) {
    const auto* real = std::get_if<double>(&value);
    flag(real != nullptr);
    if (real != nullptr)
      number(*real);
    else
      text(std::get<std::string>(value));
  }
  void text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
  }
  template <typename Matrix>
  void matrix(const Matrix& value) {
    for (Eigen::Index i = 0; i < value.size(); ++i) number(value.data()[i]);
  }
  template <typename Item>
  void size(const std::vector<Item>& items, std::size_t /*bytes_each*/) {
    number(static_cast<std::uint32_t>(items.size()));
  }
  /// Whether it is there.
  template <typename Value>
  bool present(const std::optional<Value>& value) {
    flag(value.has_value());
    return value.has_value();
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// The same backwards. Once something is missing, nothing more is read and finished() is false.
class Reader {
 public:
  Reader(const std::string& bytes, std::uint32_t format) : bytes_(bytes) {
    std::uint32_t written = 0;
    number(written);
    good_ = good_ && written == format;
  }

  template <typename Number>
  void number(Number& value) {
    static_assert(std::is_arithmetic_v<Number>);
    if (take(sizeof value)) std::memcpy(&value, bytes_.data() + at_ - sizeof value, sizeof value);
  }
  // One byte; anything but 0 is true, so that foreign bytes cannot make an impossible bool.
  bool flag() {
    std::uint8_t value = 0;
    number(value);
    return value != 0;
  }
  void flag(bool& value) { value = flag(); }
  void kind(const std::string& expected) {
    std::string value;
    text(value);
    good_ = good_ && value == expected;
  }
  void number_or_text(std::variant<double, std::string>& value) {
    if (flag())
      number(value.emplace<double>());
    else
      text(value.emplace<std::string>());
  }
  void text(std::string& value) {
    const std::size_t size = count(1);
    if (take(size)) value = bytes_.substr(at_ - size, size);
  }
  template <typename Matrix>
  void matrix(Matrix&& value) {
    for (Eigen::Index i = 0; i < value.size(); ++i) number(value.data()[i]);
  }
  /// Makes room for as many as were written, which need so many bytes at least that must be there.
  template <typename Item>
  void size(std::vector<Item>& items, std::size_t bytes_each) {
    items.resize(count(bytes_each));
  }
  template <typename Value>
  bool present(std::optional<Value>& value) {
    value.reset();
    if (flag()) value.emplace();
    return value.has_value();
  }
  /// Whether all was read, and nothing is left.
  bool finished() const { return good_ && at_ == bytes_.size(); }

 private:
  bool take(std::size_t size) {
    good_ = good_ && size <= bytes_.size() - at_;
    if (good_) at_ += size;
    return good_;
  }
  std::size_t count(std::size_t bytes_each) {
    std::uint32_t value = 0;
    number(value);
    if (value > (bytes_.size() - at_) / bytes_each) good_ = false;
    return good_ ? value : 0;
  }

  const std::string& bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

/// The bytes of a thing.
template <typename Thing, typename Parts>
std::string bytes_of_parts(std::uint32_t format, const Thing& thing, const Parts& parts) {
  Writer to(format);
  parts(to, thing);
  return to.bytes();
}

/// The thing of bytes; false, and the thing as it was, where they are no such bytes.
template <typename Thing, typename Parts>
bool read_parts(std::uint32_t format, const std::string& bytes, Thing* thing, const Parts& parts) {
  Reader from(bytes, format);
  Thing read = *thing;
  parts(from, read);
  if (from.finished()) *thing = std::move(read);
  return from.finished();
}

inline constexpr auto kTransformParts = [](auto& archive, auto& T) {
  archive.matrix(T.rotation.coeffs());
  archive.matrix(T.translation);
};

// Of keys.
void write(const Camera& camera, Writer* to);
void write(const DepthStream& depth, Writer* to);

}  // namespace rigproof::detection
