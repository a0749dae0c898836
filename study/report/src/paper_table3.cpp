#include "paper_table3.h"

#include <algorithm>
#include <set>

#include "paper_error_table.h"
#include "rigproof/core/figures.h"
#include "rigproof/core/text.h"

namespace rigproof::paper {
namespace {

// "+.52+-2.86": over the runs.
std::string spread_cell(const std::vector<double>& values) {
  const std::optional<double> middle = mean(values), spread = deviation(values);
  if (!middle) return "-";
  return signed_figure(*middle, 2) + (spread ? "+-" + figure(*spread, std::max(2, decimals_for(*spread, 2))) : "");
}

// Of one camera, and of the rig in tasks that have it.
SweepRows of_camera(const SweepRows& rows, const std::string& camera) {
  std::set<std::string> tasks;
  for (const SweepRow& row : rows.rows)
    if (row.subject == SweepSubject::kCamera && row.camera == camera) tasks.insert(row.task);
  SweepRows own = rows;
  own.rows.erase(std::remove_if(own.rows.begin(), own.rows.end(),
                                [&](const SweepRow& row) {
                                  return row.subject == SweepSubject::kRig ? tasks.count(row.task) == 0
                                                                           : row.camera != camera;
                                }),
                 own.rows.end());
  return own;
}

PaperTable spread_table(const SweepRows& rows, const std::string& which) {
  PaperTable table;
  table.title = "Repeatability" + which +
                ": mean and standard deviation over the runs of each camera's pose in the robot, minus its mounting";
  table.head = head_of_axes("mean +- sd", "success");
  std::set<std::string> cameras;
  for (const SweepRow& row : rows.rows)
    if (row.subject == SweepSubject::kCamera) cameras.insert(row.camera);
  std::vector<std::pair<std::string, Sample>> samples;
  for (const std::string& camera : cameras) {
    const SweepRows own = of_camera(rows, camera);
    for (const std::string& method : rows.methods) {
      const Sample sample = sample_of(own, {}, method, SweepSubject::kCamera);
      if (sample.answers == 0) continue;
      samples.emplace_back(camera + " " + method, sample);
      std::vector<std::string> cells = {samples.back().first, success_cell(sample)};
      for (const std::vector<double>& values : sample.values) cells.push_back(spread_cell(values));
      table.rows.push_back(cells);
    }
  }
  table.notes = {success_note()};
  if (const std::string far = far_note(samples); !far.empty()) table.notes.push_back(far);
  return table;
}

// "right in office (7)".
std::string cameras_with_few_motions(const SweepRows& rows) {
  std::vector<std::string> names;
  for (const SweepRow& row : rows.rows) {
    if (row.subject != SweepSubject::kCamera || !has_few_motions(row)) continue;
    const std::string name = row.camera + " in " + joined(row.levels) + " (" + std::to_string(*row.motions) + ")";
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return joined(names);
}

}  // namespace

bool has_few_motions(const SweepRow& row) { return row.motions && *row.motions < kFewMotions; }

std::string few_motions_in_words() { return "fewer than " + std::to_string(kFewMotions) + " motions"; }

SweepRows only(const SweepRows& rows, SweepSubject subject, bool few_motions) {
  const auto wanted = [&](const SweepRow& row) {
    return row.subject == subject && has_few_motions(row) == few_motions;
  };
  std::set<std::string> tasks;
  for (const SweepRow& row : rows.rows)
    if (wanted(row)) tasks.insert(row.task);
  SweepRows kept = rows;
  kept.rows.clear();
  for (const SweepRow& row : rows.rows)
    if (wanted(row) || (row.subject == SweepSubject::kRig && tasks.count(row.task) > 0)) kept.rows.push_back(row);
  return kept;
}

std::vector<PaperTable> tables_of_table3(const SweepRows& rows) {
  const SweepRows against_li = against_method(rows, "li");
  const std::string title = "Table 3, camera to camera, against li as in the paper";
  const std::string few = cameras_with_few_motions(rows);
  std::vector<PaperTable> tables = {error_table(against_li, {}, SweepSubject::kPair, false, title)};
  if (!few.empty()) {
    const std::string who = few_motions_in_words() + ": " + few;
    tables.push_back(error_table(only(against_li, SweepSubject::kPair, false), {}, SweepSubject::kPair, false,
                                 title + ", without cameras of " + who));
    tables.push_back(error_table(only(against_li, SweepSubject::kPair, true), {}, SweepSubject::kPair, false,
                                 title + ", pairs of cameras of " + who));
  }
  tables.push_back(error_table(rows, {}, SweepSubject::kPair, false, "Camera to camera, against the truth"));
  tables.push_back(spread_table(only(rows, SweepSubject::kCamera, false), ""));
  if (!few.empty())
    tables.push_back(spread_table(only(rows, SweepSubject::kCamera, true), " of cameras of " + few_motions_in_words()));
  return tables;
}

}  // namespace rigproof::paper
