#include "template.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "rigproof/core/figures.h"
#include "rigproof/core/text.h"
#include "rigproof/words/findings_page.h"

namespace rigproof::words {
namespace {

constexpr std::size_t kShownCounts = 3, kShownStops = 8;

std::string spoken(const std::string& axis) {
  if (axis == "tilt_x") return "tilt about x";
  return axis == "tilt_y" ? "tilt about y" : axis;
}

// "=2": as many decimals as two digits take, so that what is small is not said to be 0.
std::string digits_words(double value, int digits) {
  const double size = std::abs(value);
  return fixed_text(value, size > 0.0 ? std::max(0, digits - 1 - static_cast<int>(std::floor(std::log10(size)))) : 0);
}

std::string number_words(double value, std::string_view format) {
  if (!std::isfinite(value)) return "unknown";
  if (format == "~") return short_figure(value);
  if (!format.empty() && format[0] == '=') return digits_words(value, format[1] - '0');
  return fmt::format(fmt::runtime(format.empty() ? std::string("{:.10g}") : fmt::format("{{:{}}}", format)), value);
}

std::string text_of(const FindingValue& value, std::string_view format = {}) {
  const auto* number = std::get_if<double>(&value.value);
  return number == nullptr ? std::get<std::string>(value.value) : number_words(*number, format);
}

std::string stops_words(const std::vector<int>& stops) {
  std::string text = stops.size() == 1 ? "stop " : "stops ";
  for (std::size_t i = 0; i < std::min(kShownStops, stops.size()); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(stops[i]);
  return text + (stops.size() > kShownStops ? ", .." : "");
}

// "12 no board, 1 blurred".
std::string counts_words(const std::vector<Finding>& reasons, const char* separator) {
  std::string text;
  for (std::size_t i = 0; i < std::min(kShownCounts, reasons.size()); ++i) {
    const FindingValue* count = reasons[i].find("count");
    text += (i == 0 ? "" : ", ") + (count == nullptr ? "?" : text_of(*count)) + separator + words_of(reasons[i]).head;
  }
  return text + (reasons.size() > kShownCounts ? ", .." : "");
}

std::string axes_words(const std::vector<std::string>& axes) {
  std::vector<std::string> names;
  for (const std::string& axis : axes) names.push_back(spoken(axis));
  return joined(names);
}

struct Direction {
  const char* value;  // with its unit
  const char* negative;
  const char* positive;
};
constexpr Direction kDirections[] = {{"x_cm", "too far back", "too far forward"},
                                     {"y_cm", "too far right", "too far left"},
                                     {"z_cm", "too low", "too high"},
                                     {"roll_deg", "rolled too far left", "rolled too far right"},
                                     {"pitch_deg", "pitched too far up", "pitched too far down"},
                                     {"yaw_deg", "turned too far right", "turned too far left"},
                                     {"x_px", "to the left", "to the right"},
                                     {"y_px", "up", "down"}};

std::string amount_words(double size, const std::string& unit) {
  std::string number = short_figure(size);
  if (unit == "px") {
    // Within a tenth of a pixel half a pixel and one pixel are the usual slips of convention.
    if (std::abs(size - 0.5) < 0.1) return "half a pixel";
    return std::abs(size - 1.0) < 0.1 ? "one pixel" : number + " px";
  }
  // A leading zero here: this is a sentence, not a table.
  return (number[0] == '.' ? "0" : "") + number + " " + unit;
}

// "0.62 cm too high, 0.17 deg pitched too far down": of the values that are there.
std::string offset_words(const Finding& finding, const std::string& separator) {
  std::vector<std::string> parts;
  for (const Direction& direction : kDirections) {
    const FindingValue* value = finding.find(direction.value);
    const auto* number = value == nullptr ? nullptr : std::get_if<double>(&value->value);
    if (number == nullptr) continue;
    parts.push_back(amount_words(std::abs(*number), value->name.substr(value->name.find('_') + 1)) + " " +
                    (*number > 0.0 ? direction.positive : direction.negative));
  }
  return joined(parts, separator);
}

class Filler {
 public:
  explicit Filler(const Finding& finding) : finding_(finding) {}

  // Optional parts first: they may hold values that are absent.
  std::string fill(std::string_view pattern) const {
    std::string text;
    while (!pattern.empty()) {
      const std::size_t open = pattern.find("[["), close = pattern.find("]]");
      if (open == std::string_view::npos || close == std::string_view::npos) return text + filled(pattern);
      text += filled(pattern.substr(0, open)) + optional(pattern.substr(open + 2, close - open - 2));
      pattern.remove_prefix(close + 2);
    }
    return text;
  }

 private:
  // "name?..", "name=text?..", or a part whose values must all be there.
  std::string optional(std::string_view part) const {
    const std::size_t end = part.find_first_of("?{ ");
    if (end == std::string_view::npos || part[end] != '?') return all_known(part) ? filled(part) : "";
    const std::string condition(part.substr(0, end));
    const std::size_t equals = condition.find('=');
    const FindingValue* value = finding_.find(condition.substr(0, equals));
    if (value == nullptr) return "";
    if (equals != std::string::npos && text_of(*value) != condition.substr(equals + 1)) return "";
    return filled(part.substr(end + 1));
  }

  bool all_known(std::string_view part) const {
    for (std::size_t open = part.find('{'); open != std::string_view::npos; open = part.find('{', open + 1)) {
      const std::string name(part.substr(open + 1, part.find_first_of(":|}", open) - open - 1));
      if (!is_known(name)) return false;
    }
    return true;
  }

  bool is_known(const std::string& name) const {
    if (name == "because") return !finding_.because.empty();
    if (name == "cameras") return !finding_.cameras.empty();
    if (name == "offset") return !of_finding(name).empty();
    return finding_.find(name) != nullptr;
  }

  std::string filled(std::string_view part) const {
    std::string text;
    for (std::size_t open = part.find('{'); open != std::string_view::npos; open = part.find('{')) {
      const std::size_t close = part.find('}', open);
      text += std::string(part.substr(0, open)) + value_of(part.substr(open + 1, close - open - 1));
      part.remove_prefix(close + 1);
    }
    return text + std::string(part);
  }

  std::string value_of(std::string_view place) const {
    const std::size_t end = place.find_first_of(":|");
    const std::string name(place.substr(0, end));
    if (const FindingValue* value = finding_.find(name)) {
      if (end == std::string_view::npos) return text_of(*value);
      return place[end] == ':' ? text_of(*value, place.substr(end + 1)) : by_number(*value, place.substr(end + 1));
    }
    return of_finding(name);
  }

  static std::string by_number(const FindingValue& value, std::string_view one_and_many) {
    const std::size_t bar = one_and_many.find('|');
    const auto* number = std::get_if<double>(&value.value);
    const bool one = number != nullptr && *number > 0.0 && *number <= 1.0;
    return std::string(one ? one_and_many.substr(0, bar) : one_and_many.substr(bar + 1));
  }

  std::string of_finding(const std::string& name) const {
    if (name == "cameras") return finding_.find("all") != nullptr ? "all cameras" : joined(finding_.cameras);
    if (name == "camera" && !finding_.cameras.empty()) return finding_.cameras.front();
    if (name == "other" && finding_.cameras.size() > 1) return finding_.cameras[1];
    if (name == "axes") return axes_words(finding_.axes);
    if (name == "stops") return stops_words(finding_.stops);
    if (name == "counts") return counts_words(finding_.because, " ");
    if (name == "listed") return counts_words(finding_.because, ": ");
    if (name == "because" && !finding_.because.empty()) return words_of(finding_.because.front()).whole();
    if (name == "each") return each_because();
    if (name == "offset") return offset_words(finding_, ", ");
    if (name == "shift") return offset_words(finding_, " and ");
    if (name == "uncertain") return uncertain_axes();
    return "?";
  }

  std::string each_because() const {
    std::vector<std::string> parts;
    for (const Finding& reason : finding_.because) parts.push_back(words_of(reason).whole());
    return joined(parts);
  }

  // "x +-1.2 cm (limit 1.0 cm), yaw +-0.60 deg (limit 0.50 deg)".
  std::string uncertain_axes() const {
    std::vector<std::string> parts;
    for (const std::string& axis : finding_.axes) {
      const bool length = axis == "x" || axis == "y" || axis == "z";
      const std::string unit = length ? "cm" : "deg", format = length ? ".1f" : ".2f";
      const FindingValue *sigma = finding_.find(axis + "_" + unit), *limit = finding_.find(axis + "_limit_" + unit);
      if (limit == nullptr) continue;
      const std::string size = sigma == nullptr ? " unknown" : " +-" + text_of(*sigma, format) + " " + unit;
      parts.push_back(spoken(axis) + size + " (limit " + text_of(*limit, format) + " " + unit + ")");
    }
    return joined(parts);
  }

  const Finding& finding_;
};

const FindingEntry* entry_of(const std::string& code) {
  const std::vector<FindingEntry>& all = all_findings();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const FindingEntry& entry) { return entry.code == code; });
  return found == all.end() ? nullptr : &*found;
}

std::string code_and_values(const Finding& finding) {
  std::vector<std::string> values;
  for (const FindingValue& value : finding.values) values.push_back(value.name + " " + text_of(value));
  return finding.code + (values.empty() ? "" : " (" + joined(values) + ")");
}

}  // namespace

Words words_of(const Finding& finding) {
  const FindingEntry* entry = entry_of(finding.code);
  if (entry == nullptr) return {code_and_values(finding), "", false};
  const std::string_view pattern = entry->words;
  const Filler filler(finding);
  const std::size_t bars = pattern.find("||");
  Words words;
  words.head = filler.fill(pattern.substr(0, bars));
  if (bars != std::string_view::npos) words.detail = filler.fill(pattern.substr(bars + 2));
  words.names_cameras = pattern.find("{camera") != std::string_view::npos;
  return words;
}

}  // namespace rigproof::words
