// Comma-separated numbers with problems that name file and line. Made for large files: nothing is copied.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "rigproof/core/error.h"

namespace rigproof {

/// Walks the lines of a text; comments (#) and empty lines are skipped.
class CsvLines {
 public:
  explicit CsvLines(std::string_view text) : rest_(text) {}
  /// The next line split at its commas, each field trimmed; false at the end.
  bool next(std::vector<std::string_view>* fields);
  int line() const { return line_; }

 private:
  std::string_view rest_;
  int line_ = 0;
};

/// Where the columns that a reader wants stand in a file.
class CsvColumns {
 public:
  /// If the first field is no number it is a header: the columns are found by name. Otherwise they are `wanted`'s, in
  /// order. Returns true if the fields were a header, or nothing below can be read for want of commas.
  bool read_header(const std::vector<std::string_view>& fields, const std::vector<std::string>& wanted,
                   std::size_t required, const std::string& file, int line, Problems* problems);
  /// Field of the column, or an empty view.
  std::string_view get(const std::vector<std::string_view>& fields, std::size_t column) const;
  bool has(std::size_t column) const { return column < place_.size() && place_[column] >= 0; }
  std::size_t fields_needed() const { return needed_; }
  /// Why a row with more fields than there are columns cannot be read, or nothing: decimal commas split numbers, and
  /// the columns of a row without a header are guessed if they are not the wanted ones. Empty fields at its end are
  /// none.
  std::string surplus(const std::vector<std::string_view>& fields) const;

 private:
  std::vector<int> place_;
  std::size_t needed_ = 0;
  std::size_t columns_ = 0;
  bool named_ = false;
};

/// True for what no text editor wrote: a picture in the place of a table.
bool is_binary(std::string_view text);

/// Adds at most a bounded number of problems of one file and then says how many more there are.
class LimitedProblems {
 public:
  explicit LimitedProblems(std::string file) : file_(std::move(file)) {}
  void add(int line, const std::string& field, std::string_view value, const std::string& message);
  void move_to(Problems* problems);

 private:
  static constexpr std::size_t kMost = 20;
  std::string file_;
  Problems kept_;
  std::size_t count_ = 0;
};

}  // namespace rigproof
