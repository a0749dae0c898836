// Small things that readers and writers of text share: numbers without loss, and the nearest known name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rigproof {

/// Allowed values of a number, both ends included.
struct NumberRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// The shortest text that reads back to the same double; independent of the locale.
std::string number_text(double value);
/// With so many significant digits ("%.4g"), or so many decimals ("%.3f"); independent of the locale.
std::string short_text(double value, int significant_digits);
std::string fixed_text(double value, int decimals);
/// A finite number that spans the whole text ("0.5", "+2", "1e-3"); nothing for "nan", "inf", "", "3 m".
std::optional<double> parse_number(std::string_view text);
/// A whole number that spans the whole text.
std::optional<std::int64_t> parse_integer(std::string_view text);

/// "a, b, c".
std::string joined(const std::vector<std::string>& words, const std::string& separator = ", ");
/// A word as a POSIX shell takes it whole: in single quotes unless it is plain.
std::string shell_word(const std::string& word);
/// One after the other, with a semicolon after those that no mark ends: "left: too far; right: no board. Turn more."
std::string sentences_text(const std::vector<std::string>& sentences);
/// A size for people: "2.5 GB", "12 MB", "0.3 MB", "4 kB".
std::string megabytes(double bytes);
/// The known name that takes the fewest edits, if it is near enough to be a slip of the pen.
std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known);
/// `did you mean "lambda"? known: model, lambda`, or only the second half where nothing is near.
std::string suggestion(std::string_view name, const std::vector<std::string>& known);

/// `text` cut to a length that fits a message, with control characters replaced: file content is not to be trusted.
std::string for_message(std::string_view text, std::size_t longest = 80);

/// Length [bytes] of the well-formed UTF-8 sequence that begins at `at`; 0 if there is none.
std::size_t utf8_length(std::string_view text, std::size_t at);

}  // namespace rigproof
