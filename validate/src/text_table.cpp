#include "rigproof/validate/text_table.h"

#include <algorithm>

namespace rigproof {
namespace {

const std::string& gap_before(std::size_t column, const std::vector<std::string>& gaps) {
  return gaps[std::min(column, gaps.size() - 1)];
}

}  // namespace

std::vector<std::size_t> TextTable::widths() const {
  std::vector<std::size_t> widest;
  for (const std::vector<std::string>& row : rows_) {
    widest.resize(std::max(widest.size(), row.size()), 0);
    for (std::size_t i = 0; i < row.size(); ++i) widest[i] = std::max(widest[i], row[i].size());
  }
  return widest;
}

std::string TextTable::text_below(std::string title, const std::vector<std::pair<std::size_t, std::string>>& words,
                                  const std::vector<std::string>& gaps) const {
  std::vector<std::size_t> width = widths();
  for (const auto& [column, word] : words) {
    width.resize(std::max(width.size(), column), 0);
    std::size_t start = gap_before(column, gaps).size();
    for (std::size_t i = 0; i < column; ++i) start += gap_before(i, gaps).size() + width[i];
    title += std::string(title.size() + 2 < start ? start - title.size() : 2, ' ') + word;
  }
  return title + "\n" + text(gaps);
}

std::string TextTable::text(const std::vector<std::string>& gaps) const {
  const std::vector<std::size_t> width = widths();
  std::string text;
  for (const std::vector<std::string>& row : rows_) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string padding(width[i] - row[i].size(), ' ');
      const bool left = std::find(left_aligned_.begin(), left_aligned_.end(), i) != left_aligned_.end();
      line += gap_before(i, gaps) + (left ? row[i] + padding : padding + row[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

}  // namespace rigproof
