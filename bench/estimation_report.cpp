#include "estimation_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "inspect_canvas.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/files.h"

namespace rigproof::bench {
namespace {

using inspect_detail::Align;
using inspect_detail::Canvas;
using inspect_detail::Color;
using inspect_detail::kAccent;
using inspect_detail::kGrey;
using inspect_detail::kInk;
using inspect_detail::kMargin;
using inspect_detail::kRule;
using inspect_detail::kTitleHeight;
using Point = Eigen::Vector2d;

constexpr std::array<const char*, 6> kAxes = {"tx", "ty", "tz", "rx", "ry", "rz"};

template <typename... Args>
std::string format(const char* pattern, Args... args) {
  char text[256];
  std::snprintf(text, sizeof(text), pattern, args...);
  return text;
}

// Centimetres and degrees.
double shown(std::size_t axis, double value) { return axis < 3 ? 100.0 * value : rad_to_deg(value); }

void print_row(const char* name, const std::array<AxisSum, 6>& sums, int trials, bool bound) {
  std::printf("  %-22s", name);
  for (std::size_t axis = 0; axis < 6; ++axis)
    std::printf(" %9.5f", shown(axis, std::sqrt((bound ? sums[axis].bound2 : sums[axis].error2) / trials)));
  std::printf("\n");
}

void print_ratios(const std::array<AxisSum, 6>& sums, int trials) {
  std::printf("  %-22s", "ratio > 99 % limit");
  for (const AxisSum& sum : sums) std::printf(" %4.2f>%4.2f", sum.ratio(), sum.limit(trials, -1.0));
  std::printf("\n");
}

std::string csv_header() {
  std::string text =
      "sheet,stops,lambda,trials,solved,refused,wrong_model,nees,nees_99_half_width,ms_per_trial,worst_lower_limit";
  for (const char* group : {"robot", "pair"})
    for (const char* axis : kAxes)
      for (const char* what : {"ratio", "lower_99", "upper_99", "rmse", "bound"})
        text += std::string(",") + group + "_" + axis + "_" + what;
  return text + "\n";
}

std::string csv_row(const CellKey& key, const Cell& cell) {
  std::string text = format("%s,%d,%g,%d,%d,%d,%d", key.sheet.name.c_str(), key.stops, key.lambda, cell.trials,
                            cell.solved, cell.refused, cell.wrong_model);
  if (cell.solved == 0) return text + "\n";
  text += format(",%.3f,%.3f,%.2f,%.4f", cell.mean_nees(), cell.nees_limit(), 1e3 * cell.seconds / cell.trials,
                 cell.worst_lower_limit());
  for (const auto* group : {&cell.robot, &cell.pair}) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const AxisSum& sum = (*group)[axis];
      text +=
          format(",%.4f,%.4f,%.4f,%.4g,%.4g", sum.ratio(), sum.limit(cell.solved, -1.0), sum.limit(cell.solved, 1.0),
                 shown(axis, std::sqrt(sum.error2 / cell.solved)), shown(axis, std::sqrt(sum.bound2 / cell.solved)));
    }
  }
  return text + "\n";
}

std::string markdown_ratios(const std::array<AxisSum, 6>& sums) {
  std::string text;
  for (const AxisSum& sum : sums) text += format("%s%.2f", text.empty() ? "" : " ", sum.ratio());
  return text;
}

std::string markdown_row(const CellKey& key, const Cell& cell) {
  std::string counts = format("%d", cell.solved);
  if (cell.refused > 0) counts += format(" (%d refused)", cell.refused);
  if (cell.wrong_model > 0) counts += format(" (%d wrong model)", cell.wrong_model);
  const std::string head = format("| %d, %g | %s |", key.stops, key.lambda, counts.c_str());
  if (cell.solved == 0) return head + " | | | |\n";
  return head + format(" %.1f +- %.1f | ", cell.mean_nees(), cell.nees_limit()) + markdown_ratios(cell.robot) + " | " +
         markdown_ratios(cell.pair) + format(" | %.2f |\n", cell.worst_lower_limit());
}

// Fewer trials have limits wider than a picture.
constexpr int kMinDrawn = 100;

// Cells of one sheet with so many trials at least, by stops and lambda.
std::vector<Table> by_sheet(const Table& table, int min_trials) {
  std::vector<Table> sheets;
  for (const auto& entry : table) {
    if (entry.second.trials < min_trials) continue;
    const auto same = std::find_if(sheets.begin(), sheets.end(), [&](const Table& sheet) {
      return sheet.front().first.sheet.name == entry.first.sheet.name;
    });
    if (same == sheets.end())
      sheets.push_back({entry});
    else
      same->push_back(entry);
  }
  for (Table& sheet : sheets)
    std::sort(sheet.begin(), sheet.end(), [](const auto& a, const auto& b) {
      return std::make_pair(a.first.stops, a.first.lambda) < std::make_pair(b.first.stops, b.first.lambda);
    });
  return sheets;
}

// A plot of one sheet: a column for each cell, values between `low` and `high`.
struct Panel {
  Canvas* canvas;
  double left, top, width, height, low, high;
  std::size_t columns;

  double y(double value) const { return top + height * (high - std::clamp(value, low, high)) / (high - low); }
  double x(std::size_t column, double within) const {
    return left + width * (static_cast<double>(column) + within) / static_cast<double>(columns);
  }
  void grid(double step) const {
    for (double value = step * std::ceil(low / step - 1e-9); value < high + 1e-9; value += step) {
      canvas->line({left, y(value)}, {left + width, y(value)}, kRule, 0.7);
      canvas->text({left - 8.0, y(value) + 4.0}, inspect_detail::number(value), 8.0, kGrey, Align::kRight);
    }
  }
  void interval(double at_x, double lower, double value, double upper, const Color& color) const {
    canvas->line({at_x, y(lower)}, {at_x, y(upper)}, color.pale(0.55), 1.0);
    canvas->disc({at_x, y(value)}, 2.0, color);
  }
};

constexpr double kPanelGap = 54.0, kPanelLeft = 62.0;

// What one figure shows of every cell: `low` to `high`, a grid line every `step`.
struct Figure {
  std::string title, subtitle;
  double low, high, step, panel_height, column_width;
};

void label_columns(const Panel& panel, const Table& sheet) {
  const double below = panel.top + panel.height;
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    const CellKey& key = sheet[i].first;
    panel.canvas->text({panel.x(i, 0.5), below + 14.0}, format("%g", key.lambda), 8.0, kInk, Align::kCentre);
    if (i > 0 && sheet[i - 1].first.stops == key.stops) continue;
    panel.canvas->line({panel.x(i, 0.0), panel.top}, {panel.x(i, 0.0), below + 29.0}, kGrey, 0.8);
    panel.canvas->text({panel.x(i, 0.0) + 4.0, below + 28.0}, format("N = %d", key.stops), 8.5, kInk);
  }
  panel.canvas->text({panel.left - 8.0, below + 18.0}, "lambda", 8.0, kGrey, Align::kRight);
}

// The pictures are kept with the documentation: sixteen levels of each color are enough for smooth lines and text.
void compress(const std::filesystem::path& file) {
  constexpr int kStep = 17;
  cv::Mat picture = cv::imdecode(read_binary_file(file), cv::IMREAD_COLOR);
  cv::Mat levels(1, 256, CV_8U);
  for (int i = 0; i < 256; ++i) levels.at<std::uint8_t>(i) = static_cast<std::uint8_t>((i + kStep / 2) / kStep * kStep);
  cv::LUT(picture, levels, picture);
  std::vector<std::uint8_t> bytes;
  if (cv::imencode(".png", picture, bytes, {cv::IMWRITE_PNG_COMPRESSION, 9})) write_file_atomically(file, bytes);
}

// All sheets below each other; `draw` fills one panel.
template <typename Draw>
void draw_sheets(const std::vector<Table>& sheets, const Figure& figure, const std::filesystem::path& file,
                 const Draw& draw) {
  std::size_t columns = 20;  // room for the title
  for (const Table& sheet : sheets) columns = std::max(columns, sheet.size());
  const double width = figure.column_width * static_cast<double>(columns);
  const double pitch = figure.panel_height + kPanelGap;
  Canvas canvas(static_cast<int>(kPanelLeft + width + kMargin),
                static_cast<int>(kTitleHeight + static_cast<double>(sheets.size()) * pitch));
  inspect_detail::draw_title(&canvas, figure.title, figure.subtitle);
  double top = kTitleHeight + 14.0;
  for (const Table& sheet : sheets) {
    const double own = figure.column_width * static_cast<double>(sheet.size());
    const Panel panel{&canvas, kPanelLeft, top, own, figure.panel_height, figure.low, figure.high, sheet.size()};
    canvas.text({kPanelLeft, top - 6.0}, sheet.front().first.sheet.title, 9.0, kInk);
    panel.grid(figure.step);
    label_columns(panel, sheet);
    draw(panel, sheet);
    canvas.frame({panel.left, panel.top}, {own, panel.height}, kGrey, 1.0);
    top += pitch;
  }
  canvas.save(file);
  compress(file);
}

void draw_cell_ratios(const Panel& panel, std::size_t column, const Cell& cell) {
  for (std::size_t axis = 0; axis < 12 && cell.solved > 0; ++axis) {
    const AxisSum& sum = axis < 6 ? cell.robot[axis] : cell.pair[axis - 6];
    if (!(sum.bound2 > 0.0)) continue;
    panel.interval(panel.x(column, (static_cast<double>(axis) + 1.0) / 13.0), sum.limit(cell.solved, -1.0), sum.ratio(),
                   sum.limit(cell.solved, 1.0), inspect_detail::camera_color(axis < 6 ? 0 : 1));
  }
}

void draw_ratios(const std::vector<Table>& sheets, const std::filesystem::path& file) {
  const Figure figure{"RMSE / Cramer-Rao bound: camera to robot blue, camera to camera orange",
                      "tx ty tz rx ry rz with one-sided 99 % limits; dashed: no lower limit may lie above",
                      0.85,
                      1.3,
                      0.1,
                      88.0,
                      33.0};
  draw_sheets(sheets, figure, file, [](const Panel& panel, const Table& sheet) {
    const bool chosen = sheet.front().first.sheet.choose_model;
    const double goal = panel.y(chosen ? 1.25 : 1.15), one = panel.y(1.0), right = panel.left + panel.width;
    panel.canvas->line({panel.left, one}, {right, one}, kGrey, 1.2);
    panel.canvas->dashed({panel.left, goal}, {right, goal}, kAccent, 1.0);
    for (std::size_t i = 0; i < sheet.size(); ++i) draw_cell_ratios(panel, i, sheet[i].second);
  });
}

void draw_nees(const std::vector<Table>& sheets, const std::filesystem::path& file) {
  const Figure figure{"NEES of three cameras together: 18 where the stated covariance is true",
                      "mean with its two-sided 99 % interval; shaded: the goal (30 % where sigmas are estimated)",
                      12.0,
                      24.0,
                      2.0,
                      72.0,
                      32.0};
  draw_sheets(sheets, figure, file, [](const Panel& panel, const Table& sheet) {
    const bool estimated = sheet.front().first.sheet.estimate_sigmas;
    const double low = panel.y(estimated ? 0.7 * 18.0 : 16.5), high = panel.y(estimated ? 1.3 * 18.0 : 19.5);
    const double left = panel.left, right = panel.left + panel.width;
    panel.canvas->polygon({{left, high}, {right, high}, {right, low}, {left, low}}, inspect_detail::camera_color(2),
                          0.15);
    panel.canvas->line({left, panel.y(18.0)}, {right, panel.y(18.0)}, kGrey, 1.2);
    for (std::size_t i = 0; i < sheet.size(); ++i) {
      const Cell& cell = sheet[i].second;
      if (cell.solved == 0) continue;
      const double mean = cell.mean_nees(), half = cell.nees_limit();
      panel.interval(panel.x(i, 0.5), mean - half, mean, mean + half, kInk);
    }
  });
}

}  // namespace

void print_cell(const CellKey& key, const Cell& cell) {
  std::printf("%s, N %d, lambda %g: %d solved, %d refused", key.sheet.name.c_str(), key.stops, key.lambda, cell.solved,
              cell.refused);
  if (cell.wrong_model > 0) std::printf(", odometry model wrong in %d", cell.wrong_model);
  if (cell.solved > 0) {
    std::printf(", NEES %.2f +- %.2f, %.1f ms, worst lower limit %.2f\n", cell.mean_nees(), cell.nees_limit(),
                1e3 * cell.seconds / cell.trials, cell.worst_lower_limit());
    std::printf("  %-22s %9s %9s %9s %9s %9s %9s\n", "", "tx [cm]", "ty", "tz", "rx [deg]", "ry", "rz");
    print_row("bound, robot", cell.robot, cell.solved, true);
    print_row("measured, robot", cell.robot, cell.solved, false);
    print_ratios(cell.robot, cell.solved);
    print_row("bound, between", cell.pair, cell.solved, true);
    print_row("measured, between", cell.pair, cell.solved, false);
    print_ratios(cell.pair, cell.solved);
  } else {
    std::printf("\n");
  }
  std::fflush(stdout);
}

void write_report(const Table& table, const std::filesystem::path& folder) {
  const std::vector<Table> sheets = by_sheet(table, 1);
  std::string csv = csv_header(), markdown;
  for (const Table& sheet : sheets) {
    markdown += "### " + sheet.front().first.sheet.title + "\n\n";
    markdown +=
        "| N, lambda | trials solved | NEES (18) | RMSE / bound, camera to robot: tx ty tz rx ry rz | between cameras "
        "| "
        "largest lower 99 % limit |\n|---|---|---|---|---|---|\n";
    for (const auto& [key, cell] : sheet) {
      csv += csv_row(key, cell);
      markdown += markdown_row(key, cell);
    }
    markdown += "\n";
  }
  write_file_atomically(folder / "table.csv", csv);
  write_file_atomically(folder / "table.md", markdown);
  const std::vector<Table> drawn = by_sheet(table, kMinDrawn);
  if (drawn.empty()) return;
  draw_ratios(drawn, folder / "ratios.png");
  draw_nees(drawn, folder / "nees.png");
}

}  // namespace rigproof::bench
