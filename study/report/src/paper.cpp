#include "rigproof/study/report/paper.h"

#include <algorithm>
#include <cmath>

#include "paper_csv.h"
#include "paper_error_table.h"
#include "paper_samples.h"
#include "paper_table3.h"
#include "paper_why.h"
#include "rigproof/core/error.h"
#include "rigproof/core/figures.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/study/report/figures.h"
#include "rigproof/validate/text_table.h"

namespace rigproof {
namespace {

using namespace paper;

constexpr const char* kConditionAxis = "images";
constexpr double kSignificant = 0.05;

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

// The cells of a method over the levels of an axis, and below them the counts of success where not every task is one.
void add_levels(const std::string& method, const std::vector<Sample>& samples, bool rotation, PaperTable* table) {
  std::vector<std::string> cells = {method}, counts = {"  success"};
  bool all = true;
  for (const Sample& sample : samples) {
    cells.push_back(cell(mean(figures_of(sample, rotation))));
    counts.push_back(success_cell(sample));
    all = all && sample.success == sample.tasks;
  }
  table->rows.push_back(cells);
  if (!all) table->rows.push_back(counts);
}

// Methods in rows, levels of an axis in columns, the mean length of the error in the cells.
PaperTable matrix(const SweepRows& rows, std::size_t axis, const Condition& rest, SweepSubject subject, bool rotation,
                  const std::string& title) {
  PaperTable table;
  table.title = title;
  table.head = {rotation ? "mean error [deg]" : "mean error [cm]"};
  for (const std::string& level : rows.levels[axis]) table.head.push_back(level);
  std::vector<std::pair<std::string, Sample>> totals;
  for (const std::string& method : rows.methods) {
    std::vector<Sample> samples;
    for (const std::string& level : rows.levels[axis]) {
      Condition condition = rest;
      condition[axis] = level;
      samples.push_back(sample_of(rows, condition, method, subject));
    }
    totals.emplace_back(method, sample_of(rows, rest, method, subject));
    const Sample& total = totals.back().second;
    if (total.stated[rotation ? 3 : 0] > 0) add_levels(method, samples, rotation, &table);
  }
  table.notes = {success_note()};
  if (const std::string far = far_note(totals); !far.empty()) table.notes.push_back(far);
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
            (sample.answers > sample.far ? short_figure(worst_cm) + " cm " + short_figure(worst_deg) + " deg" : "-") +
            ";";
  }
  text.pop_back();
  return text;
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
