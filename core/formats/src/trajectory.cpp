#include "rigproof/formats/trajectory.h"

#include <cmath>

#include "rigproof/core/files.h"
#include "rigproof/core/text.h"

namespace rigproof {

TrajectoryFormat euroc_trajectory();
TrajectoryFormat kitti_trajectory();
TrajectoryFormat tum_trajectory();

// A format is a line here.
const std::vector<TrajectoryFormat>& trajectory_formats() {
  static const std::vector<TrajectoryFormat> all = {euroc_trajectory(), kitti_trajectory(), tum_trajectory()};
  return all;
}

namespace {

constexpr std::uintmax_t kMaxBytes = 512U << 20U;
constexpr std::size_t kMostProblems = 20;

std::string_view next_line(std::string_view* rest) {
  const std::size_t end = std::min(rest->find('\n'), rest->size());
  std::string_view line = rest->substr(0, end);
  rest->remove_prefix(std::min(end + 1, rest->size()));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

bool is_comment(const std::vector<std::string_view>& fields) { return fields.empty() || fields.front().front() == '#'; }

// Null where it is none.
const TrajectoryFormat* find_format(std::string_view text) {
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::vector<std::string_view> fields = fields_of(next_line(&rest));
    if (is_comment(fields)) continue;
    const std::string_view head = text.substr(0, text.size() - rest.size());
    for (const TrajectoryFormat& format : trajectory_formats())
      if (format.detect(fields, head)) return &format;
    break;
  }
  return nullptr;
}

const TrajectoryFormat& format_of(const std::filesystem::path& file, std::string_view text) {
  if (const TrajectoryFormat* format = find_format(text)) return *format;
  std::vector<std::string> known;
  for (const TrajectoryFormat& format : trajectory_formats()) known.push_back(format.name + " (" + format.layout + ")");
  throw Error(file.string() + ": is no trajectory; lines of " + joined(known, ", or of ") + " are read");
}

}  // namespace

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  const bool commas = line.find(',') != std::string_view::npos;
  constexpr std::string_view kBlanks = " \t\r";
  while (!line.empty()) {
    const std::size_t end = std::min(commas ? line.find(',') : line.find_first_of(kBlanks), line.size());
    std::string_view field = line.substr(0, end);
    field.remove_prefix(std::min(field.find_first_not_of(kBlanks), field.size()));
    field = field.substr(0, field.find_last_not_of(kBlanks) + 1);
    if (!field.empty()) fields.push_back(field);
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return fields;
}

std::vector<NumberLine> number_lines(const std::filesystem::path& file, std::string_view text, std::size_t width,
                                     const std::string& layout, Problems* problems) {
  std::vector<NumberLine> lines;
  std::string_view rest = text;
  for (int line = 1; !rest.empty() && problems->all().size() < kMostProblems; ++line) {
    const std::vector<std::string_view> fields = fields_of(next_line(&rest));
    if (is_comment(fields)) continue;
    NumberLine row{line, {}};
    for (std::size_t i = 0; i < std::min(width, fields.size()); ++i) {
      const std::optional<double> number = parse_number(fields[i]);
      if (number)
        row.numbers.push_back(*number);
      else
        problems->add(
            {file.string(), line, "", for_message(fields[i]), "must be a finite number; a line is " + layout});
    }
    if (fields.size() < width)
      problems->add(
          {file.string(), line, "", "", "has " + std::to_string(fields.size()) + " numbers; a line is " + layout});
    if (row.numbers.size() == width) lines.push_back(std::move(row));
  }
  return lines;
}

Eigen::Quaterniond quaternion_of(double x, double y, double z, double w, const std::filesystem::path& file, int line,
                                 Problems* problems) {
  const Eigen::Quaterniond rotation(w, x, y, z);
  if (std::abs(rotation.norm() - 1.0) <= 0.01) return rotation.normalized();
  if (problems->all().size() < kMostProblems)
    problems->add(
        {file.string(), line, "quaternion", "", "has the norm " + short_text(rotation.norm(), 4) + "; it must be 1"});
  return Eigen::Quaterniond::Identity();
}

bool looks_like_trajectory(const std::filesystem::path& file) {
  return find_format(read_text_file(file, kMaxBytes)) != nullptr;
}

std::vector<TrajectoryPose> read_trajectory(const std::filesystem::path& file) {
  const std::string text = read_text_file(file, kMaxBytes);
  const TrajectoryFormat& format = format_of(file, text);
  Problems problems;
  std::vector<TrajectoryPose> poses = format.read(file, text, &problems);
  for (std::size_t i = 1; i < poses.size() && problems.empty(); ++i)
    if (!(poses[i].stamp_s > poses[i - 1].stamp_s))
      problems.add({file.string(), 0, "", number_text(poses[i].stamp_s),
                    "does not come after the stamp before; stamps must increase"});
  problems.throw_if_any();
  return poses;
}

}  // namespace rigproof
