// Procedural, seeded textures of floors, walls and things: no files, no downloads, the same bytes for one seed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rigproof/sim/world.h"

namespace rigproof {

/// "asphalt", "brick", ...: what SceneTexture::type may be besides "file".
const std::vector<std::string>& texture_types();

/// Fills a square of texture.size_px, RGB, that repeats without seams. Throws Error for an unknown type or a file that
/// cannot be read.
std::vector<std::uint8_t> draw_texture(const SceneTexture& texture, std::uint64_t seed);

}  // namespace rigproof
