// Text in aligned columns.
#pragma once

#include <string>
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
  /// Position at which column i begins.
  std::size_t column_start(std::size_t column, const std::vector<std::string>& gaps) const;

 private:
  std::size_t width(std::size_t column) const;
  std::vector<std::size_t> left_aligned_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace rigproof
