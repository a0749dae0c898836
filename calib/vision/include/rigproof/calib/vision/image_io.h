// Reads the images and clouds of a recording, quickly and without trusting them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <variant>
#include <vector>

#include "rigproof/core/image.h"
#include "rigproof/core/unreadable.h"

namespace rigproof {

/// Wider or higher images are refused before anything is allocated.
inline constexpr int kMaxImageSide = 16384;

/// Reads PNG (8 bit: own decoder on libdeflate; other kinds through OpenCV) or JPEG as grey, 0.299 R + 0.587 G + 0.114
/// B. Never throws on the file's content.
std::variant<Image8, Unreadable> read_grey_image(const std::filesystem::path& file);

/// Reads a 16-bit grey PNG. Never throws on the file's content.
std::variant<Image16, Unreadable> read_depth_image(const std::filesystem::path& file);

/// Points of a PCD (ascii, binary, binary_compressed; fields x y z as float) or of a text with x y z first in each
/// line, metres. Points that are not finite are left out. Never throws on the file's content.
std::variant<std::vector<Eigen::Vector3f>, Unreadable> read_point_cloud(const std::filesystem::path& file);

/// The same from bytes in memory.
std::variant<Image8, Unreadable> decode_grey_image(const std::vector<std::uint8_t>& bytes);
std::variant<Image16, Unreadable> decode_depth_image(const std::vector<std::uint8_t>& bytes);
std::variant<std::vector<Eigen::Vector3f>, Unreadable> decode_point_cloud(const std::vector<std::uint8_t>& bytes);

}  // namespace rigproof
