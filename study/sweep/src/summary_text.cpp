// The summary as a person reads it, and as programs do.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "rigproof/core/figures.h"
#include "rigproof/core/text.h"
#include "rigproof/study/sweep/rows.h"
#include "rigproof/study/sweep/table_text.h"
#include "rigproof/validate/text_table.h"
#include "rigproof/words/sentences.h"

namespace rigproof {
namespace {

using nlohmann::ordered_json;

constexpr double kSignificant = 0.05;
constexpr std::size_t kShownFailures = 12, kShownReason = 300;

// Calls back with every column behind the axes, by name: texts, counts, then figures.
template <typename Text, typename Number>
void visit_columns(const SummaryRow& row, const Text& text, const Number& number) {
  text("method", row.method);
  text("subject", sweep_subject_name(row.subject));
  text("axis", summary_axis_name(row.axis));
  text("unit", summary_axis_unit(row.axis));
  number("success_rate", row.success_rate);
  const std::pair<const char*, int> counts[] = {{"tasks", row.tasks},
                                                {"answered", row.answered},
                                                {"far", row.far},
                                                {"solved", row.solved},
                                                {"partial", row.partial},
                                                {"refused", row.refused},
                                                {"could_not_run", row.could_not_run},
                                                {"failed", row.failed},
                                                {"missing", row.missing}};
  for (const auto& [name, count] : counts) number(name, static_cast<double>(count));
  const auto sample = [&number](const std::string& prefix, const SampleFigures& figures) {
    static const std::array<const char*, 5> quantiles = {"q05", "q25", "median", "q75", "q95"};
    number(prefix + "n", static_cast<double>(figures.count));
    number(prefix + "mean_abs", figures.mean_absolute);
    number(prefix + "std_abs", figures.deviation_absolute);
    number(prefix + "mean", figures.mean);
    number(prefix + "std", figures.deviation);
    for (std::size_t i = 0; i < quantiles.size(); ++i) number(prefix + quantiles[i], figures.quantiles[i]);
    number(prefix + "max", figures.largest);
    number(prefix + "rmse", figures.rmse);
    number(prefix + "rmse_over_bound", figures.rmse_over_bound);
  };
  sample("", row.all);
  sample("common_", row.common);
  const PairedTest& test = row.against_reference;
  number("pair_n", static_cast<double>(test.count));
  number("pair_difference", test.difference);
  number("pair_low", test.interval_low);
  number("pair_high", test.interval_high);
  number("pair_p", test.p);
  number("pair_p_holm", test.p_holm);
}

using Optional = std::optional<double>;

// Of the tasks that have a result: what is not run yet has not failed.
std::string success_of(const SummaryRow& row) {
  const int run = row.tasks - row.missing;
  return run == 0 ? "-" : std::to_string(row.answered) + "/" + std::to_string(run);
}

// The cell of one axis: mean |error|, and whether the reference is significantly better or worse.
std::string cell_of(const SummaryRow& row) {
  if (!row.all.mean_absolute) return "-";
  const double value = *row.all.mean_absolute;
  const PairedTest& test = row.against_reference;
  const bool differs = test.p_holm && *test.p_holm < kSignificant && test.difference;
  return figure(value, decimals_for(value, 2)) + (differs ? (*test.difference > 0.0 ? "*" : "!") : "");
}

/// A line of the printed table: one method at one point, cameras or pairs.
struct Line {
  std::vector<std::string> levels;
  std::string method;
  SweepSubject subject = SweepSubject::kCamera;
  std::array<const SummaryRow*, 6> axes{};
  int answered = 0;  ///< of the axis that is answered most
};

std::vector<Line> lines_of(const SweepSummary& summary) {
  std::vector<Line> lines;
  for (const SummaryRow& row : summary.rows) {
    const auto axis = static_cast<std::size_t>(row.axis);
    if (axis >= 6) continue;
    const auto same = [&row](const Line& line) {
      return line.levels == row.levels && line.method == row.method && line.subject == row.subject;
    };
    // Rows of one point and subject stand together.
    const std::size_t near = 2 * summary.methods.size();
    const auto begin = lines.end() - static_cast<std::ptrdiff_t>(std::min(lines.size(), near));
    auto line = std::find_if(begin, lines.end(), same);
    if (line == lines.end()) {
      lines.push_back({row.levels, row.method, row.subject, {}, 0});
      line = std::prev(lines.end());
    }
    line->axes[axis] = &row;
    line->answered = std::max(line->answered, row.answered);
  }
  return lines;
}

// Of the axes that the method gives at all, of some camera, the one that it gives least often of all of them.
const SummaryRow& rarest_axis(const Line& line) {
  const auto is_given = [](const SummaryRow& row) { return row.all.count + row.far > 0; };
  const SummaryRow* rarest = line.axes.front();
  for (const SummaryRow* row : line.axes)
    if (is_given(*row) && (!is_given(*rarest) || row->answered < rarest->answered)) rarest = row;
  return *rarest;
}

std::vector<std::string> heading(const SweepSummary& summary) {
  std::vector<std::string> cells;
  for (const std::string& axis : summary.axes) cells.push_back(axis);
  for (const char* name : {"method", "success", "tx cm", "ty", "tz", "rx deg", "ry", "rz"}) cells.emplace_back(name);
  return cells;
}

std::vector<std::string> cells_of(const Line& line) {
  std::vector<std::string> cells = line.levels;
  cells.push_back(line.method);
  cells.push_back(success_of(rarest_axis(line)));
  for (const SummaryRow* row : line.axes) cells.push_back(cell_of(*row));
  return cells;
}

std::vector<std::vector<std::string>> table_of(const SweepSummary& summary, const std::vector<Line>& lines,
                                               SweepSubject subject) {
  std::vector<std::vector<std::string>> table = {heading(summary)};
  for (const Line& line : lines)
    if (line.subject == subject) table.push_back(cells_of(line));
  return table;
}

std::string aligned_text(const std::vector<std::vector<std::string>>& table) {
  std::vector<std::size_t> all(table.front().size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  TextTable columns(all);
  for (const auto& row : table) columns.add(row);
  return columns.text({" ", "  "});
}

std::string markdown_text(const std::vector<std::vector<std::string>>& table) {
  std::string text;
  for (std::size_t i = 0; i < table.size(); ++i) {
    text += "| " + joined(table[i], " | ") + " |\n";
    if (i > 0) continue;
    text += "|";
    for (std::size_t k = 0; k < table[i].size(); ++k) text += "---|";
    text += "\n";
  }
  return text;
}

bool has_answers(const std::vector<Line>& lines, SweepSubject subject) {
  return std::any_of(lines.begin(), lines.end(),
                     [subject](const Line& line) { return line.subject == subject && line.answered > 0; });
}

std::vector<std::string> failure_lines(const SweepSummary& summary) {
  std::vector<std::string> lines;
  for (const FailureCount& failure : summary.failures) {
    if (lines.size() == kShownFailures) {
      lines.push_back(std::to_string(summary.failures.size() - kShownFailures) + " more kinds in rows.csv");
      break;
    }
    const std::string lead = failure.tasks > 1 ? ", for example: " : ": ";
    lines.push_back(std::to_string(failure.tasks) + " x " + failure.method + " " + sweep_status_name(failure.status) +
                    (failure.reasons.empty() ? "" : lead + for_message(words::text_of(failure.reasons), kShownReason)));
  }
  return lines;
}

// A method's cameras (or pairs) that are far off, at any point: every axis of theirs is, so that the most is all.
std::map<std::string, int> far_by_method(const std::vector<Line>& lines, SweepSubject subject) {
  std::map<std::string, int> far;
  for (const Line& line : lines) {
    if (line.subject != subject) continue;
    int most = 0;
    for (const SummaryRow* row : line.axes) most = std::max(most, row->far);
    if (most > 0) far[line.method] += most;
  }
  return far;
}

std::string far_line(const SweepSummary& summary, const std::vector<Line>& lines) {
  std::vector<std::string> counts;
  for (const auto& [subject, noun] :
       {std::pair(SweepSubject::kCamera, std::string("camera")), std::pair(SweepSubject::kPair, std::string("pair"))}) {
    const std::map<std::string, int> far = far_by_method(lines, subject);
    for (const std::string& method : summary.methods)
      if (const auto count = far.find(method); count != far.end())
        counts.push_back(method + " " + std::to_string(count->second) + " " + noun + (count->second == 1 ? "" : "s"));
  }
  return counts.empty()
             ? std::string()
             : "More than " + far_limits_in_words() + " off, counted as no answer: " + joined(counts, ", ") + ".\n";
}

std::string unfinished_line(const SweepSummary& summary) {
  const bool is_unfinished =
      std::any_of(summary.rows.begin(), summary.rows.end(), [](const SummaryRow& row) { return row.missing > 0; });
  return is_unfinished ? "Not everything is run: success is of the tasks that are, - where none is.\n" : "";
}

std::string legend(const SweepSummary& summary) {
  return "success: tasks in which every camera has every axis that the method gives at all, none more than " +
         far_limits_in_words() + " off;\nthen mean |error| of answers within that.\n" + unfinished_line(summary) +
         (summary.methods.size() < 2
              ? std::string()
              : "* significantly worse than " + summary.reference + ", ! better (paired Wilcoxon test, Holm, 5 %).\n");
}

std::string titled(SweepSubject subject) {
  return subject == SweepSubject::kCamera ? "Camera to robot" : "Camera to camera";
}

}  // namespace

std::string format_summary(const SweepSummary& summary) {
  const std::vector<Line> lines = lines_of(summary);
  std::string text;
  for (const SweepSubject subject : {SweepSubject::kCamera, SweepSubject::kPair}) {
    if (subject == SweepSubject::kPair && !has_answers(lines, subject)) continue;
    text += titled(subject) + "\n" + aligned_text(table_of(summary, lines, subject));
  }
  text += legend(summary) + far_line(summary, lines);
  const std::vector<std::string> failures = failure_lines(summary);
  if (!failures.empty()) text += "Not solved:\n";
  for (const std::string& line : failures) text += " " + line + "\n";
  return text;
}

std::string summary_as_markdown(const SweepSummary& summary) {
  const std::vector<Line> lines = lines_of(summary);
  std::string text = "# " + summary.name + "\n";
  for (const SweepSubject subject : {SweepSubject::kCamera, SweepSubject::kPair})
    text += "\n## " + titled(subject) + "\n\n" + markdown_text(table_of(summary, lines, subject));
  text += "\n" + legend(summary) + far_line(summary, lines);
  const std::vector<std::string> failures = failure_lines(summary);
  if (!failures.empty()) text += "\n## Not solved\n\n";
  for (const std::string& line : failures) text += "- " + line + "\n";
  return text;
}

std::string summary_as_csv(const SweepSummary& summary) {
  std::string text;
  for (const std::string& axis : summary.axes) text += csv_cell(axis) + ",";
  const auto end_line = [&text] {
    text.pop_back();
    text += "\n";
  };
  visit_columns(
      SummaryRow(), [&text](const std::string& name, const std::string&) { text += name + ","; },
      [&text](const std::string& name, const Optional&) { text += name + ","; });
  end_line();
  for (const SummaryRow& row : summary.rows) {
    for (const std::string& level : row.levels) text += csv_cell(level) + ",";
    visit_columns(
        row, [&text](const std::string&, const std::string& value) { text += csv_cell(value) + ","; },
        [&text](const std::string&, const Optional& value) { text += csv_cell(value) + ","; });
    end_line();
  }
  return text;
}

std::string summary_as_json(const SweepSummary& summary) {
  ordered_json rows = ordered_json::array();
  for (const SummaryRow& row : summary.rows) {
    ordered_json object;
    object["levels"] = ordered_json::object();
    for (std::size_t i = 0; i < row.levels.size(); ++i) object["levels"][summary.axes[i]] = row.levels[i];
    visit_columns(
        row, [&object](const std::string& name, const std::string& value) { object[name] = value; },
        [&object](const std::string& name, const Optional& value) {
          object[name] = value ? ordered_json(*value) : ordered_json(nullptr);
        });
    rows.push_back(std::move(object));
  }
  ordered_json failures = ordered_json::array();
  for (const FailureCount& failure : summary.failures)
    failures.push_back({{"method", failure.method},
                        {"status", sweep_status_name(failure.status)},
                        {"code", code_of(failure.reasons)},
                        {"reason", words::text_of(failure.reasons)},
                        {"tasks", failure.tasks}});
  const ordered_json object = {{"name", summary.name},           {"axes", summary.axes}, {"methods", summary.methods},
                               {"reference", summary.reference}, {"rows", rows},         {"failures", failures}};
  return object.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace rigproof
