// The figures of the paper's experiments.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/study/sweep_rows.h"

namespace rigproof::paper {

/// Draws what belongs to the experiment of that name into the folder, PNG and PDF; returns the files. Throws Error.
std::vector<std::filesystem::path> draw_paper(const std::string& experiment, const SweepRows& rows,
                                              const std::filesystem::path& folder);

}  // namespace rigproof::paper
