// The table of all cells as text, CSV, Markdown and pictures.
#pragma once

#include <filesystem>
#include <utility>
#include <vector>

#include "estimation_cells.h"

namespace rigproof::bench {

using Table = std::vector<std::pair<CellKey, Cell>>;

/// One cell in full: bound, error, ratios with their lower limits.
void print_cell(const CellKey& key, const Cell& cell);
/// table.csv (every number; figures/plot.py draws it) and table.md (ratios, one section a sheet). Throws Error.
void write_report(const Table& table, const std::filesystem::path& folder);

}  // namespace rigproof::bench
