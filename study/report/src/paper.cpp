#include "rigproof/study/report/paper.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "paper_csv.h"
#include "paper_samples.h"
#include "paper_why.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/study/report/figures.h"
#include "rigproof/validate/figures.h"
#include "rigproof/validate/published.h"
#include "rigproof/validate/text_table.h"

namespace rigproof {
namespace {

using namespace paper;

constexpr const char* kConditionAxis = "images";
constexpr double kSignificant = 0.05;

std::string cell(const std::optional<double>& value) {
  return value ? figure(*value, std::max(2, decimals_for(*value, 2))) : "-";
}

std::string count_cell(const Sample& sample) {
  return std::to_string(sample.answered) + "/" + std::to_string(sample.tasks);
}

// Published numbers have two decimals.
bool above(double ours, double published) { return std::round(100.0 * ours) > std::round(100.0 * published); }

// The most frequent reason why a method gave nothing.
std::string why_nothing(const SweepRows& rows, const Condition& condition, const std::string& method) {
  std::vector<SweepRow> unsolved;
  for (const SweepRow& row : rows.rows)
    if (row.method == method && meets(row, condition) && !row.reason.empty()) unsolved.push_back(row);
  const std::vector<FailureCount> failures = count_failures(unsolved);
  return failures.empty() ? std::string() : ": " + failures.front().reason;
}

// Methods without a single figure are named below the table, not in it.
std::vector<std::string> methods_with_figures(const SweepRows& rows, const Condition& condition, SweepSubject subject,
                                              PaperTable* table) {
  std::vector<std::string> methods;
  for (const std::string& method : rows.methods) {
    const Sample sample = sample_of(rows, condition, method, subject);
    if (sample.states_anything())
      methods.push_back(method);
    else if (sample.tasks > 0)
      table->notes.push_back(method + " says nothing about " + subject_title(subject) +
                             why_nothing(rows, condition, method));
  }
  return methods;
}

void add_method(const std::string& method, const Sample& sample, const PublishedTable& published, PaperTable* table,
                std::string* above_published) {
  const PublishedRow* row = published_row(published, method);
  std::vector<std::string> cells = {method, count_cell(sample)}, theirs;
  if (row != nullptr) theirs = {"  published " + row->method, ""};
  std::string axes;
  for (std::size_t i = 0; i < 6; ++i) {
    const std::optional<double> ours = sample.mean_absolute(i);
    cells.push_back(cell(ours));
    if (row == nullptr) continue;
    theirs.push_back(row->error[i] ? figure(*row->error[i], 2) : "-");
    if (ours && row->error[i] && above(*ours, *row->error[i])) axes += std::string(" ") + kPaperAxes[i];
  }
  table->rows.push_back(cells);
  if (row != nullptr) table->rows.push_back(theirs);
  if (!axes.empty()) *above_published += (above_published->empty() ? "" : "; ") + method + axes;
}

std::vector<std::string> head_of_axes(const char* what, const char* count) {
  std::vector<std::string> head = {what, count};
  for (std::size_t i = 0; i < 6; ++i)
    head.push_back(kPaperAxes[i] + std::string(i == 2 ? " [cm]" : i == 5 ? " [deg]" : ""));
  return head;
}

PaperTable error_table(const SweepRows& rows, const Condition& condition, SweepSubject subject, bool synthetic,
                       const std::string& title) {
  PaperTable table;
  table.title = title;
  table.head = head_of_axes("mean |error|", "answered");
  std::string above_published;
  for (const std::string& method : methods_with_figures(rows, condition, subject, &table))
    add_method(method, sample_of(rows, condition, method, subject), published_table(subject, synthetic), &table,
               &above_published);
  table.notes.insert(table.notes.begin(), above_published.empty() ? "no mean is above the published one"
                                                                  : "above the published mean: " + above_published);
  return table;
}

// Cells in which a method beats the reference beyond chance.
std::string better_than_reference(const SweepRows& rows) {
  const SweepSummary summary = summarise(rows);
  std::string cells;
  for (const SummaryRow& row : summary.rows) {
    const PairedTest& test = row.against_reference;
    if (row.method == summary.reference || !test.p_holm || *test.p_holm >= kSignificant || *test.difference >= 0.0)
      continue;
    cells += (cells.empty() ? "" : "; ") + row.method + " " + summary_axis_name(row.axis) + " (" + joined(row.levels) +
             ", " + sweep_subject_name(row.subject) + ")";
  }
  return cells.empty() ? "no method is significantly better than " + summary.reference +
                             " in any cell (Wilcoxon on paired tasks, Holm over all cells)"
                       : "significantly better than " + summary.reference + ": " + cells;
}

std::vector<PaperTable> tables_of_table1(const SweepRows& rows) {
  std::vector<PaperTable> tables;
  for (const auto& [label, condition] : conditions_along(rows, kConditionAxis))
    for (const SweepSubject subject : {SweepSubject::kCamera, SweepSubject::kPair})
      tables.push_back(error_table(rows, condition, subject, true,
                                   "Table " + std::string(subject == SweepSubject::kCamera ? "1" : "2") + ", " +
                                       subject_title(subject) + (label.empty() ? "" : ", images " + label)));
  if (!tables.empty()) tables.back().notes.push_back(better_than_reference(rows));
  return tables;
}

std::vector<double> figures_of(const Sample& sample, bool rotation) {
  return rotation ? sample.angles_deg : sample.lengths_cm;
}

// Methods in rows, levels of an axis in columns, the mean length of the error in the cells.
PaperTable matrix(const SweepRows& rows, std::size_t axis, const Condition& rest, SweepSubject subject, bool rotation,
                  const std::string& title) {
  PaperTable table;
  table.title = title;
  table.head = {rotation ? "mean error [deg]" : "mean error [cm]"};
  for (const std::string& level : rows.levels[axis]) table.head.push_back(level);
  std::string missing;
  for (const std::string& method : rows.methods) {
    std::vector<std::string> cells = {method};
    bool any = false;
    for (const std::string& level : rows.levels[axis]) {
      Condition condition = rest;
      condition[axis] = level;
      const Sample sample = sample_of(rows, condition, method, subject);
      const std::optional<double> value = mean(figures_of(sample, rotation));
      any = any || value;
      cells.push_back(cell(value) + (value && sample.answered < sample.tasks ? "*" : ""));
    }
    if (any) table.rows.push_back(cells);
  }
  const bool starred = std::any_of(table.rows.begin(), table.rows.end(), [](const auto& row) {
    return std::any_of(row.begin(), row.end(), [](const std::string& text) { return text.back() == '*'; });
  });
  if (starred) table.notes.push_back("* not every task was answered; the mean is over those that were");
  return table;
}

std::vector<PaperTable> tables_of_curve(const SweepRows& rows, const std::string& along, const std::string& across) {
  const std::optional<std::size_t> axis = axis_of(rows, along);
  if (!axis) throw Error(rows.name + ": the sweep has no axis " + along);
  std::vector<PaperTable> tables;
  for (const auto& [label, condition] : conditions_along(rows, across))
    for (const SweepSubject subject : {SweepSubject::kCamera, SweepSubject::kPair})
      for (const bool rotation : {false, true})
        tables.push_back(
            matrix(rows, *axis, condition, subject, rotation,
                   subject_title(subject) + (label.empty() ? "" : ", " + label) + ", over " + rows.axis_titles[*axis]));
  return tables;
}

// The goal of the experiment at the largest lambda, for every reading.
std::string goal_note(const SweepRows& rows, const std::string& method, double limit_cm, double limit_deg) {
  const std::size_t lambda = axis_of(rows, "lambda").value(), model = axis_of(rows, "model").value();
  std::string text = method + " at lambda " + rows.levels[lambda].back() + " (goal: below " + plain_figure(limit_cm) +
                     " cm, " + plain_figure(limit_deg) + " deg an axis):";
  for (const std::string& level : rows.levels[model]) {
    const Sample sample =
        sample_of(rows, {{lambda, rows.levels[lambda].back()}, {model, level}}, method, SweepSubject::kCamera);
    double worst_cm = 0.0, worst_deg = 0.0;
    for (std::size_t i = 0; i < 6; ++i)
      (i < 3 ? worst_cm : worst_deg) = std::max(i < 3 ? worst_cm : worst_deg, sample.mean_absolute(i).value_or(NAN));
    text += " " + level + " " +
            (sample.states_anything() ? short_figure(worst_cm) + " cm " + short_figure(worst_deg) + " deg" : "-") + ";";
  }
  text.pop_back();
  return text;
}

PaperTable spread_table(const SweepRows& rows) {
  PaperTable table;
  table.title =
      "Repeatability: mean and standard deviation over the runs of each camera's pose in the robot, minus its mounting";
  table.head = head_of_axes("mean +- sd", "runs");
  std::set<std::string> cameras;
  for (const SweepRow& row : rows.rows)
    if (row.subject == SweepSubject::kCamera) cameras.insert(row.camera);
  for (const std::string& camera : cameras) {
    SweepRows own = rows;
    own.rows.erase(std::remove_if(own.rows.begin(), own.rows.end(),
                                  [&](const SweepRow& row) {
                                    return row.subject == SweepSubject::kCamera && row.camera != camera;
                                  }),
                   own.rows.end());
    for (const std::string& method : rows.methods) {
      const Sample sample = sample_of(own, {}, method, SweepSubject::kCamera);
      if (!sample.states_anything()) continue;
      std::vector<std::string> cells = {camera + " " + method, count_cell(sample)};
      for (std::size_t i = 0; i < 6; ++i) {
        const std::optional<double> middle = mean(sample.values[i]), spread = deviation(sample.values[i]);
        cells.push_back(!middle ? "-"
                                : signed_figure(*middle, 2) +
                                      (spread ? "+-" + figure(*spread, std::max(2, decimals_for(*spread, 2))) : ""));
      }
      table.rows.push_back(cells);
    }
  }
  return table;
}

std::vector<PaperTable> tables_of_table3(const SweepRows& rows) {
  const SweepRows against_li = against_method(rows, "li");
  return {
      error_table(against_li, {}, SweepSubject::kPair, false, "Table 3, camera to camera, against li as in the paper"),
      error_table(rows, {}, SweepSubject::kPair, false, "Camera to camera, against the truth"), spread_table(rows)};
}

}  // namespace

const std::vector<PaperExperiment>& paper_experiments() {
  static const std::vector<PaperExperiment> experiments = {
      {"table1", "Tables 1 and 2: ten worlds of 100 stops, every method, clean images and those of a D455",
       "paper/table1"},
      {"quantity", "Error over the number of images, 5 to 100", "paper/quantity"},
      {"odometry", "Error over the odometry's noise, lambda 0 to 10, in both readings", "paper/odometry"},
      {"table3", "Table 3: the real robot's twin, driven in six worlds indoors and four outdoors", "paper/table3"},
      {"why", "Where MEMROC's error comes from: the authors' chain, then one link after the other replaced",
       "paper/why"}};
  return experiments;
}

const PaperExperiment& find_paper_experiment(const std::string& name) {
  std::vector<std::string> known;
  for (const PaperExperiment& experiment : paper_experiments()) {
    if (experiment.name == name) return experiment;
    known.push_back(experiment.name);
  }
  throw Error("\"" + for_message(name) + "\": there is no such experiment; " + suggestion(name, known));
}

std::string published_name_of(const std::string& method) {
  static const std::map<std::string, std::string> names = {
      {"memroc", "MEMROC"},
      {"memroc_reference", "MEMROC"},
      {"joint_memroc", "Joint-MEMROC"},
      {"joint_memroc_reference", "Joint-MEMROC"},
      {"robot_autocalib", "RobotAutocalib"},
      {"robot_autocalib_board", "RobotAutocalib"},
      {"sensorx2car", "SensorX2Car"},
      {"li", "Li et al."},
  };
  const auto found = names.find(method);
  return found == names.end() ? std::string() : found->second;
}

std::vector<PaperTable> paper_tables(const PaperExperiment& experiment, const SweepRows& rows) {
  if (experiment.name == "table1") return tables_of_table1(rows);
  if (experiment.name == "quantity") return tables_of_curve(rows, "stops", "");
  if (experiment.name == "table3") return tables_of_table3(rows);
  if (experiment.name == "why") return tables_of_why(rows);
  std::vector<PaperTable> tables = tables_of_curve(rows, "lambda", "model");
  tables.front().notes.push_back(goal_note(rows, "joint_memroc", 2.0, 1.0));
  tables.front().notes.push_back(goal_note(rows, "ml", 1.0, 0.5));
  return tables;
}

std::string format_paper_tables(const std::vector<PaperTable>& tables) {
  std::string text;
  for (const PaperTable& table : tables) {
    TextTable columns({0});
    columns.add(table.head);
    for (const auto& row : table.rows) columns.add(row);
    text += (text.empty() ? "" : "\n") + table.title + "\n" + columns.text({" ", "  "});
    for (const std::string& note : table.notes) text += " " + note + "\n";
  }
  return text;
}

std::string paper_tables_as_markdown(const std::vector<PaperTable>& tables) {
  const auto line = [](const std::vector<std::string>& cells) {
    std::string text = "|";
    for (const std::string& content : cells) text += " " + content + " |";
    return text + "\n";
  };
  std::string text;
  for (const PaperTable& table : tables) {
    text += (text.empty() ? "" : "\n") + std::string("### ") + table.title + "\n\n" + line(table.head) +
            line(std::vector<std::string>(table.head.size(), "---"));
    for (const auto& row : table.rows) text += line(row);
    for (const std::string& note : table.notes) text += "\n" + note + "\n";
  }
  return text;
}

std::vector<std::filesystem::path> write_paper(const PaperExperiment& experiment, const SweepRows& rows,
                                               const std::filesystem::path& folder) {
  const std::filesystem::path text = folder / (experiment.name + ".md"), csv = folder / (experiment.name + ".csv");
  write_file_atomically(text,
                        "# " + experiment.title + "\n\n" + paper_tables_as_markdown(paper_tables(experiment, rows)));
  write_file_atomically(csv, paper_csv(experiment.name, rows));
  std::vector<std::filesystem::path> files = draw_figures("paper", csv, {"--title", experiment.title});
  files.insert(files.end(), {csv, text});
  return files;
}

}  // namespace rigproof
