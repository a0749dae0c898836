#include "rigproof/core/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

namespace rigproof {
namespace {

// A leading plus is allowed in YAML and CSV, but not by from_chars.
std::string_view without_plus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  return text;
}

template <typename Number>
std::optional<Number> parse_whole(std::string_view text) {
  text = without_plus(text);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// Damerau-Levenshtein distance (optimal string alignment), case-insensitive: two swapped letters are one slip.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

std::string formatted(double value, std::chars_format format, int precision) {
  // Room for the largest double in fixed notation.
  char buffer[400];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value, format, precision);
  return result.ec == std::errc() ? std::string(buffer, result.ptr) : std::to_string(value);
}

// "yaw" of "yaw_deg": names carry their unit behind the last underscore.
std::string_view without_unit(std::string_view name) { return name.substr(0, name.rfind('_')); }

// A part that was left out ("lambda" for "odometry_lambda") or another unit counts as near, though less than a slip.
bool is_relative(std::string_view name, std::string_view candidate) {
  if (name.size() < 3) return false;
  return candidate.find(name) != std::string_view::npos || without_unit(name) == without_unit(candidate);
}

}  // namespace

std::string number_text(double value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  return std::string(buffer, result.ptr);
}

std::string short_text(double value, int significant_digits) {
  return formatted(value, std::chars_format::general, significant_digits);
}

std::string fixed_text(double value, int decimals) { return formatted(value, std::chars_format::fixed, decimals); }

std::optional<double> parse_number(std::string_view text) {
  const std::optional<double> value = parse_whole<double>(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view text) { return parse_whole<std::int64_t>(text); }

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) {
    if (!text.empty()) text += separator;
    text += word;
  }
  return text;
}

std::string shell_word(const std::string& word) {
  const std::string plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string sentences_text(const std::vector<std::string>& sentences) {
  constexpr std::string_view kMarks = ".!?;:";
  std::string text;
  for (const std::string& sentence : sentences) {
    if (!text.empty()) text += kMarks.find(text.back()) == std::string_view::npos ? "; " : " ";
    text += sentence;
  }
  return text;
}

std::string megabytes(double bytes) {
  if (bytes >= 1e9) return fixed_text(bytes / 1e9, 1) + " GB";
  if (bytes >= 1e7) return fixed_text(bytes / 1e6, 0) + " MB";
  return bytes >= 1e5 ? fixed_text(bytes / 1e6, 1) + " MB" : fixed_text(bytes / 1e3, 0) + " kB";
}

std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known) {
  // Names of hostile length are not compared: the distance costs the product of both lengths.
  if (name.size() > 256) return std::nullopt;
  const std::size_t allowed = std::max<std::size_t>(2, name.size() / 3);
  std::optional<std::string> nearest;
  std::size_t best = allowed + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(name, candidate);
    const std::size_t rank = is_relative(name, candidate) ? std::min(distance, allowed) : distance;
    if (rank >= best || rank >= std::max(name.size(), candidate.size())) continue;
    best = rank;
    nearest = candidate;
  }
  return nearest;
}

std::string suggestion(std::string_view name, const std::vector<std::string>& known) {
  const std::optional<std::string> nearest = nearest_name(name, known);
  const std::string all = known.empty() ? "none is known" : "known: " + joined(known);
  return nearest ? "did you mean \"" + *nearest + "\"? " + all : all;
}

std::string for_message(std::string_view text, std::size_t longest) {
  std::string clean;
  std::size_t at = 0;
  while (at < text.size() && at < longest) {
    const std::size_t length = utf8_length(text, at);
    const auto first = static_cast<unsigned char>(text[at]);
    // Control characters beyond 0x7f are two bytes, of which the first is 0xC2: a terminal obeys them, too.
    const bool control = first < 0x20 || first == 0x7f ||
                         (first == 0xC2 && length == 2 && static_cast<unsigned char>(text[at + 1]) < 0xA0);
    if (length == 0 || control)
      clean += '?';
    else
      clean += text.substr(at, length);
    at += std::max<std::size_t>(length, 1);
  }
  if (at < text.size()) clean += "...";
  return clean;
}

std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&text](std::size_t k) { return static_cast<std::uint8_t>(text[k]); };
  const std::uint8_t first = byte(at);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || at + length > text.size()) return 0;
  std::uint32_t code = first & (0xFFU >> (length + 1));
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(at + k) & 0xC0U) != 0x80U) return 0;
    code = (code << 6U) | (byte(at + k) & 0x3FU);
  }
  static constexpr std::uint32_t kSmallest[5] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  return code < kSmallest[length] || code > 0x10FFFF || surrogate ? 0 : length;
}

}  // namespace rigproof
