// Points that look like the meeting of four squares.
#pragma once

#include <array>
#include <vector>

#include "smooth_image.h"

namespace rigproof::detection {

/// A saddle of brightness around which light and dark alternate exactly twice.
struct SaddleCandidate {
  Eigen::Vector2f position = Eigen::Vector2f::Zero();  ///< pixels of its level
  /// Directions of the four edges that leave it, as cosine and sine, in the order of increasing angle (x right, y down:
  /// clockwise). Even ones go from dark to light as the angle increases, odd ones from light to dark.
  std::array<Eigen::Vector2f, 4> edges;
  float contrast = 0.0F;  ///< light minus dark, in SmoothImage units
};

/// Strongest first, at most `max_count`.
std::vector<SaddleCandidate> find_saddle_candidates(const SmoothImage& image, std::size_t max_count = 4000);

}  // namespace rigproof::detection
