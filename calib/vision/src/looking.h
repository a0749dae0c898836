// Looking at one picture, wherever it comes from, and what is kept of a depth image for later.
#pragma once

#include <optional>
#include <string>

#include "rigproof/calib/vision/picture_memory.h"
#include "sight.h"

namespace rigproof::detection {

/// Depth images are sampled so that about this many points remain: more tell little about a plane and cost time.
inline constexpr int kDepthPoints = 12000;

Finding wrong_size(const char* code, int width, int height, const Camera& rig);

/// The boards of a rig but one.
std::vector<Board> others_than(const Rig& rig, int board);

/// Corners of the board in a grey image, or why there are none. `camera` is what the rig says of it, `others` are
/// boards that the image may show instead.
void search_image(const Image8& grey, const Camera& camera, const Board& board, std::vector<Board> others,
                  Sight* sight);

/// A depth image with the pixels that observing looks at, 0 elsewhere; absent where the memory does not have it.
std::optional<Image16> recall_depth(PictureMemory* memory, const std::string& content);

inline void tell_opened(PictureMemory* memory, const std::string& file) {
  if (memory != nullptr) memory->opens(file);
}

}  // namespace rigproof::detection
