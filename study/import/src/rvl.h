// RVL, the lossless coding of 16-bit depth that compressed_depth_image_transport offers beside PNG (A. D. Wilson, Fast
// Lossless Depth Image Compression, ISS 2017).
#pragma once

#include <string_view>

#include "rigproof/core/image.h"

namespace rigproof {

/// What stands before the coded pixels: width and height, four bytes each, little-endian. Throws Error if that is cut
/// off or beyond what images may have.
struct RvlSize {
  int width = 0, height = 0;
};
RvlSize read_rvl_size(std::string_view data);

/// Throws Error where the data end early or go on for more pixels than there are.
Image16 decode_rvl(std::string_view data);

}  // namespace rigproof
