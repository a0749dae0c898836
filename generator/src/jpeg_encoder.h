// Images as JPEG, as a robot's compressed image topics carry them.
#pragma once

#include <string_view>
#include <vector>

#include "rigproof/core/image.h"

namespace rigproof {

class JpegEncoder {
 public:
  /// @param quality 1 to 100, as libjpeg counts
  explicit JpegEncoder(int quality) : quality_(quality) {}
  /// RGB or grey. The bytes stay valid until the next call. Throws Error.
  std::string_view encode(const Image8& image);

 private:
  int quality_;
  std::vector<unsigned char> bytes_;
};

}  // namespace rigproof
