// 4x4 matrices out of what a program printed.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Every rigid transform in the text: three or four rows of four numbers, one row a line, the fourth row 0 0 0 1.
/// Brackets, commas, semicolons and text before the first number of a line ("R: ", "T = [") are ignored. A block whose
/// 3x3 part is no rotation within 0.001 is not one.
std::vector<Rigid3> find_matrices(const std::string& text);

}  // namespace rigproof
