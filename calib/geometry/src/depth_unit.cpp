#include "rigproof/calib/geometry/depth_unit.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace rigproof {
namespace {

// Of what is in use [m]: decimal counts, those of an L515 and of recordings with 5000 a metre, feet, inches.
bool is_unit(double metres) {
  constexpr double kOff = 0.06;  // depth scales are better
  const double units[] = {1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 2.5e-4, 2e-4, 0.3048, 0.0254};
  return std::any_of(std::begin(units), std::end(units),
                     [=](double unit) { return std::abs(std::log(metres / unit)) < kOff; });
}

}  // namespace

bool unit_explains(double factor, double unit_m) { return is_unit(unit_m / factor) || is_unit(1.0 / factor); }

}  // namespace rigproof
