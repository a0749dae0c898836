// Numbers as people read them: no leading zero, as many digits as mean something.
#pragma once

#include <string>

#include "rigproof/core/conventions.h"

namespace rigproof {

/// Digits after the point that show `significant` digits of |value|, at least 0 and at most `max_decimals`.
int decimals_for(double value, int significant, int max_decimals = 5);
/// Digits after the point for a standard deviation: two significant ones where the first is 1 or 2, else one.
int decimals_for_sigma(double sigma, int max_decimals = 5);

/// ".07", "-1.25", "0" (what rounds to zero is 0, never ".00"); a million and more as "1.2e+06".
std::string figure(double value, int decimals);
/// With a sign, "+.07"; zero has none.
std::string signed_figure(double value, int decimals);
/// As written in a sentence, "0.2", "62", "1.234": up to four significant digits, none of them needless.
std::string plain_figure(double value);
/// With two significant digits.
std::string short_figure(double value);

/// Of an axis of a transform (tx ty tz rx ry rz): metres in centimetres, radians in degrees.
template <typename Axis>
double in_unit(double value, Axis axis) {
  return axis < 3 ? 100.0 * value : rad_to_deg(value);
}

/// "one", "both", "all three" ... "all twelve", "all 13".
std::string all_of_them(std::size_t count);

}  // namespace rigproof
