// The parts of an image in which coverage is told.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "rigproof/core/camera.h"

namespace rigproof {

/// An image is told in this many equal cells.
constexpr int kCellsAcross = 8, kCellsDown = 6;
constexpr int kImageCells = kCellsAcross * kCellsDown;

/// Index of the cell that a pixel of the image lies in, row by row.
std::size_t image_cell(const Camera& camera, const Eigen::Vector2d& pixel);

}  // namespace rigproof
