// `rigproof init`: a recording out of a bag.
#include "rigproof/study/import/init.h"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "board_options.h"
#include "commands.h"
#include "json_text.h"
#include "print_result.h"
#include "rigproof/core/image_cell.h"
#include "rigproof/core/text.h"
#include "terminal.h"

namespace rigproof {
namespace {

InitOptions options_of(const InitArguments& arguments) {
  InitOptions options;
  options.source = arguments.source;
  options.output = arguments.output;
  const BoardOptions board{arguments.board, "", arguments.squares, arguments.square_mm};
  if (board.any()) options.board = board_of(board);
  options.odometry = arguments.odometry;
  options.topics = arguments.topics;
  options.camera_infos = arguments.camera_infos;
  options.sensors = arguments.sensors;
  options.robot_frame = arguments.robot_frame;
  options.log_stamps = arguments.stamps == "log";
  options.every_image = arguments.every_image;
  options.images_per_stop = arguments.images_per_stop;
  options.threads = arguments.common.jobs;
  return options;
}

// A line for each of the things that take long, one after the other.
class InitProgress {
 public:
  explicit InitProgress(const Terminal& terminal) : terminal_(terminal) {}

  bool update(const std::string& what, std::uint64_t done, std::uint64_t total) {
    const bool bytes = what == "read";
    if (what != what_) {
      line_.reset();
      line_ = std::make_unique<ProgressLine>(terminal_, what, bytes ? "MB" : "images");
      what_ = what;
    }
    constexpr std::uint64_t kMegabyte = 1000000;
    return line_->update(bytes ? done / kMegabyte : done, bytes ? total / kMegabyte : total);
  }
  void finish() { line_.reset(); }

 private:
  const Terminal& terminal_;
  std::string what_;
  std::unique_ptr<ProgressLine> line_;
};

nlohmann::json json_of(const InitReport& report) {
  nlohmann::json json = {{"recording", report.folder.string()},
                         {"robot_frame", report.robot_frame},
                         {"odometry",
                          {{"topic", report.odometry},
                           {"rows", report.odometry_rows},
                           {"duration_s", report.duration_s},
                           {"tilt_deg", report.tilt_deg},
                           {"rise_m", report.rise_m}}},
                         {"stops", report.stops},
                         {"moving_images", report.moving_images},
                         {"cameras", nlohmann::json::array()},
                         {"notes", report.notes},
                         {"missing", report.missing},
                         {"bytes", report.bytes},
                         {"unpacked_bytes", report.unpacked_bytes}};
  for (const InitCamera& camera : report.cameras) {
    json["cameras"].push_back({{"name", camera.name},
                               {"images", camera.images},
                               {"camera_info", camera.camera_info},
                               {"depth", camera.depth.empty() ? nlohmann::json() : nlohmann::json(camera.depth)},
                               {"link", camera.link},
                               {"width_px", camera.width_px},
                               {"height_px", camera.height_px},
                               {"images_in_source", camera.images_in_source},
                               {"images_kept", camera.images_kept},
                               {"depth_kept", camera.depth_kept},
                               {"stops", camera.stops},
                               {"board_stops", nlohmann::json()},
                               {"cells", nlohmann::json()}});
    if (camera.board_stops) json["cameras"].back()["board_stops"] = *camera.board_stops;
    if (camera.board_cells) json["cameras"].back()["cells"] = *camera.board_cells;
  }
  return json;
}

std::string board_text(const InitCamera& camera) {
  if (!camera.board_stops || !camera.board_cells) return "";
  return "board in " + std::to_string(*camera.board_stops) + " of " + std::to_string(camera.stops) + ", " +
         std::to_string(*camera.board_cells) + " of " + std::to_string(kImageCells) + " parts of image";
}

void print_report(const Terminal& terminal, const InitReport& report) {
  std::vector<std::vector<std::string>> rows;
  for (const InitCamera& camera : report.cameras)
    rows.push_back({" " + camera.name, camera.images,
                    std::to_string(camera.width_px) + "x" + std::to_string(camera.height_px),
                    std::to_string(camera.images_kept) + " of " + std::to_string(camera.images_in_source) + " images",
                    std::to_string(camera.depth_kept) + " depth", board_text(camera),
                    camera.link.empty() ? "" : "on " + for_message(camera.link)});
  rows.push_back({" odometry", report.odometry, "", std::to_string(report.odometry_rows) + " rows",
                  fixed_text(report.duration_s, 0) + " s", std::to_string(report.stops) + " stops",
                  report.robot_frame.empty() ? "" : "of " + for_message(report.robot_frame)});
  for (const std::string& line : aligned(rows)) terminal.line(line);
  for (const std::string& note : report.notes) terminal.line(terminal.colored("NOTE", Color::kDim) + "     " + note);
  for (const InitCamera& camera : report.cameras)
    if (camera.board_stops && *camera.board_stops == 0)
      terminal.line(terminal.colored("WARNING", Color::kWarning) + "  " + camera.name + " never sees the whole board");
  for (const std::string& missing : report.missing)
    terminal.line(terminal.colored("MISSING", Color::kWarning) + "  " + missing);
  const std::string calibrate = "rigproof calibrate " + report.folder.string();
  terminal.line("recording  " + report.folder.string() + "  next: " +
                (report.missing.empty()
                     ? calibrate
                     : "write what is missing into " + (report.folder / "rig.yaml").string() + ", then " + calibrate));
}

}  // namespace

int init_command(const InitArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  InitOptions options = options_of(arguments);
  InitProgress progress(terminal);
  options.progress = [&progress](const char* what, std::uint64_t done, std::uint64_t total) {
    return progress.update(what, done, total);
  };
  const InitReport report = init_recording(options);
  progress.finish();
  if (arguments.common.json) std::puts(json_text(json_of(report)).c_str());
  print_report(terminal, report);
  return 0;
}

}  // namespace rigproof
