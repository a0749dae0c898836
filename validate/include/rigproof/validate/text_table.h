// Text in aligned columns.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace rigproof {

/// Rows of cells; every column is as wide as its widest cell. A row may be shorter than others.
class TextTable {
 public:
  /// Columns are aligned to the right unless they are named here.
  explicit TextTable(std::vector<std::size_t> left_aligned) : left_aligned_(std::move(left_aligned)) {}
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// `gaps[i]` stands before column i; the last gap is repeated. No line ends in spaces.
  std::string text(const std::vector<std::string>& gaps) const;
  /// The same below a line of a title and words, each over the beginning of its column or as near as there is room.
  std::string text_below(std::string title, const std::vector<std::pair<std::size_t, std::string>>& words,
                         const std::vector<std::string>& gaps) const;

 private:
  std::vector<std::size_t> widths() const;
  std::vector<std::size_t> left_aligned_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace rigproof
