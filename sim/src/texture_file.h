// Textures that a user brings along.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace rigproof {

/// Reads an image of any common format and resizes it to a square, RGB, first row = bottom of the picture on a wall.
/// Throws Error that names the file.
std::vector<std::uint8_t> load_texture_file(const std::filesystem::path& file, int size_px);

}  // namespace rigproof
