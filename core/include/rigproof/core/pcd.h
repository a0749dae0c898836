// Point clouds as PCD files.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace rigproof {

/// A PCD file, version 0.7: x y z as 32-bit floats, binary, unorganised. All machines that this builds for are
/// little-endian, as the format expects.
std::string encode_pcd(const std::vector<std::array<float, 3>>& points);

}  // namespace rigproof
