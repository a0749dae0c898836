// Tables and figures of the paper's experiments, from rows whose errors are known.
#include "rigproof/study/report/paper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <sstream>
#include <tuple>

#include "error_text.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

SweepRow row_of(const std::string& task, const std::vector<std::string>& levels, const std::string& method,
                SweepSubject subject, const std::string& camera) {
  SweepRow row;
  row.task = task;
  row.levels = levels;
  row.method = method;
  row.subject = subject;
  row.camera = camera;
  row.status = SweepStatus::kSolved;
  return row;
}

void set_error(double cm, double deg, SweepRow* row) {
  for (std::size_t i = 0; i < 3; ++i) {
    row->error[i] = cm;
    row->error[i + 3] = deg;
    row->roll_pitch_yaw[i] = deg;
  }
}

/// A rig row, a camera, and a pair, all with the same error.
void add_answers(const std::string& task, const std::vector<std::string>& levels, const std::string& method, double cm,
                 double deg, SweepRows* rows) {
  rows->rows.push_back(row_of(task, levels, method, SweepSubject::kRig, "all"));
  for (const auto& [subject, name] :
       {std::make_pair(SweepSubject::kCamera, "left"), std::make_pair(SweepSubject::kPair, "left-right")}) {
    SweepRow row = row_of(task, levels, method, subject, name);
    set_error(cm, deg, &row);
    rows->rows.push_back(row);
  }
}

SweepRows frame_of(const std::vector<std::string>& axes, const std::vector<std::vector<std::string>>& levels,
                   const std::vector<std::string>& methods) {
  SweepRows rows;
  rows.name = "test";
  rows.axes = rows.axis_titles = axes;
  rows.levels = levels;
  rows.methods = methods;
  rows.reference = methods.front();
  rows.pooled.assign(axes.size(), false);
  for (const auto& list : levels) {
    rows.level_values.emplace_back();
    for (std::size_t i = 0; i < list.size(); ++i) rows.level_values.back().push_back(static_cast<double>(i));
  }
  return rows;
}

const std::vector<std::string>* find_row(const PaperTable& table, const std::string& name) {
  for (const auto& row : table.rows)
    if (row.front() == name) return &row;
  return nullptr;
}

std::vector<std::string> lines_with(const std::string& text, const std::string& part) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.find(part) != std::string::npos) found.push_back(line);
  return found;
}

SweepRows table1_rows() {
  SweepRows rows = frame_of({"images", "world"}, {{"clean"}, {"lab", "office"}}, {"ml", "memroc", "li"});
  rows.pooled[1] = true;
  add_answers("a", {"clean", "lab"}, "ml", 0.001, 0.002, &rows);
  add_answers("b", {"clean", "office"}, "ml", -0.003, 0.002, &rows);
  add_answers("a", {"clean", "lab"}, "memroc", 0.2, 0.1, &rows);
  // The second world: nothing.
  rows.rows.push_back(row_of("b", {"clean", "office"}, "memroc", SweepSubject::kRig, "all"));
  rows.rows.back().status = SweepStatus::kRefused;
  for (const auto& [subject, name] :
       {std::make_pair(SweepSubject::kCamera, "left"), std::make_pair(SweepSubject::kPair, "left-right")})
    rows.rows.push_back(row_of("b", {"clean", "office"}, "memroc", subject, name));
  // li: pairs only.
  for (const char* task : {"a", "b"}) {
    const std::vector<std::string> levels = {"clean", *task == 'a' ? "lab" : "office"};
    rows.rows.push_back(row_of(task, levels, "li", SweepSubject::kRig, "all"));
    rows.rows.push_back(row_of(task, levels, "li", SweepSubject::kPair, "left-right"));
    set_error(0.05, 0.01, &rows.rows.back());
  }
  return rows;
}

TEST(Paper, TableOneStandsBesideThePublishedRows) {
  const std::vector<PaperTable> tables = paper_tables(find_paper_experiment("table1"), table1_rows());
  ASSERT_EQ(tables.size(), 2U);
  const std::vector<std::string>*ml = find_row(tables[0], "ml"), *memroc = find_row(tables[0], "memroc");
  ASSERT_TRUE(ml != nullptr && memroc != nullptr);
  EXPECT_THAT(*ml, ElementsAre("ml", "2/2", ".0020", ".0020", ".0020", ".0020", ".0020", ".0020"));
  EXPECT_THAT(*memroc, ElementsAre("memroc", "1/2", ".20", ".20", ".20", ".10", ".10", ".10"));
  EXPECT_THAT(*find_row(tables[0], "  published MEMROC"),
              ElementsAre("  published MEMROC", "", ".61", ".25", ".15", ".08", ".13", ".16"));
  // Published are .15 cm in z and .08 deg in roll.
  EXPECT_EQ(tables[0].notes.front(), "above the published mean: memroc tz roll");
  EXPECT_THAT(tables[0].notes, testing::Contains(HasSubstr("li says nothing about camera to robot")));
  EXPECT_EQ(find_row(tables[0], "li"), nullptr);
  ASSERT_NE(find_row(tables[1], "li"), nullptr);
  EXPECT_EQ((*find_row(tables[1], "li"))[1], "2/2");
  EXPECT_THAT(tables[1].notes.back(), HasSubstr("no method is significantly better than ml"));
  const std::string text = format_paper_tables(tables);
  EXPECT_THAT(text, HasSubstr("Table 2, camera to camera, images clean"));
  EXPECT_THAT(text, Not(HasSubstr("NOT JUDGED")));
  EXPECT_THAT(paper_tables_as_markdown(tables), HasSubstr("| memroc | 1/2 | .20 |"));
}

TEST(Paper, TableThreeIsToldAgainstLi) {
  SweepRows rows = frame_of({"world"}, {{"lab", "office", "home"}}, {"ml", "li"});
  double error = 0.10;
  for (const std::string& world : rows.levels[0]) {
    add_answers(world, {world}, "ml", error, 0.02, &rows);
    add_answers(world, {world}, "li", 0.04, 0.01, &rows);
    error += 0.10;
  }
  const std::vector<PaperTable> tables = paper_tables(find_paper_experiment("table3"), rows);
  ASSERT_EQ(tables.size(), 3U);
  EXPECT_THAT(*find_row(tables[0], "ml"), ElementsAre("ml", "3/3", ".16", ".16", ".16", ".010", ".010", ".010"));
  EXPECT_EQ(find_row(tables[0], "li"), nullptr);
  EXPECT_EQ((*find_row(tables[1], "ml"))[2], ".20");
  // .1 .2 .3: mean .2, deviation .1.
  EXPECT_EQ((*find_row(tables[2], "left ml"))[2], "+.20+-.10");
}

// A metre off is 100 / sqrt(3) on every axis, 20 degrees are 11.5.
SweepRows rows_with_far_answers() {
  SweepRows rows = frame_of({"images", "world"}, {{"clean"}, {"lab", "office"}}, {"ml", "tsai", "park", "memroc"});
  rows.pooled[1] = true;
  const std::vector<std::string> lab = {"clean", "lab"}, office = {"clean", "office"};
  for (const auto& [task, levels] : {std::make_pair("a", lab), std::make_pair("b", office)}) {
    rows.tasks.push_back({task, {0, levels == lab ? 0U : 1U}, 0, {}});
    add_answers(task, levels, "ml", 0.1, 0.1, &rows);
    add_answers(task, levels, "tsai", levels == lab ? 21121.8 : 0.3, 0.2, &rows);
    add_answers(task, levels, "park", 0.2, levels == lab ? 11.6 : 150.0, &rows);
    add_answers(task, levels, "memroc", levels == lab ? 57.7 : -57.7, 11.5, &rows);
  }
  return rows;
}

TEST(Paper, AnswersThatAreFarOffCountAgainstSuccessAndAreInNoMean) {
  const std::vector<PaperTable> tables = paper_tables(find_paper_experiment("table1"), rows_with_far_answers());
  for (const PaperTable& table : tables) {
    EXPECT_EQ(table.head[1], "success");
    EXPECT_THAT(*find_row(table, "ml"), ElementsAre("ml", "2/2", ".10", ".10", ".10", ".10", ".10", ".10"));
    EXPECT_THAT(*find_row(table, "tsai"), ElementsAre("tsai", "1/2", ".30", ".30", ".30", ".20", ".20", ".20"));
    EXPECT_THAT(*find_row(table, "park"), ElementsAre("park", "0/2", "-", "-", "-", "-", "-", "-"));
    EXPECT_EQ((*find_row(table, "memroc"))[1], "2/2") << "just within a metre and 20 degrees";
    EXPECT_THAT(table.notes, testing::Contains(HasSubstr("within 1 m and 20 deg")));
    EXPECT_THAT(table.notes, testing::Contains("far off: tsai 1 of 2 answers; park 2 of 2 answers"));
  }
}

TEST(Paper, CurvesAndFiguresLeaveOutTheSameAnswers) {
  SweepRows rows = frame_of({"stops"}, {{"5", "100"}}, {"ml", "tsai", "park"});
  rows.level_values = {{5.0, 100.0}};
  for (const auto& [task, level, tsai_cm] :
       {std::make_tuple("a", "5", 0.1), {"b", "5", 70.0}, {"c", "100", 0.2}, {"d", "100", 0.2}}) {
    add_answers(task, {level}, "ml", 0.1, 0.1, &rows);
    add_answers(task, {level}, "tsai", tsai_cm, 0.1, &rows);
    add_answers(task, {level}, "park", 300.0, 90.0, &rows);
  }
  const PaperTable table = paper_tables(find_paper_experiment("quantity"), rows).front();
  ASSERT_EQ(table.rows.size(), 5U);
  EXPECT_THAT(table.rows[1], ElementsAre("tsai", ".17", ".35"));
  EXPECT_THAT(table.rows[2], ElementsAre("  success", "1/2", "2/2"));
  EXPECT_THAT(table.rows[3], ElementsAre("park", "-", "-"));
  EXPECT_THAT(table.rows[4], ElementsAre("  success", "0/2", "0/2"));
  const TempFolder folder;
  write_paper(find_paper_experiment("quantity"), rows, folder.path());
  const std::string csv = read_text_file(folder / "quantity.csv");
  for (const auto& [text, count] :
       {std::make_pair(",tsai,measured,", 12U), {",tsai,far,", 4U}, {",park,far,", 16U}, {",park,measured,", 0U}})
    EXPECT_EQ(lines_with(csv, text).size(), count) << text;
  write_paper(find_paper_experiment("table1"), rows_with_far_answers(), folder / "dots");
  EXPECT_THAT(lines_with(read_text_file(folder / "dots" / "table1.csv"), "success,\"camera to robot, images clean\""),
              testing::Contains("success,\"camera to robot, images clean\",tasks,successes,tsai,measured,,,2,,1"));
  EXPECT_THAT(read_text_file(folder / "dots" / "table1.svg"),
              testing::AllOf(HasSubstr("tsai  1/2"), HasSubstr("20 deg")));
}

// `right` moved seven times in the office.
TEST(Paper, TableThreeShowsACameraThatHardlyMovedApart) {
  SweepRows rows = frame_of({"world"}, {{"lab", "office", "home"}}, {"ml", "li"});
  for (const std::string& world : rows.levels[0]) {
    for (const char* method : {"ml", "li"}) {
      rows.rows.push_back(row_of(world, {world}, method, SweepSubject::kRig, "all"));
      for (const auto& [subject, name] : {std::make_pair(SweepSubject::kCamera, "left"),
                                          {SweepSubject::kCamera, "right"},
                                          {SweepSubject::kPair, "left-center"},
                                          {SweepSubject::kPair, "left-right"}}) {
        rows.rows.push_back(row_of(world, {world}, method, subject, name));
        const bool few = world == "office" && std::string(name).find("right") != std::string::npos;
        rows.rows.back().motions = few ? 7 : 17;
        set_error(std::string(method) == "li" ? 0.0 : few ? 22.0 : 0.1, 0.01, &rows.rows.back());
      }
    }
  }
  const std::vector<PaperTable> tables = paper_tables(find_paper_experiment("table3"), rows);
  ASSERT_EQ(tables.size(), 6U);
  EXPECT_EQ((*find_row(tables[0], "ml"))[2], "3.75");
  EXPECT_THAT(tables[1].title, HasSubstr("without cameras of fewer than 10 motions: right in office (7)"));
  EXPECT_THAT(*find_row(tables[1], "ml"), ElementsAre("ml", "3/3", ".10", ".10", ".10", "0", "0", "0"));
  EXPECT_THAT(tables[2].title, HasSubstr("pairs of cameras of fewer than 10 motions"));
  EXPECT_THAT(*find_row(tables[2], "ml"), ElementsAre("ml", "1/1", "22.00", "22.00", "22.00", "0", "0", "0"));
  EXPECT_EQ((*find_row(tables[3], "ml"))[2], "3.75") << "all of them against the truth";
  EXPECT_EQ((*find_row(tables[4], "left ml"))[1], "3/3");
  EXPECT_EQ((*find_row(tables[4], "right ml"))[1], "2/2");
  EXPECT_EQ((*find_row(tables[4], "right ml"))[2], "+.10+-0");
  EXPECT_EQ((*find_row(tables[5], "right ml"))[2], "+22.00");
  EXPECT_EQ(find_row(tables[5], "left ml"), nullptr);
  const TempFolder folder;
  write_paper(find_paper_experiment("table3"), rows, folder.path());
  const std::string csv = read_text_file(folder / "table3.csv");
  EXPECT_THAT(lines_with(csv, ",tx,cm,ml,few_motions,"),
              ElementsAre("repeatability,camera to robot,tx,cm,ml,few_motions,office,right,2,run,22"));
  EXPECT_EQ(lines_with(csv, "without cameras of fewer than 10 motions\",tx,cm,ml,measured,").size(), 5U);
}

TEST(Paper, CurvesTellTheGoal) {
  SweepRows rows = frame_of({"model", "lambda"}, {{"per_increment", "per_pose"}, {"0", "10"}}, {"ml", "joint_memroc"});
  for (const std::string& model : rows.levels[0])
    for (const std::string& lambda : rows.levels[1])
      for (const std::string& method : rows.methods)
        add_answers(model + lambda, {model, lambda}, method, lambda == "10" ? 1.5 : 0.1, 0.25, &rows);
  const std::vector<PaperTable> tables = paper_tables(find_paper_experiment("odometry"), rows);
  ASSERT_EQ(tables.size(), 8U);
  // Lengths: sqrt(3) times an axis.
  EXPECT_THAT(*find_row(tables[0], "ml"), ElementsAre("ml", ".17", "2.60"));
  EXPECT_THAT(tables[0].notes, testing::Contains(HasSubstr("per_pose 1.5 cm .25 deg")));
}

std::vector<std::string> names_of(const std::vector<std::filesystem::path>& files) {
  std::vector<std::string> names;
  for (const auto& file : files) names.push_back(file.filename().string());
  return names;
}

/// Sets a variable of the environment for a while.
class Environment {
 public:
  Environment(std::string name, const std::string& value) : name_(std::move(name)) {
    if (const char* before = std::getenv(name_.c_str())) before_ = before;
    setenv(name_.c_str(), value.c_str(), 1);
  }
  ~Environment() {
    if (before_)
      setenv(name_.c_str(), before_->c_str(), 1);
    else
      unsetenv(name_.c_str());
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  std::string name_;
  std::optional<std::string> before_;
};

TEST(Paper, DrawsFiguresAsPixelsAndVectors) {
  const TempFolder folder;
  const std::vector<std::filesystem::path> files =
      write_paper(find_paper_experiment("table1"), table1_rows(), folder / "out");
  EXPECT_THAT(names_of(files), ElementsAre("table1.png", "table1.pdf", "table1.svg", "table1.csv", "table1.md"));
  EXPECT_FALSE(cv::imread(files[0].string()).empty());
  EXPECT_THAT(read_text_file(files[1]), HasSubstr("%PDF-"));
  const std::string svg = read_text_file(files[2]);
  for (const char* text : {"camera to robot, images clean", "memroc", "yaw [deg]"}) EXPECT_THAT(svg, HasSubstr(text));
  // The same again: nothing of the hour is in a figure.
  write_paper(find_paper_experiment("table1"), table1_rows(), folder / "again");
  for (const char* name : {"table1.png", "table1.pdf", "table1.svg"})
    EXPECT_EQ(sha256_hex_of_file(folder / "out" / name), sha256_hex_of_file(folder / "again" / name)) << name;
}

TEST(Paper, FiguresHaveTheirNumbersBesideThem) {
  const TempFolder folder;
  write_paper(find_paper_experiment("table1"), table1_rows(), folder.path());
  const std::string csv = read_text_file(folder / "table1.csv");
  EXPECT_EQ(csv.rfind("figure,panel,quantity,unit,method,source,task,camera,x,x_title,error\n", 0), 0U);
  EXPECT_THAT(lines_with(csv, "camera to robot, images clean\",tz,cm,ml,"),
              ElementsAre("dots,\"camera to robot, images clean\",tz,cm,ml,measured,a,left,,,0.001",
                          "dots,\"camera to robot, images clean\",tz,cm,ml,measured,b,left,,,-0.003"));
  EXPECT_THAT(lines_with(csv, "camera to robot, images clean\",yaw,deg,memroc,"),
              ElementsAre("dots,\"camera to robot, images clean\",yaw,deg,memroc,measured,a,left,,,0.1",
                          "dots,\"camera to robot, images clean\",yaw,deg,memroc,published,,,,,0.16"));
  EXPECT_THAT(lines_with(csv, "camera to robot, images clean\",tz,cm,li,measured"), testing::IsEmpty());
}

TEST(Paper, CurvesHaveLengthsOverTheLevel) {
  SweepRows rows = frame_of({"stops"}, {{"5", "100"}}, {"ml"});
  rows.level_values = {{5.0, 100.0}};
  rows.axis_titles = {"images"};
  add_answers("a", {"5"}, "ml", 1.0, 2.0, &rows);
  add_answers("b", {"100"}, "ml", -2.0, 0.0, &rows);
  const TempFolder folder;
  EXPECT_THAT(names_of(write_paper(find_paper_experiment("quantity"), rows, folder.path())),
              ElementsAre("quantity.png", "quantity.pdf", "quantity.svg", "quantity.csv", "quantity.md"));
  const std::vector<std::string> lines =
      lines_with(read_text_file(folder / "quantity.csv"), "camera to robot,translation,cm,ml,");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[1],
            "curves,camera to robot,translation,cm,ml,measured,b,left,100,images," + number_text(std::sqrt(12.0)));
}

// Steps of known size, the same in every task but for the drawing.
SweepRows why_rows() {
  SweepRows rows = frame_of({"world"}, {{"lab", "yard"}}, {"joint_memroc_reference", "chain_corners", "ml"});
  int drawing = 0;
  for (const std::size_t place : {0U, 1U}) {
    const std::string& world = rows.levels[0][place];
    for (const char* task : {"1", "2", "3", "4"}) {
      const std::string name = world + task;
      rows.tasks.push_back({name, {place}, 0, {}});
      const double noise = 0.02 * ++drawing;
      add_answers(name, {world}, "joint_memroc_reference", -0.8 - noise, 0.1, &rows);
      add_answers(name, {world}, "chain_corners", 0.3 + noise, 0.04, &rows);
      add_answers(name, {world}, "ml", 0.1, -0.05, &rows);
    }
  }
  return rows;
}

TEST(Paper, WhyTellsWhatEachStepChanges) {
  const std::vector<PaperTable> tables = paper_tables(find_paper_experiment("why"), why_rows());
  ASSERT_EQ(tables.size(), 2U);
  const auto& rows = tables[0].rows;
  ASSERT_EQ(rows.size(), 5U) << "three means, two changes";
  EXPECT_EQ(rows[0][0], "joint_memroc_reference");
  EXPECT_EQ(rows[0][1], ".89");
  EXPECT_THAT(tables[1].notes, testing::Contains(HasSubstr("chain_corners: corners of ours")));
  EXPECT_EQ(rows[1][1], ".39");
  // The drawings cancel.
  EXPECT_THAT(rows[2][1], testing::StartsWith("-.50"));
  EXPECT_EQ(rows[3][1], ".10");
  EXPECT_THAT(rows[4][1], testing::StartsWith("-.29+-.0"));
  EXPECT_THAT(rows[4][4], testing::StartsWith("+.010"));

  // The changes add up to the whole way.
  const TempFolder folder;
  EXPECT_THAT(names_of(write_paper(find_paper_experiment("why"), why_rows(), folder.path())),
              ElementsAre("why.png", "why.pdf", "why.svg", "why.csv", "why.md"));
  double sum = 0.0, first = 0.0, last = 0.0;
  const std::string csv = read_text_file(folder / "why.csv");
  const auto number_at_end = [](const std::string& line) { return std::stod(line.substr(line.rfind(',') + 1)); };
  for (const std::string& line : lines_with(csv, "camera to robot,tx,cm,")) {
    if (line.find(",change,") != std::string::npos) sum += number_at_end(line);
    if (line.find("joint_memroc_reference,mean,") != std::string::npos) first = number_at_end(line);
    if (line.find(",ml,mean,") != std::string::npos) last = number_at_end(line);
  }
  EXPECT_GT(first, 0.8);
  EXPECT_NEAR(sum, last - first, 1e-12);
}

TEST(Paper, WithoutMatplotlibSaysWhatToInstallAndKeepsTheNumbers) {
  const TempFolder folder;
  write_file_atomically(folder / "hidden" / "matplotlib.py", "raise ImportError('hidden')\n");
  const auto draw = [&](const char* name) {
    return error_text([&] { write_paper(find_paper_experiment("table1"), table1_rows(), folder / name); });
  };
  {
    const Environment hidden("PYTHONPATH", (folder / "hidden").string());
    const std::string text = draw("out");
    EXPECT_THAT(text, HasSubstr("table1.csv is written, its figures are not: python3-matplotlib is missing"));
    EXPECT_THAT(text, HasSubstr("apt-get install python3-matplotlib"));
    EXPECT_THAT(text, HasSubstr("plot.py paper"));
  }
  for (const char* name : {"table1.csv", "table1.md"}) EXPECT_TRUE(std::filesystem::exists(folder / "out" / name));
  const Environment nowhere("PATH", (folder / "hidden").string());
  EXPECT_THAT(draw("none"), HasSubstr("apt-get install python3 python3-matplotlib"));
}

TEST(Paper, EveryExperimentDrawsFromUnfinishedRows) {
  const TempFolder folder;
  const std::vector<std::pair<std::string, SweepRows>> cases = {
      {"quantity", frame_of({"stops", "world"}, {{"5", "100"}, {"lab"}}, {"ml", "li"})},
      {"odometry", frame_of({"model", "lambda"}, {{"per_pose"}, {"0", "10"}}, {"ml", "joint_memroc"})},
      {"table3", frame_of({"world"}, {{"lab"}}, {"ml", "li"})},
      {"why", frame_of({"world"}, {{"lab"}}, {"joint_memroc_reference", "ml"})}};
  for (const auto& [name, rows] : cases)
    EXPECT_NO_THROW(write_paper(find_paper_experiment(name), rows, folder / name)) << name;
  EXPECT_THAT(error_text([] { find_paper_experiment("table4"); }), HasSubstr("table3"));
}

}  // namespace
}  // namespace rigproof
