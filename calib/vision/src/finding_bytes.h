// The bytes in which findings and their keys are written: every bit of a number counts.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "rigproof/core/rig.h"

namespace rigproof::detection {

/// Numbers and texts one after the other.
class Writer {
 public:
  template <typename Number>
  void number(Number value) {
    static_assert(std::is_arithmetic_v<Number>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
  }
  template <typename Matrix>
  void matrix(const Matrix& value) {
    for (Eigen::Index i = 0; i < value.size(); ++i) number(value.data()[i]);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// The same backwards. Once something is missing, nothing more is read and finished() is false.
class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}

  template <typename Number>
  void number(Number* value) {
    static_assert(std::is_arithmetic_v<Number>);
    if (!take(sizeof *value)) return;
    std::memcpy(value, bytes_.data() + at_ - sizeof *value, sizeof *value);
  }
  // One byte; anything but 0 is true, so that foreign bytes cannot make an impossible bool.
  bool flag() {
    std::uint8_t value = 0;
    number(&value);
    return value != 0;
  }
  void text(std::string* value) {
    const std::size_t size = count(1);
    if (take(size)) *value = bytes_.substr(at_ - size, size);
  }
  template <typename Matrix>
  void matrix(Matrix* value) {
    for (Eigen::Index i = 0; i < value->size(); ++i) number(&value->data()[i]);
  }
  /// A number of things of at least so many bytes, which must be there.
  std::size_t count(std::size_t bytes_each) {
    std::uint32_t value = 0;
    number(&value);
    if (value > (bytes_.size() - at_) / bytes_each) good_ = false;
    return good_ ? value : 0;
  }
  bool finished() const { return good_ && at_ == bytes_.size(); }

 private:
  bool take(std::size_t size) {
    good_ = good_ && size <= bytes_.size() - at_;
    if (good_) at_ += size;
    return good_;
  }

  const std::string& bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

void write(const Camera& camera, Writer* to);
void write(const Rigid3& T, Writer* to);
void write(const DepthStream& depth, Writer* to);

}  // namespace rigproof::detection
