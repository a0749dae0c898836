// Encodes images as PNG several times faster than the usual libraries: one filter for all rows, and a deflate that
// looks for runs only. The same bytes on every machine.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "rigproof/core/image.h"

namespace rigproof {

/// Reuses its buffers from image to image. One thread at a time.
class PngEncoder {
 public:
  PngEncoder();
  ~PngEncoder();
  PngEncoder(const PngEncoder&) = delete;
  PngEncoder& operator=(const PngEncoder&) = delete;

  /// 8-bit grey (1 channel) or RGB (3 channels). The bytes stay valid until the next call.
  std::string_view encode(const Image8& image);
  /// 16-bit grey.
  std::string_view encode(const Image16& image);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigproof
