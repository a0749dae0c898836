#include "rigproof/core/odometry_csv.h"

#include "csv.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

// An hour at 1 kHz with 14 columns.
constexpr std::uintmax_t kMaxBytes = 512U << 20U;
const std::vector<std::string> kColumns = {"stamp_s", "x_m", "y_m", "yaw_rad"};

void read_row(const CsvColumns& columns, const std::vector<std::string_view>& fields, int line,
              std::vector<OdometrySample>* odometry, LimitedProblems* problems) {
  if (fields.size() < columns.fields_needed()) {
    problems->add(line, "", "",
                  "has " + std::to_string(fields.size()) + " columns; " + std::to_string(columns.fields_needed()) +
                      " are needed: stamp_s,x_m,y_m,yaw_rad, separated by commas");
    return;
  }
  if (const std::string surplus = columns.surplus(fields); !surplus.empty()) {
    problems->add(line, "", "", surplus + ": stamp_s,x_m,y_m,yaw_rad are needed");
    return;
  }
  OdometrySample sample;
  double* const values[] = {&sample.stamp_s, &sample.x_m, &sample.y_m, &sample.yaw_rad};
  bool good = true;
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const std::string_view field = columns.get(fields, i);
    const std::optional<double> number = parse_number(field);
    if (!number) problems->add(line, kColumns[i], field, "must be a finite number");
    good = good && number;
    *values[i] = number.value_or(0.0);
  }
  if (!good) return;
  if (!odometry->empty() && !(sample.stamp_s > odometry->back().stamp_s)) {
    const bool repeats = sample.stamp_s == odometry->back().stamp_s;
    problems->add(line, "stamp_s", columns.get(fields, 0),
                  (repeats ? "repeats the stamp of the row before" : "goes back in time") +
                      std::string("; stamps must increase"));
    return;
  }
  odometry->push_back(sample);
}

}  // namespace

std::vector<OdometrySample> read_odometry_csv(const std::filesystem::path& file, Problems* problems) {
  std::vector<OdometrySample> odometry;
  std::string text;
  try {
    text = read_text_file(file, kMaxBytes);
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain) throw;
    problems->add({"", 0, "", "", error.what()});
    return odometry;
  }
  if (is_binary(text)) {
    problems->add({file.string(), 0, "", "", "is no text; it needs rows of stamp_s,x_m,y_m,yaw_rad"});
    return odometry;
  }
  LimitedProblems limited(file.string());
  CsvLines lines(text);
  CsvColumns columns;
  std::vector<std::string_view> fields;
  bool first = true, any_row = false;
  Problems header_problems;
  while (header_problems.empty() && lines.next(&fields)) {
    const bool header =
        first && columns.read_header(fields, kColumns, kColumns.size(), file.string(), lines.line(), &header_problems);
    first = false;
    any_row = any_row || !header;
    if (!header) read_row(columns, fields, lines.line(), &odometry, &limited);
  }
  problems->append(header_problems);
  limited.move_to(problems);
  if (!any_row && header_problems.empty())
    problems->add({file.string(), 0, "", "", "is empty; it needs rows of stamp_s,x_m,y_m,yaw_rad"});
  return odometry;
}

bool has_odometry_header(const std::filesystem::path& file) {
  const std::string text = read_text_file(file, kMaxBytes);
  std::vector<std::string_view> fields;
  CsvLines lines(text);
  Problems ignored;
  return !lines.next(&fields) ||
         CsvColumns().read_header(fields, kColumns, kColumns.size(), file.string(), lines.line(), &ignored);
}

std::string odometry_csv(const std::vector<OdometrySample>& odometry) {
  std::string text = joined(kColumns, ",") + "\n";
  for (const OdometrySample& s : odometry)
    text += number_text(s.stamp_s) + "," + number_text(s.x_m) + "," + number_text(s.y_m) + "," +
            number_text(s.yaw_rad) + "\n";
  return text;
}

}  // namespace rigproof
