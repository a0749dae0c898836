#include "paper_figures.h"

#include <algorithm>
#include <cmath>

#include "chart.h"
#include "paper_samples.h"
#include "rigproof/study/paper.h"
#include "rigproof/validate/published.h"

namespace rigproof::paper {
namespace {

using namespace inspect_detail;

const std::array<const char*, 6> kAxisNames = {"tx [cm]",    "ty [cm]",     "tz [cm]",
                                               "roll [deg]", "pitch [deg]", "yaw [deg]"};
constexpr double kGap = 70.0;

bool repeats_a_color(const SweepRows& rows, const std::string& method) {
  const auto found = std::find(rows.methods.begin(), rows.methods.end(), method);
  return static_cast<std::size_t>(found - rows.methods.begin()) >= kCameraColors;
}

// The same color for the same method in every figure.
Color method_color(const SweepRows& rows, const std::string& method) {
  const auto found = std::find(rows.methods.begin(), rows.methods.end(), method);
  return found == rows.methods.end() ? kGrey : camera_color(static_cast<std::size_t>(found - rows.methods.begin()));
}

std::string name_of(SweepSubject subject) {
  return subject == SweepSubject::kCamera ? "camera to robot" : "camera to camera";
}

// ------------------------------------------------------------------------------------ errors by method, one dot each

struct DotRow {
  std::string title;
  std::vector<std::string> methods;
  std::vector<Sample> samples;
  const PublishedTable* published = nullptr;
};

std::optional<double> published_error(const DotRow& row, std::size_t method, std::size_t axis) {
  if (row.published == nullptr) return std::nullopt;
  for (const PublishedRow& theirs : row.published->rows)
    if (theirs.method == published_name_of(row.methods[method])) return theirs.error[axis];
  return std::nullopt;
}

DotRow dot_row(const SweepRows& rows, const Condition& condition, SweepSubject subject, bool synthetic,
               const std::string& title) {
  DotRow row;
  row.title = title;
  for (const PublishedTable& table : published_tables())
    if (table.between_cameras == (subject == SweepSubject::kPair) && table.synthetic == synthetic)
      row.published = &table;
  for (const std::string& method : rows.methods) {
    Sample sample = sample_of(rows, condition, method, subject);
    if (!sample.states_anything()) continue;
    row.methods.push_back(method);
    row.samples.push_back(std::move(sample));
  }
  return row;
}

void draw_dots(const SweepRows& rows, const DotRow& row, std::size_t axis, ChartAxes axes, Figure* figure) {
  std::vector<double> values;
  for (std::size_t m = 0; m < row.methods.size(); ++m) {
    const std::vector<double> errors = absolute(row.samples[m].values[axis]);
    for (const auto& value :
         {quantile(errors, 0.25), quantile(errors, 0.75), mean(errors), published_error(row, m, axis)})
      if (value) values.push_back(*value);
  }
  axes.x_log = true;
  decades_around(values, &axes.x_low, &axes.x_high);
  draw_axes(axes, {kAxisNames[axis], "", "", false}, figure);
  for (std::size_t m = 0; m < row.methods.size(); ++m) {
    const double y = static_cast<double>(row.methods.size() - m);
    const std::vector<double> errors = absolute(row.samples[m].values[axis]);
    const Color color = method_color(rows, row.methods[m]);
    const auto low = quantile(errors, 0.25), high = quantile(errors, 0.75), middle = mean(errors);
    if (low && high) figure->line(axes.at(*low, y), axes.at(*high, y), color.pale(0.6), 3.0);
    if (const auto theirs = published_error(row, m, axis)) figure->ring(axes.at(*theirs, y), 4.5, kInk);
    if (middle) figure->disc(axes.at(*middle, y), 3.5, color);
  }
}

std::vector<std::filesystem::path> draw_dot_rows(const SweepRows& rows, const std::vector<DotRow>& list,
                                                 const std::string& title, const std::filesystem::path& file) {
  constexpr double kNames = 190.0, kPanel = 150.0, kLine = 19.0;
  double height = kTitleHeight + 16.0;
  for (const DotRow& row : list) height += kLine * static_cast<double>(row.methods.size() + 1) + kGap;
  Figure figure(static_cast<int>(kNames + 6.0 * (kPanel + 34.0) + kMargin), static_cast<int>(height));
  figure.title(title, "disc: mean of the absolute error; line: quartiles; ring: published mean (Allegro et al. 2024)");
  double top = kTitleHeight + 40.0;
  for (const DotRow& row : list) {
    const double tall = kLine * static_cast<double>(row.methods.size() + 1);
    figure.text({kMargin, top - 28.0}, row.title, 10.0, kInk, Align::kLeft, true);
    for (std::size_t axis = 0; axis < 6; ++axis) {
      ChartAxes axes;
      axes.left = kNames + static_cast<double>(axis) * (kPanel + 34.0);
      axes.top = top;
      axes.width = kPanel;
      axes.height = tall;
      axes.y_high = static_cast<double>(row.methods.size() + 1);
      draw_dots(rows, row, axis, axes, &figure);
    }
    for (std::size_t m = 0; m < row.methods.size(); ++m)
      figure.text({kNames - 12.0, top + kLine * static_cast<double>(m + 1) + 3.5}, row.methods[m], 8.5, kInk,
                  Align::kRight);
    top += tall + kGap;
  }
  return figure.save(file);
}

// --------------------------------------------------------------------------------------------- curves with deviations

struct CurvePanel {
  std::string title;
  SweepSubject subject = SweepSubject::kCamera;
  bool rotation = false;
  Condition condition;
};

Series curve(const SweepRows& rows, std::size_t axis, const CurvePanel& panel, const std::string& method) {
  Series series;
  series.name = method;
  series.color = method_color(rows, method);
  series.hollow = repeats_a_color(rows, method);
  for (std::size_t i = 0; i < rows.levels[axis].size(); ++i) {
    Condition condition = panel.condition;
    condition[axis] = rows.levels[axis][i];
    const Sample sample = sample_of(rows, condition, method, panel.subject);
    const std::vector<double>& values = panel.rotation ? sample.angles_deg : sample.lengths_cm;
    const std::optional<double> middle = mean(values), spread = deviation(values);
    series.x.push_back(rows.level_values[axis][i]);
    series.y.push_back(middle);
    series.low.push_back(middle ? std::optional<double>(*middle - spread.value_or(0.0)) : std::nullopt);
    series.high.push_back(middle ? std::optional<double>(*middle + spread.value_or(0.0)) : std::nullopt);
  }
  return series;
}

std::vector<std::filesystem::path> draw_curves(const SweepRows& rows, std::size_t axis,
                                               const std::vector<CurvePanel>& panels, const std::string& title,
                                               const std::filesystem::path& file) {
  constexpr double kWidth = 430.0, kHeight = 230.0, kLeft = 66.0;
  const std::size_t lines = (panels.size() + 1) / 2;
  Figure figure(static_cast<int>(2.0 * (kLeft + kWidth) + kMargin),
                static_cast<int>(kTitleHeight + 46.0 + static_cast<double>(lines) * (kHeight + kGap)));
  figure.title(title, "mean length of the error, with a band of one standard deviation over tasks and cameras");
  std::vector<Series> legend;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    std::vector<Series> curves;
    std::vector<double> values;
    for (const std::string& method : rows.methods) {
      Series series = curve(rows, axis, panels[p], method);
      for (const auto& value : series.y)
        if (value) values.push_back(*value);
      curves.push_back(std::move(series));
    }
    ChartAxes axes;
    axes.left = kLeft + static_cast<double>(p % 2) * (kLeft + kWidth);
    axes.top = kTitleHeight + 60.0 + static_cast<double>(p / 2) * (kHeight + kGap);
    axes.width = kWidth;
    axes.height = kHeight;
    axes.x_low = rows.level_values[axis].front();
    axes.x_high = rows.level_values[axis].back();
    if (!(axes.x_high > axes.x_low)) axes.x_high = axes.x_low + 1.0;
    axes.y_log = true;
    decades_around(values, &axes.y_low, &axes.y_high);
    draw_axes(axes, {panels[p].title, rows.axis_titles[axis], panels[p].rotation ? "deg" : "cm", true}, &figure);
    for (const Series& series : curves) draw_series(axes, series, &figure);
    if (p == 0) legend = curves;
  }
  draw_legend(legend, {kMargin, kTitleHeight + 12.0}, &figure);
  return figure.save(file);
}

std::vector<std::filesystem::path> draw_experiment_curves(const SweepRows& rows, const std::string& along,
                                                          const std::string& across, const std::string& title,
                                                          const std::filesystem::path& file) {
  const std::size_t axis = axis_of(rows, along).value();
  std::vector<CurvePanel> panels;
  for (const auto& [label, condition] : conditions_along(rows, across))
    for (const SweepSubject subject : {SweepSubject::kCamera, SweepSubject::kPair})
      for (const bool rotation : {false, true})
        panels.push_back(
            {name_of(subject) + (rotation ? ", rotation" : ", translation") + (label.empty() ? "" : ", " + label),
             subject, rotation, condition});
  return draw_curves(rows, axis, panels, title, file);
}

// ----------------------------------------------------------------------------------------- each parameter over the
// runs

// Of one camera: what each method says in every run, minus the mounting; mean and deviation at the right.
std::vector<std::filesystem::path> draw_repeatability(const SweepRows& rows, const std::string& camera,
                                                      const std::filesystem::path& file) {
  constexpr double kWidth = 300.0, kHeight = 150.0, kLeft = 66.0;
  const std::size_t world = axis_of(rows, "world").value();
  const std::size_t runs = rows.levels[world].size();
  Figure figure(static_cast<int>(3.0 * (kLeft + kWidth) + kMargin),
                static_cast<int>(kTitleHeight + 46.0 + 2.0 * (kHeight + kGap)));
  figure.title("Repeatability of " + camera + " over " + std::to_string(runs) + " runs",
               "estimate minus mounting in each run; at the right mean and standard deviation");
  std::vector<Series> legend;
  for (std::size_t parameter = 0; parameter < 6; ++parameter) {
    std::vector<Series> curves;
    double largest = 0.0;
    for (const std::string& method : rows.methods) {
      Series series{method, method_color(rows, method), repeats_a_color(rows, method), {}, {}, {}, {}};
      for (std::size_t i = 0; i < runs; ++i) {
        std::optional<double> value;
        for (const SweepRow& row : rows.rows)
          if (row.method == method && row.camera == camera && row.levels[world] == rows.levels[world][i])
            value = paper_error(row)[parameter];
        series.x.push_back(static_cast<double>(i + 1));
        series.y.push_back(value);
        if (value) largest = std::max(largest, std::abs(*value));
      }
      if (std::any_of(series.y.begin(), series.y.end(), [](const auto& value) { return value.has_value(); }))
        curves.push_back(std::move(series));
    }
    ChartAxes axes;
    axes.left = kLeft + static_cast<double>(parameter % 3) * (kLeft + kWidth);
    axes.top = kTitleHeight + 60.0 + static_cast<double>(parameter / 3) * (kHeight + kGap);
    axes.width = kWidth;
    axes.height = kHeight;
    axes.x_low = 0.5;
    axes.x_high = static_cast<double>(runs) + 2.5;
    axes.y_high = largest > 0.0 ? round_up(largest) : 1.0;
    axes.y_low = -axes.y_high;
    draw_axes(axes, {kAxisNames[parameter], "run", "", true}, &figure);
    for (std::size_t m = 0; m < curves.size(); ++m) {
      draw_series(axes, curves[m], &figure);
      std::vector<double> values;
      for (const auto& value : curves[m].y)
        if (value) values.push_back(*value);
      const double x =
          static_cast<double>(runs) + 0.9 + 1.4 * static_cast<double>(m) / static_cast<double>(curves.size());
      const double middle = *mean(values), spread = deviation(values).value_or(0.0);
      figure.line(axes.at(x, middle - spread), axes.at(x, middle + spread), curves[m].color, 2.0);
      figure.disc(axes.at(x, middle), 3.0, curves[m].color);
    }
    if (curves.size() > legend.size()) legend = curves;
  }
  draw_legend(legend, {kMargin, kTitleHeight + 12.0}, &figure);
  return figure.save(file);
}

std::vector<std::filesystem::path> draw_table1(const SweepRows& rows, const std::filesystem::path& folder) {
  std::vector<DotRow> list;
  for (const auto& [label, condition] : conditions_along(rows, "images"))
    for (const SweepSubject subject : {SweepSubject::kCamera, SweepSubject::kPair})
      list.push_back(
          dot_row(rows, condition, subject, true, name_of(subject) + (label.empty() ? "" : ", images " + label)));
  return draw_dot_rows(rows, list, "Tables 1 and 2: synthetic worlds", folder / "table1");
}

std::vector<std::filesystem::path> draw_table3(const SweepRows& rows, const std::filesystem::path& folder) {
  const SweepRows against_li = against_method(rows, "li");
  std::vector<std::filesystem::path> files = draw_dot_rows(
      rows,
      {dot_row(against_li, {}, SweepSubject::kPair, false, "camera to camera, against li as in the paper"),
       dot_row(rows, {}, SweepSubject::kPair, false, "camera to camera, against the truth")},
      "Table 3: the real robot's twin", folder / "table3");
  std::vector<std::string> cameras;
  for (const SweepRow& row : rows.rows)
    if (row.subject == SweepSubject::kCamera && std::find(cameras.begin(), cameras.end(), row.camera) == cameras.end())
      cameras.push_back(row.camera);
  for (const std::string& camera : cameras)
    for (const auto& file : draw_repeatability(rows, camera, folder / ("repeatability_" + camera)))
      files.push_back(file);
  return files;
}

}  // namespace

std::vector<std::filesystem::path> draw_paper(const std::string& experiment, const SweepRows& rows,
                                              const std::filesystem::path& folder) {
  if (experiment == "table1") return draw_table1(rows, folder);
  if (experiment == "table3") return draw_table3(rows, folder);
  if (experiment == "quantity")
    return draw_experiment_curves(rows, "stops", "", "Error over the number of images", folder / "quantity");
  return draw_experiment_curves(rows, "lambda", "model", "Error over the odometry's noise", folder / "odometry");
}

}  // namespace rigproof::paper
