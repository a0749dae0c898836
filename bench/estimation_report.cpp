#include "estimation_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "rigproof/core/conventions.h"
#include "rigproof/core/files.h"

namespace rigproof::bench {
namespace {

constexpr std::array<const char*, 6> kAxes = {"tx", "ty", "tz", "rx", "ry", "rz"};

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
      "sheet,title,ratio_goal,nees_goal_low,nees_goal_high,stops,lambda,trials,solved,refused,wrong_model,nees,"
      "nees_99_half_width,ms_per_trial,worst_lower_limit";
  for (const char* group : {"robot", "pair"})
    for (const char* axis : kAxes)
      for (const char* what : {"ratio", "lower_99", "upper_99", "rmse", "bound"})
        text += std::string(",") + group + "_" + axis + "_" + what;
  return text + "\n";
}

std::string csv_row(const CellKey& key, const Cell& cell) {
  const Sheet& sheet = key.sheet;
  std::string text = fmt::format("{},\"{}\",{:g},{:g},{:g}", sheet.name, sheet.title, sheet.choose_model ? 1.25 : 1.15,
                                 sheet.estimate_sigmas ? 0.7 * 18.0 : 16.5, sheet.estimate_sigmas ? 1.3 * 18.0 : 19.5);
  text += fmt::format(",{},{:g},{},{},{},{}", key.stops, key.lambda, cell.trials, cell.solved, cell.refused,
                      cell.wrong_model);
  if (cell.solved == 0) return text + "\n";
  text += fmt::format(",{:.3f},{:.3f},{:.2f},{:.4f}", cell.mean_nees(), cell.nees_limit(),
                      1e3 * cell.seconds / cell.trials, cell.worst_lower_limit());
  for (const auto* group : {&cell.robot, &cell.pair}) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const AxisSum& sum = (*group)[axis];
      text += fmt::format(",{:.4f},{:.4f},{:.4f},{:.4g},{:.4g}", sum.ratio(), sum.limit(cell.solved, -1.0),
                          sum.limit(cell.solved, 1.0), shown(axis, std::sqrt(sum.error2 / cell.solved)),
                          shown(axis, std::sqrt(sum.bound2 / cell.solved)));
    }
  }
  return text + "\n";
}

std::string markdown_ratios(const std::array<AxisSum, 6>& sums) {
  std::string text;
  for (const AxisSum& sum : sums) text += fmt::format("{}{:.2f}", text.empty() ? "" : " ", sum.ratio());
  return text;
}

std::string markdown_row(const CellKey& key, const Cell& cell) {
  std::string counts = fmt::format("{}", cell.solved);
  if (cell.refused > 0) counts += fmt::format(" ({} refused)", cell.refused);
  if (cell.wrong_model > 0) counts += fmt::format(" ({} wrong model)", cell.wrong_model);
  const std::string head = fmt::format("| {}, {:g} | {} |", key.stops, key.lambda, counts);
  if (cell.solved == 0) return head + " | | | |\n";
  return head + fmt::format(" {:.1f} +- {:.1f} | ", cell.mean_nees(), cell.nees_limit()) + markdown_ratios(cell.robot) +
         " | " + markdown_ratios(cell.pair) + fmt::format(" | {:.2f} |\n", cell.worst_lower_limit());
}

// Cells of one sheet, by stops and lambda.
std::vector<Table> by_sheet(const Table& table) {
  std::vector<Table> sheets;
  for (const auto& entry : table) {
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
  const std::vector<Table> sheets = by_sheet(table);
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
}

}  // namespace rigproof::bench
