#include "rigproof/core/recording.h"

#include <algorithm>

#include "csv.h"
#include "frame_list.h"
#include "rigproof/core/board_markers.h"
#include "rigproof/core/file_schemas.h"
#include "rigproof/core/files.h"
#include "rigproof/core/odometry_csv.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

void visit_odometry(FieldVisitor& visitor, Rig& rig) {
  const auto read_file = [&rig](const std::string& file) { rig.odometry_file = file; };
  if (visitor.instead({{}, "the file alone", read_file})) return;
  visitor.field("file", rig.odometry_file, TextChoices{}, "CSV file inside of the recording: stamp_s,x_m,y_m,yaw_rad");
  visitor.nested("noise", rig.odometry_noise, "what is known of its noise; what is left out is estimated");
}

// ----------------------------------------------------------------------------------------------------- segments.csv

constexpr const char* kSegmentsFile = "segments.csv";
constexpr std::uintmax_t kMaxSegmentsBytes = 1U << 20U;
const std::vector<std::string> kSegmentColumns = {"kind", "begin_s", "end_s"};

std::optional<RecordingSegment> read_segment(const CsvColumns& columns, const std::vector<std::string_view>& fields,
                                             int line, LimitedProblems* problems) {
  const std::string_view kind = columns.get(fields, 0), begin = columns.get(fields, 1), end = columns.get(fields, 2);
  const auto begin_s = parse_number(begin), end_s = parse_number(end);
  if (const std::string surplus = columns.surplus(fields); !surplus.empty()) problems->add(line, "", "", surplus);
  if (kind != kStraightSegment) problems->add(line, "kind", kind, "allowed is straight");
  if (!begin_s) problems->add(line, "begin_s", begin, "must be a finite number");
  if (!end_s) problems->add(line, "end_s", end, "must be a finite number");
  if (!begin_s || !end_s) return std::nullopt;
  if (*end_s < *begin_s) problems->add(line, "end_s", end, "lies before begin_s");
  return RecordingSegment{std::string(kind), *begin_s, *end_s};
}

std::vector<RecordingSegment> read_segments(const fs::path& file, Problems* problems) {
  std::vector<RecordingSegment> segments;
  const std::string text = read_text_file(file, kMaxSegmentsBytes);
  LimitedProblems limited(file.string());
  CsvLines lines(text);
  CsvColumns columns;
  std::vector<std::string_view> fields;
  Problems header;
  if (is_binary(text) || !lines.next(&fields) ||
      !columns.read_header(fields, kSegmentColumns, 3, file.string(), lines.line(), &header))
    header.add({file.string(), 0, "", "", "the first line must be kind,begin_s,end_s"});
  problems->append(header);
  if (!header.empty()) return segments;
  while (lines.next(&fields))
    if (auto segment = read_segment(columns, fields, lines.line(), &limited)) segments.push_back(std::move(*segment));
  limited.move_to(problems);
  return segments;
}

std::string segments_csv(const std::vector<RecordingSegment>& segments) {
  std::string text = "kind,begin_s,end_s\n";
  for (const RecordingSegment& segment : segments)
    text += segment.kind + "," + number_text(segment.begin_s) + "," + number_text(segment.end_s) + "\n";
  return text;
}

fs::path rig_file(const fs::path& folder) { return folder / "rig.yaml"; }

}  // namespace

namespace {

// One problem at most. Boards that were not read are no boards.
void check_told_apart(FieldVisitor& visitor, const Rig& rig) {
  if (!visitor.is_reading() || !visitor.problems()->empty()) return;
  for (int b = 1; b < rig.boards(); ++b)
    for (int a = 0; a < b; ++a) {
      const std::optional<std::string> problem = problem_of_telling_apart(rig.board_at(a), rig.board_at(b));
      if (!problem) continue;
      visitor.check(false, "more_boards",
                    "boards " + std::to_string(a + 1) + " and " + std::to_string(b + 1) +
                        " cannot be told apart in images: " + *problem);
      return;
    }
}

}  // namespace

void visit_rig(FieldVisitor& visitor, const fs::path& folder, Rig& rig) {
  visitor.optional("name", rig.name, "for people");
  visitor.field("robot_frame", rig.robot_frame, TextChoices{}, "name of the robot frame in results");
  visitor.require("board", "{squares: [columns, rows], square_mm: side}");
  visitor.nested("board", rig.board, "the calibration board");
  visit_more_boards(visitor, rig.more_boards);
  check_told_apart(visitor, rig);
  visitor.section(
      "odometry", [&rig](FieldVisitor& block) { visit_odometry(block, rig); }, "what the wheels told");
  visitor.require("cameras", "a map of cameras by name");
  RigReadOptions options;
  options.folder = folder;
  visit_rig_cameras(visitor, options, rig.cameras);
  visitor.nested("accept", rig.accept,
                 "one sigma that calibrate may state of each camera in the robot; beyond it the exit code is 1");
  for (const RigCamera& camera : rig.cameras)
    visitor.check(camera.name != rig.robot_frame, "robot_frame",
                  "is the name of a camera, too; frames must have names of their own");
  visitor.tolerate("x-");
}

std::string rig_schema() {
  Rig rig;
  return schema_of_fields("Rigproof rig: rig.yaml of a recording",
                          [&rig](FieldVisitor& visitor) { visit_rig(visitor, {}, rig); }, {1, false});
}

Rig load_rig(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  Rig rig;
  read_fields_of_tree(read_yaml_file(file), [&](FieldVisitor& visitor) { visit_rig(visitor, folder, rig); });
  return rig;
}

std::string rig_text(const Rig& rig) {
  Rig copy = rig;
  return write_fields([&copy](FieldVisitor& visitor) { visit_rig(visitor, {}, copy); });
}

void save_rig(const Rig& rig, const fs::path& file) { write_file_atomically(file, rig_text(rig)); }

std::vector<OdometrySample> odometry_of_origin(const Recording& recording) {
  std::vector<OdometrySample> odometry = recording.odometry;
  for (OdometrySample& sample : odometry) {
    const Eigen::Vector3d pose =
        odometry_of_point({sample.x_m, sample.y_m, sample.yaw_rad}, -recording.rig.odometry_noise.rotation_centre_m);
    sample.x_m = pose.x();
    sample.y_m = pose.y();
  }
  return odometry;
}

Recording load_recording(const fs::path& folder) {
  Recording recording;
  recording.folder = folder;
  Problems problems;
  read_fields_of_block(read_yaml_file(rig_file(folder)), "", &problems,
                       [&](FieldVisitor& visitor) { visit_rig(visitor, folder, recording.rig); });
  problems.sort();
  try {
    recording.odometry = read_odometry_csv(path_inside(folder, recording.rig.odometry_file), &problems);
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain) throw;
    problems.add({"", 0, "", "", error.what()});
  }
  for (const RigCamera& camera : recording.rig.cameras)
    recording.frames.push_back(list_frames(folder, camera, recording.odometry, &problems));
  if (std::error_code ignored; fs::exists(folder / kSegmentsFile, ignored))
    recording.segments = read_segments(path_inside(folder, kSegmentsFile), &problems);
  problems.throw_if_any();
  return recording;
}

void save_recording(const Recording& recording) {
  const Rig& rig = recording.rig;
  if (recording.frames.size() != rig.cameras.size())
    throw Error("save_recording: " + std::to_string(recording.frames.size()) + " lists of frames for " +
                std::to_string(rig.cameras.size()) + " cameras");
  save_rig(rig, rig_file(recording.folder));
  write_file_atomically(path_inside(recording.folder, rig.odometry_file), odometry_csv(recording.odometry));
  if (!recording.segments.empty())
    write_file_atomically(path_inside(recording.folder, kSegmentsFile), segments_csv(recording.segments));
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const std::string& camera_folder = rig.cameras[i].folder;
    write_file_atomically(path_inside(recording.folder, camera_folder) / "frames.csv",
                          frames_csv(recording.frames[i], camera_folder));
  }
}

bool Recording::in_segment(const CameraFrame& frame) const {
  return std::any_of(segments.begin(), segments.end(),
                     [&](const RecordingSegment& segment) { return segment.holds(frame.stamp_s); });
}

std::vector<CameraFrame> Recording::frames_of(const RecordingSegment& segment, std::size_t camera) const {
  std::vector<CameraFrame> within;
  std::copy_if(frames.at(camera).begin(), frames.at(camera).end(), std::back_inserter(within),
               [&](const CameraFrame& frame) { return segment.holds(frame.stamp_s); });
  return within;
}

}  // namespace rigproof
