#include "paper_csv.h"

#include <algorithm>

#include "paper_samples.h"
#include "paper_table3.h"
#include "paper_why.h"
#include "rigproof/study/sweep/table_text.h"

namespace rigproof::paper {
namespace {

constexpr const char* kHeader = "figure,panel,quantity,unit,method,source,task,camera,x,x_title,error\n";

std::string panel_name(SweepSubject subject, const std::string& condition) {
  return subject_title(subject) + (condition.empty() ? "" : ", " + condition);
}

CsvLine line_of(const std::string& figure, const std::string& panel, const SweepRow& row) {
  CsvLine line;
  line.figure = figure;
  line.panel = panel;
  line.method = row.method;
  line.task = row.task;
  line.camera = row.camera;
  if (is_far(row)) line.source = "far";
  return line;
}

// In how many of its tasks a method succeeded, with x for all.
std::string success_line(const std::string& panel, const std::string& method, const Sample& sample) {
  if (sample.answers == 0) return "";
  CsvLine line;
  line.figure = "success";
  line.panel = panel;
  line.quantity = "tasks";
  line.unit = "successes";
  line.method = method;
  line.x = sample.tasks;
  line.error = sample.success;
  return text_of(line);
}

// The six errors of a row that it gives.
std::string axis_lines(CsvLine line, const AxisFigures& errors) {
  std::string text;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!errors[i]) continue;
    line.quantity = kPaperAxes[i];
    line.unit = i < 3 ? "cm" : "deg";
    line.error = *errors[i];
    text += text_of(line);
  }
  return text;
}

// Rows of a condition, in the order of methods, which gives them their colours.
template <typename Visit>
void for_each_row(const SweepRows& rows, const Condition& condition, SweepSubject subject, const Visit& visit) {
  for (const std::string& method : rows.methods)
    for (const SweepRow& row : rows.rows)
      if (row.method == method && row.subject == subject && meets(row, condition)) visit(row);
}

std::string dots(const SweepRows& rows, const Condition& condition, SweepSubject subject, bool synthetic,
                 const std::string& panel) {
  std::string text;
  for_each_row(rows, condition, subject,
               [&](const SweepRow& row) { text += axis_lines(line_of("dots", panel, row), paper_error(row)); });
  for (const std::string& method : rows.methods) {
    text += success_line(panel, method, sample_of(rows, condition, method, subject));
    const PublishedRow* theirs = published_row(published_table(subject, synthetic), method);
    if (theirs == nullptr) continue;
    CsvLine line;
    line.figure = "dots";
    line.panel = panel;
    line.method = method;
    line.source = "published";
    text += axis_lines(line, theirs->error);
  }
  return text;
}

std::string curves(const SweepRows& rows, const std::string& along, const std::string& across) {
  const std::size_t axis = axis_of(rows, along).value();
  std::string text;
  for (const auto& [label, condition] : conditions_along(rows, across))
    for (const SweepSubject subject : {SweepSubject::kCamera, SweepSubject::kPair})
      for_each_row(rows, condition, subject, [&, name = panel_name(subject, label)](const SweepRow& row) {
        CsvLine line = line_of("curves", name, row);
        const auto level = std::find(rows.levels[axis].begin(), rows.levels[axis].end(), row.levels[axis]);
        line.x = rows.level_values[axis].at(static_cast<std::size_t>(level - rows.levels[axis].begin()));
        line.x_title = rows.axis_titles[axis];
        for (const bool rotation : {false, true}) {
          const std::optional<double> length = length_of(paper_error(row), rotation ? 3 : 0);
          if (!length) continue;
          line.quantity = rotation ? "rotation" : "translation";
          line.unit = rotation ? "deg" : "cm";
          line.error = *length;
          text += text_of(line);
        }
      });
  return text;
}

std::string repeatability(const SweepRows& rows) {
  const std::size_t world = axis_of(rows, "world").value();
  std::string text;
  for_each_row(rows, {}, SweepSubject::kCamera, [&](const SweepRow& row) {
    CsvLine line = line_of("repeatability", panel_name(SweepSubject::kCamera, ""), row);
    const auto level = std::find(rows.levels[world].begin(), rows.levels[world].end(), row.levels[world]);
    line.x = static_cast<double>(level - rows.levels[world].begin() + 1);
    line.x_title = "run";
    if (line.source == "measured" && has_few_motions(row)) line.source = "few_motions";
    text += axis_lines(line, paper_error(row));
  });
  return text;
}

}  // namespace

std::string text_of(const CsvLine& line) {
  std::string text;
  for (const std::string* cell :
       {&line.figure, &line.panel, &line.quantity, &line.unit, &line.method, &line.source, &line.task, &line.camera})
    text += csv_cell(*cell) + ",";
  return text + csv_cell(line.x) + "," + csv_cell(line.x_title) + "," + csv_cell(std::optional<double>(line.error)) +
         "\n";
}

std::string paper_csv(const std::string& experiment, const SweepRows& rows) {
  std::string text = kHeader;
  if (experiment == "quantity") return text + curves(rows, "stops", "");
  if (experiment == "odometry") return text + curves(rows, "lambda", "model");
  if (experiment == "why") return text + why_csv(rows);
  if (experiment == "table3") {
    const SweepRows against_li = against_method(rows, "li");
    const std::string panel = "camera to camera, against li as in the paper";
    text += dots(against_li, {}, SweepSubject::kPair, false, panel);
    if (std::any_of(rows.rows.begin(), rows.rows.end(), has_few_motions))
      text += dots(only(against_li, SweepSubject::kPair, false), {}, SweepSubject::kPair, false,
                   panel + ", without cameras of " + few_motions_in_words());
    return text + dots(rows, {}, SweepSubject::kPair, false, "camera to camera, against the truth") +
           repeatability(rows);
  }
  for (const auto& [label, condition] : conditions_along(rows, "images"))
    for (const SweepSubject subject : {SweepSubject::kCamera, SweepSubject::kPair})
      text += dots(rows, condition, subject, true, panel_name(subject, label.empty() ? "" : "images " + label));
  return text;
}

}  // namespace rigproof::paper
