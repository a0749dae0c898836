#include "rigproof/study/sweep/table_text.h"

#include "rigproof/core/text.h"

namespace rigproof {

std::string csv_cell(const std::string& text) {
  std::string cell;
  bool quoted = false;
  for (const char c : text) {
    quoted = quoted || c == ',' || c == '"';
    if (c == '"') cell += '"';
    cell += c == '\n' || c == '\r' ? ' ' : c;
  }
  return quoted ? "\"" + cell + "\"" : cell;
}

std::string csv_cell(const std::optional<double>& value) { return value ? number_text(*value) : std::string(); }

}  // namespace rigproof
