// Charts of a figure: axes with ticks, lines with bands, and dots by name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "figure.h"

namespace rigproof::inspect_detail {

/// From numbers to places in a rectangle of the figure.
struct ChartAxes {
  double left = 0.0, top = 0.0, width = 1.0, height = 1.0;
  double x_low = 0.0, x_high = 1.0, y_low = 0.0, y_high = 1.0;
  bool x_log = false, y_log = false;

  Eigen::Vector2d at(double x, double y) const;
};

/// Round places between the ends of an axis, both included where they are round.
std::vector<double> ticks(double low, double high, bool log);
/// The least decades (or, if they span less than one, 1-2-5 steps) that hold all of the values; only positive ones
/// count.
void decades_around(const std::vector<double>& values, double* low, double* high);

struct ChartLabels {
  std::string title, x, y;
  bool y_numbers = true;  ///< beside the ticks; false where names stand there
};
/// Frame, grid, ticks and labels.
void draw_axes(const ChartAxes& axes, const ChartLabels& labels, Figure* figure);

/// A line with a band of its deviation; points without a value interrupt it.
struct Series {
  std::string name;
  Color color;
  bool hollow = false;  ///< thin line with rings: tells it from the series of the same color
  std::vector<double> x;
  std::vector<std::optional<double>> y, low, high;
};
void draw_series(const ChartAxes& axes, const Series& series, Figure* figure);
/// Colored discs with names, in a row from `at` to the right, wrapped at the figure's right margin.
void draw_legend(const std::vector<Series>& series, const Eigen::Vector2d& at, Figure* figure);

}  // namespace rigproof::inspect_detail
