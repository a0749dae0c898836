#include "rigproof/core/figures.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr double kShownInPowers = 1e6;

// Power of ten of the first digit once the value is rounded to the given digits: .0996 to two digits is .10.
int first_digit_power(double value, int significant) {
  int power = static_cast<int>(std::floor(std::log10(value)));
  const double unit = std::pow(10.0, power - significant + 1);
  if (std::round(value / unit) * unit >= std::pow(10.0, power + 1) * (1.0 - 1e-12)) ++power;
  return power;
}

}  // namespace

int decimals_for(double value, int significant, int max_decimals) {
  const double magnitude = std::abs(value);
  if (!(magnitude > 0.0) || !std::isfinite(magnitude)) return 0;
  return std::clamp(significant - 1 - first_digit_power(magnitude, significant), 0, max_decimals);
}

int decimals_for_sigma(double sigma, int max_decimals) {
  const double magnitude = std::abs(sigma);
  if (!(magnitude > 0.0) || !std::isfinite(magnitude)) return 0;
  const double leading = magnitude / std::pow(10.0, std::floor(std::log10(magnitude)));
  return decimals_for(sigma, leading < 2.95 ? 2 : 1, max_decimals);
}

std::string figure(double value, int decimals) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  if (std::abs(value) >= kShownInPowers) return fmt::format("{:.1e}", value);
  std::string text = fixed_text(value, decimals);
  if (text.find_first_not_of("-0.") == std::string::npos) return "0";
  const std::size_t zero = text[0] == '-' ? 1 : 0;
  if (text.compare(zero, 2, "0.") == 0) text.erase(zero, 1);
  return text;
}

std::string signed_figure(double value, int decimals) {
  const std::string text = figure(value, decimals);
  return text == "0" || text[0] == '-' || text[0] == 'n' ? text : "+" + text;
}

std::string short_figure(double value) {
  constexpr int kDigits = 2, kMaxDecimals = 6;
  return figure(value, decimals_for(value, kDigits, kMaxDecimals));
}

std::string plain_figure(double value) { return short_text(value, 4); }

std::string all_of_them(std::size_t count) {
  static const std::array<const char*, 13> words = {"none",  "one",   "two",  "three", "four",   "five",  "six",
                                                    "seven", "eight", "nine", "ten",   "eleven", "twelve"};
  if (count == 1) return "one";
  if (count == 2) return "both";
  return "all " + (count < words.size() ? words[count] : std::to_string(count));
}

}  // namespace rigproof
