// The text of OpenCV's FileStorage.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/camera.h"

namespace rigproof {

/// "NAME: !!opencv-matrix ..", row by row: the tag and the four keys by which FileStorage knows a matrix.
/// @param indent spaces before the name
std::string opencv_matrix(const std::string& name, std::size_t rows, std::size_t columns,
                          const std::vector<double>& values, std::size_t indent = 0);
/// K, and the coefficients that OpenCV's model of the lens has: five, or four of a fisheye.
std::string opencv_lens(const Camera& camera, const std::string& K_name, const std::string& D_name,
                        std::size_t indent = 0);

}  // namespace rigproof
