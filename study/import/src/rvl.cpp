#include "rvl.h"

#include <cstring>

#include "rigproof/calib/vision/image_io.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

constexpr std::size_t kSizeBytes = 8;
// Ten bytes may hold any number of empty pixels: room is made for what a depth camera can have.
constexpr int kMaxPixels = 1 << 26;

// Numbers of three bits a nibble, the lowest first; the fourth bit says that there are more. Nibbles come from the
// highest of each little-endian word of 32 bits.
class Nibbles {
 public:
  explicit Nibbles(std::string_view bytes) : bytes_(bytes) {}

  std::uint32_t number() {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 30; shift += 3) {
      const std::uint32_t nibble = next();
      value |= (nibble & 7U) << shift;
      if ((nibble & 8U) == 0) return value;
    }
    throw Error("RVL depth with a number of more than 30 bits");
  }

 private:
  std::uint32_t next() {
    if (left_ == 0) {
      if (bytes_.size() < sizeof word_) throw Error("RVL depth that ends early");
      std::memcpy(&word_, bytes_.data(), sizeof word_);
      bytes_.remove_prefix(sizeof word_);
      left_ = 8;
    }
    const std::uint32_t nibble = word_ >> 28U;
    word_ <<= 4U;
    --left_;
    return nibble;
  }

  std::string_view bytes_;
  std::uint32_t word_ = 0;
  int left_ = 0;
};

}  // namespace

RvlSize read_rvl_size(std::string_view data) {
  if (data.size() < kSizeBytes) throw Error("RVL depth that ends early");
  RvlSize size;
  std::memcpy(&size.width, data.data(), sizeof size.width);
  std::memcpy(&size.height, data.data() + sizeof size.width, sizeof size.height);
  if (size.width < 1 || size.height < 1 || size.width > kMaxImageSide || size.height > kMaxImageSide)
    throw Error("RVL depth of " + std::to_string(size.width) + "x" + std::to_string(size.height) + " pixels; 1 to " +
                std::to_string(kMaxImageSide) + " are allowed");
  if (size.width > kMaxPixels / size.height)
    throw Error("RVL depth of " + std::to_string(size.width) + "x" + std::to_string(size.height) + " pixels; " +
                std::to_string(kMaxPixels) + " in all are allowed");
  return size;
}

Image16 decode_rvl(std::string_view data) {
  const RvlSize size = read_rvl_size(data);
  Nibbles nibbles(data.substr(kSizeBytes));
  Image16 image(size.width, size.height);
  auto pixel = image.pixels.begin();
  std::uint32_t previous = 0;
  const auto run = [&] {
    const std::uint32_t length = nibbles.number();
    if (length > static_cast<std::size_t>(image.pixels.end() - pixel))
      throw Error("RVL depth with more pixels than its size");
    return length;
  };
  while (pixel != image.pixels.end()) {
    pixel = std::fill_n(pixel, run(), std::uint16_t{0});
    for (std::uint32_t left = run(); left > 0; --left) {
      const std::uint32_t zigzag = nibbles.number();
      previous += (zigzag >> 1U) ^ (~(zigzag & 1U) + 1U);
      *pixel++ = static_cast<std::uint16_t>(previous);
    }
  }
  return image;
}

}  // namespace rigproof
