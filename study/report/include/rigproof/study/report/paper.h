// The experiments of the MEMROC paper (Allegro, Terreran, Ghidoni 2024) reproduced: tables beside the published rows,
// and the figures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/study/sweep/rows.h"

namespace rigproof {

struct PaperExperiment {
  std::string name;    ///< as on the command line: table1
  std::string title;   ///< one sentence
  std::string config;  ///< of its sweep, a preset of config/
};
/// In the order of the paper: table1 (tables 1 and 2, which are one sweep), quantity, odometry, table3; then why.
const std::vector<PaperExperiment>& paper_experiments();
/// Throws Error that names the nearest.
const PaperExperiment& find_paper_experiment(const std::string& name);

/// The row of a published table that a method of ours stands beside; empty if the paper has none.
std::string published_name_of(const std::string& method);

/// A table of one condition, and remarks on it.
struct PaperTable {
  std::string title;
  std::vector<std::string> head;               ///< of the columns
  std::vector<std::vector<std::string>> rows;  ///< cells; the first one names the method
  std::vector<std::string> notes;
};

/// The tables of an experiment, from the rows of its sweep, finished or not. A mean is that of the absolute error over
/// tasks and cameras, next to the count of tasks in which the method stated for every camera all that it ever states.
///   table1: camera to robot and camera to camera, for each condition of the images, beside the published rows
///   quantity: error over the number of images
///   odometry: error over lambda, for both readings of the noise
///   table3: camera to camera against `li` as in the paper, and against the truth; the spread of each parameter
///   why: error of the authors' chain, and after each link that is replaced
std::vector<PaperTable> paper_tables(const PaperExperiment& experiment, const SweepRows& rows);

/// As people read them on a terminal, and in Markdown. Both end with a newline.
std::string format_paper_tables(const std::vector<PaperTable>& tables);
std::string paper_tables_as_markdown(const std::vector<PaperTable>& tables);

/// Writes NAME.md, NAME.csv (what the figures show, one number a line) and the figures (PNG, PDF and SVG, by
/// draw_figures()) into the folder. Returns the files. Throws Error, after the first two, where figures cannot be
/// drawn.
std::vector<std::filesystem::path> write_paper(const PaperExperiment& experiment, const SweepRows& rows,
                                               const std::filesystem::path& folder);

}  // namespace rigproof
