// What the figures of the paper's experiments show, one number a line, for figures/plot.py and whatever else reads CSV.
#pragma once

#include <optional>
#include <string>

#include "rigproof/study/sweep/rows.h"

namespace rigproof::paper {

/// A line of the table, whose columns paper_csv() tells.
struct CsvLine {
  std::string figure, panel, quantity, unit, method, source = "measured", task, camera;
  std::optional<double> x;
  std::string x_title;
  double error = 0.0;
};
/// With its line feed.
std::string text_of(const CsvLine& line);

/// Columns:
///   figure    dots | curves | repeatability | waterfall: what the line is for; of dots and curves success, too
///   panel     "camera to robot, images clean"
///   quantity  tx ty tz roll pitch yaw, or translation and rotation (lengths, of curves), or tasks
///   unit      cm | deg | successes
///   method, source, task, camera; source is measured, published, far (more than 1 m or 20 deg off: no mean has it),
///             few_motions (of a camera shown apart), or of a waterfall mean | change | low | high
///   x, x_title  place on the axis: level of the sweep, or number of the run; of success how many tasks there were
///   error     estimate minus truth; published is the mean of its absolute value; of success in how many tasks it was
std::string paper_csv(const std::string& experiment, const SweepRows& rows);

}  // namespace rigproof::paper
