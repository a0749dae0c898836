#include "rigproof/validate/text_table.h"

#include <algorithm>

namespace rigproof {
namespace {

const std::string& gap_before(std::size_t column, const std::vector<std::string>& gaps) {
  return gaps[std::min(column, gaps.size() - 1)];
}

}  // namespace

std::size_t TextTable::width(std::size_t column) const {
  std::size_t widest = 0;
  for (const std::vector<std::string>& row : rows_)
    if (column < row.size()) widest = std::max(widest, row[column].size());
  return widest;
}

std::size_t TextTable::column_start(std::size_t column, const std::vector<std::string>& gaps) const {
  std::size_t start = gap_before(column, gaps).size();
  for (std::size_t i = 0; i < column; ++i) start += gap_before(i, gaps).size() + width(i);
  return start;
}

std::string TextTable::text(const std::vector<std::string>& gaps) const {
  std::string text;
  for (const std::vector<std::string>& row : rows_) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string padding(width(i) - row[i].size(), ' ');
      const bool left = std::find(left_aligned_.begin(), left_aligned_.end(), i) != left_aligned_.end();
      line += gap_before(i, gaps) + (left ? row[i] + padding : padding + row[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

}  // namespace rigproof
