#include "csv.h"

#include <algorithm>
#include <utility>

#include "rigproof/core/text.h"

namespace rigproof {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && space(text.front())) text.remove_prefix(1);
  while (!text.empty() && space(text.back())) text.remove_suffix(1);
  return text;
}

// What a line has in the place of commas, or nothing. Beside semicolons commas are those of decimals.
std::string other_separator(const std::vector<std::string_view>& fields, std::size_t required) {
  const auto semicolons = [](std::string_view field) { return field.find(';') != std::string_view::npos; };
  if (fields.size() >= required && std::none_of(fields.begin(), fields.end(), semicolons)) return "";
  for (const auto& [separator, name] : {std::make_pair(';', "semicolons"), {'\t', "tabs"}, {' ', "spaces"}}) {
    std::size_t columns = fields.size();
    for (const std::string_view field : fields)
      columns += static_cast<std::size_t>(std::count(field.begin(), field.end(), separator));
    if (columns >= required) return name;
  }
  return "";
}

}  // namespace

bool is_binary(std::string_view text) { return text.find('\0') != std::string_view::npos; }

bool CsvLines::next(std::vector<std::string_view>* fields) {
  fields->clear();
  while (!rest_.empty()) {
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view text = trimmed(rest_.substr(0, end));
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    // A byte order mark is what some spreadsheets put first.
    if (++line_ == 1 && text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    if (text.empty() || text.front() == '#') continue;
    for (std::size_t comma = text.find(','); comma != std::string_view::npos; comma = text.find(',')) {
      fields->push_back(trimmed(text.substr(0, comma)));
      text.remove_prefix(comma + 1);
    }
    fields->push_back(trimmed(text));
    return true;
  }
  return false;
}

bool CsvColumns::read_header(const std::vector<std::string_view>& fields, const std::vector<std::string>& wanted,
                             std::size_t required, const std::string& file, int line, Problems* problems) {
  place_.assign(wanted.size(), -1);
  if (const std::string other = other_separator(fields, required); !other.empty()) {
    problems->add({file, line, "", for_message(fields[0]),
                   "the columns are separated by " + other + "; commas are needed, and points in decimals"});
    return true;
  }
  const bool is_header = !fields.empty() && !fields[0].empty() &&
                         std::isalpha(static_cast<unsigned char>(fields[0][0])) && fields[0] != "nan" &&
                         fields[0] != "inf" && fields[0] != "NaN";
  if (!is_header) {
    for (std::size_t i = 0; i < wanted.size() && i < std::max(required, fields.size()); ++i)
      place_[i] = static_cast<int>(i);
    needed_ = required;
    columns_ = wanted.size();
    return false;
  }
  named_ = true;
  columns_ = fields.size();
  const std::vector<std::string> names(fields.begin(), fields.end());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto found = std::find(names.begin(), names.end(), wanted[i]);
    if (found != names.end()) place_[i] = static_cast<int>(found - names.begin());
    if (found == names.end() && i < required) {
      const auto nearest = nearest_name(wanted[i], names);
      problems->add({file, line, wanted[i], "",
                     "the column is missing" + (nearest ? "; is \"" + for_message(*nearest) + "\" meant?" : ";") +
                         " Columns: " + for_message(joined(names))});
    }
    needed_ = std::max(needed_, static_cast<std::size_t>(place_[i] + 1));
  }
  return true;
}

std::string CsvColumns::surplus(const std::vector<std::string_view>& fields) const {
  std::size_t count = fields.size();
  while (count > 0 && fields[count - 1].empty()) --count;
  if (count <= columns_) return "";
  return "has " + std::to_string(count) + " columns; " +
         (named_ ? "the first line names " : "without a first line that names them there may be ") +
         std::to_string(columns_) + ", and decimals need points, not commas";
}

std::string_view CsvColumns::get(const std::vector<std::string_view>& fields, std::size_t column) const {
  if (!has(column) || static_cast<std::size_t>(place_[column]) >= fields.size()) return {};
  return fields[static_cast<std::size_t>(place_[column])];
}

void LimitedProblems::add(int line, const std::string& field, std::string_view value, const std::string& message) {
  if (++count_ <= kMost) kept_.add({file_, line, field, for_message(value), message});
}

void LimitedProblems::move_to(Problems* problems) {
  problems->append(kept_);
  if (count_ > kMost)
    problems->add({file_, 0, "", "", "and " + std::to_string(count_ - kMost) + " more problems of this file"});
}

}  // namespace rigproof
