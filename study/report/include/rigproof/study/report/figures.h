// Figures for papers: a script that ships with the program, figures/plot.py, draws them from CSV files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rigproof {

/// Runs the script, with python3 and matplotlib.
/// @param kind what the CSV is about: "paper", "noise" or "estimation"
/// @param options further ones of the script: `--title`, `--formats`
/// @return the files drawn, beside the CSV
/// Throws Error where Python or matplotlib is missing, with what to install and how to draw the CSV, which stays,
/// later.
std::vector<std::filesystem::path> draw_figures(const std::string& kind, const std::filesystem::path& csv,
                                                const std::vector<std::string>& options = {});

}  // namespace rigproof
