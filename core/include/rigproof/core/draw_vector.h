// Vectors of random numbers. In which order the arguments of a call are evaluated is the compiler's choice, so that no
// two draws stand in the arguments of one: the same seed would give other data under another compiler.
#pragma once

#include <Eigen/Core>

namespace rigproof {

/// A vector whose components `draw` gives, the last one first: the order that data of all versions have.
template <int kSize, typename Draw>
Eigen::Matrix<double, kSize, 1> draw_vector(Draw draw) {
  Eigen::Matrix<double, kSize, 1> v;
  for (int i = kSize; i-- > 0;) v[i] = draw();
  return v;
}

}  // namespace rigproof
