// Cells of tables that other programs read.
#pragma once

#include <optional>
#include <string>

namespace rigproof {

/// In quotes where it must be; line feeds become spaces, so that a row is a line.
std::string csv_cell(const std::string& text);
/// The shortest text that reads back to the same number; empty where there is none.
std::string csv_cell(const std::optional<double>& value);

}  // namespace rigproof
