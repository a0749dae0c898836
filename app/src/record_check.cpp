// `rigproof record-check`: what a drive shows of the board so far, and what is missing.
#include "rigproof/study/import/record_check.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "board_options.h"
#include "commands.h"
#include "json_text.h"
#include "print_result.h"
#include "rigproof/core/error.h"
#include "rigproof/core/image_cell.h"
#include "rigproof/core/text.h"
#include "rigproof/words/sentences.h"
#include "terminal.h"

namespace rigproof {
namespace {

using Clock = std::chrono::steady_clock;

RecordCheckOptions options_of(const RecordCheckArguments& arguments) {
  RecordCheckOptions options;
  options.source.source = arguments.source;
  const BoardOptions board{arguments.board, "", arguments.squares, arguments.squares.empty() ? 0.0 : 100.0};
  if (board.any()) options.source.board = board_of(board);
  options.source.odometry = arguments.odometry;
  options.source.topics = arguments.topics;
  options.source.camera_infos = arguments.camera_infos;
  options.source.log_stamps = arguments.stamps == "log";
  options.growing = arguments.follow;
  return options;
}

// ----------------------------------------------------------------------------------------------------------------
// words

std::string counted_text(std::size_t count, const char* what) {
  return count == 0 ? "" : std::to_string(count) + " " + what;
}

std::string faults_of(const CameraCheck& camera) {
  std::vector<std::string> faults = {counted_text(camera.blurred, "blurred"),
                                     counted_text(camera.overexposed, "overexposed"),
                                     counted_text(camera.underexposed, "underexposed")};
  for (const Finding& finding : camera.left_out)
    if (const FindingValue* count = finding.find("count"); !finding.is("board.blurred"))
      faults.push_back(number_text(std::get<double>(count->value)) + " " + words::short_of(finding));
  faults.erase(std::remove(faults.begin(), faults.end(), ""), faults.end());
  return joined(faults);
}

std::string turn_text(double turn_deg) {
  return "turn " + fixed_text(std::abs(turn_deg), 0) + " deg " + (turn_deg > 0.0 ? "left" : "right");
}

std::string advice_text(const Advice& advice) {
  const std::string cameras = joined(advice.cameras);
  if (!advice.part)
    return turn_text(advice.turn_deg) + " on the spot: " + cameras + (advice.cameras.size() == 1 ? " has" : " have") +
           " not seen the board, nor looked that way";
  const std::string missing =
      "the " + *advice.part + " third of the image of " + cameras + " has hardly shown the board";
  if (advice.turn_deg == 0.0) return "drive nearer to the board or farther away: " + missing;
  return (advice.here ? turn_text(advice.turn_deg)
                      : "drive back to stop " + std::to_string(advice.stop) + " and " + turn_text(advice.turn_deg)) +
         ": " + missing;
}

std::string pairs_text(const RecordCheck& check) {
  std::vector<std::string> pairs;
  for (const PairCheck& pair : check.pairs)
    if (pair.stops > 0) pairs.push_back(pair.first + "-" + pair.second + " " + std::to_string(pair.stops));
  return pairs.empty() ? "no two cameras see the board at one stop" : joined(pairs);
}

std::vector<std::string> summary_of(const Terminal& terminal, const RecordCheck& check) {
  std::vector<std::string> lines = {std::to_string(check.stops) + (check.stops == 1 ? " stop in " : " stops in ") +
                                    duration(check.duration_s) + ", " +
                                    (check.board.empty()
                                         ? "no board found yet; name it: --squares 6x5"
                                         : check.board + (check.board_guessed ? ", as the images show it" : ""))};
  std::vector<std::vector<std::string>> rows = {{" camera", "board in", "parts of image", "edges"}};
  for (const CameraCheck& camera : check.cameras)
    rows.push_back({" " + camera.name, std::to_string(camera.board_stops) + " of " + std::to_string(camera.stops),
                    std::to_string(camera.cells) + " of " + std::to_string(kImageCells),
                    camera.edge_px ? fixed_text(*camera.edge_px, 1) + " px" : "-"});
  std::vector<std::string> table = aligned(rows);
  for (std::size_t i = 0; i < check.cameras.size(); ++i)
    if (const std::string faults = faults_of(check.cameras[i]); !faults.empty()) table[i + 1] += "  " + faults;
  lines.insert(lines.end(), table.begin(), table.end());
  if (check.cameras.size() > 1) lines.push_back("together   " + pairs_text(check));
  if (check.waiting > 0) lines.push_back("waiting    for " + std::to_string(check.waiting) + " images to be whole");
  constexpr std::size_t kMostAdvice = 3;
  for (std::size_t i = 0; i < std::min(kMostAdvice, check.next.size()); ++i)
    lines.push_back((i == 0 ? terminal.colored("NEXT", Color::kGood) : "    ") + "       " +
                    advice_text(check.next[i]));
  return lines;
}

// "stop 5: left 20 corners, rear no board; parts left 31, rear 0": the latest stop.
std::string change_of(const RecordCheck& check) {
  std::vector<std::string> seen, parts;
  for (std::size_t i = 0; i < check.cameras.size(); ++i) {
    const CameraCheck& camera = check.cameras[i];
    parts.push_back(camera.name + " " + std::to_string(camera.cells));
    const std::optional<PictureCheck>& picture = check.pictures.back()[i];
    if (picture)
      seen.push_back(camera.name + " " +
                     (picture->why_not ? words::short_of(*picture->why_not)
                                       : std::to_string(picture->corners.size()) + " corners"));
  }
  return "stop " + std::to_string(check.stops - 1) + ": " + (seen.empty() ? "no image yet" : joined(seen)) +
         "; parts of 48: " + joined(parts) + (check.next.empty() ? "" : "; next: " + advice_text(check.next.front()));
}

// -----------------------------------------------------------------------------------------------------------------
// json

nlohmann::json json_of(const CameraCheck& camera) {
  return {{"name", camera.name},
          {"stops", camera.stops},
          {"board_stops", camera.board_stops},
          {"cells", camera.cells},
          {"edge_px", camera.edge_px ? nlohmann::json(*camera.edge_px) : nlohmann::json()},
          {"blurred", camera.blurred},
          {"overexposed", camera.overexposed},
          {"underexposed", camera.underexposed},
          {"unreadable", camera.unreadable},
          {"left_out", json_of(camera.left_out)}};
}

nlohmann::json json_of(const RecordCheck& check) {
  nlohmann::json json = {{"stops", check.stops},
                         {"duration_s", check.duration_s},
                         {"board", check.board},
                         {"board_guessed", check.board_guessed},
                         {"waiting", check.waiting},
                         {"cameras", nlohmann::json::array()},
                         {"pairs", nlohmann::json::array()},
                         {"next", nlohmann::json::array()}};
  for (const CameraCheck& camera : check.cameras) json["cameras"].push_back(json_of(camera));
  for (const PairCheck& pair : check.pairs)
    json["pairs"].push_back({{"cameras", {pair.first, pair.second}}, {"stops", pair.stops}});
  for (const Advice& advice : check.next)
    json["next"].push_back({{"cameras", advice.cameras},
                            {"turn_deg", advice.turn_deg},
                            {"from_stop", advice.stop},
                            {"image_part", advice.part ? nlohmann::json(*advice.part) : nlohmann::json()},
                            {"text", advice_text(advice)}});
  return json;
}

// ---------------------------------------------------------------------------------------------------------------
// follow

// What stands on the terminal is written over; a pipe gets a line for each change.
class Display {
 public:
  Display(const Terminal& terminal, bool json)
      : terminal_(terminal), json_(json), in_place_(isatty(STDOUT_FILENO) != 0 && !terminal.quiet()) {}

  void change(const RecordCheck& check) {
    if (json_) {
      std::puts(json_text(json_of(check), -1).c_str());
      std::fflush(stdout);
    } else if (in_place_) {
      write_over(summary_of(terminal_, check));
    } else {
      terminal_.line(change_of(check));
    }
  }
  void wait_for(const std::string& what) {
    if (json_ || what == waiting_for_) return;
    waiting_for_ = what;
    if (in_place_)
      write_over({"waiting    " + what});
    else
      terminal_.line("waiting    " + what);
  }
  void finish(const RecordCheck& check) const {
    if (json_ || in_place_) return;
    for (const std::string& line : summary_of(terminal_, check)) terminal_.line(line);
  }

 private:
  void write_over(const std::vector<std::string>& lines) {
    winsize size{};
    const std::size_t columns = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
    std::string text = rows_ == 0 ? "" : "\033[" + std::to_string(rows_) + "A\033[J";
    rows_ = 0;
    for (const std::string& line : lines) {
      text += line + "\n";
      rows_ += std::max<std::size_t>(1, (line.size() + columns - 1) / columns);
    }
    terminal_.text(text);
  }

  const Terminal& terminal_;
  bool json_, in_place_;
  std::size_t rows_ = 0;  // of what stands there
  std::string waiting_for_;
};

// A source that takes long to read is read less often.
void rest_after(Clock::duration look) {
  const Clock::time_point until = Clock::now() + std::max<Clock::duration>(std::chrono::seconds(1), 4 * look);
  while (!interrupted() && Clock::now() < until) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

// Until the user interrupts, or nothing changes for so long.
int follow(RecordWatch& watch, const RecordCheckArguments& arguments, const Terminal& terminal) {
  Display display(terminal, arguments.common.json);
  std::optional<RecordCheck> latest;
  std::optional<Error> problem;
  std::string shown;
  Clock::time_point changed = Clock::now();
  while (!interrupted()) {
    const Clock::time_point begin = Clock::now();
    try {
      latest = watch.look();
      const std::string now = json_of(*latest).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
      if (now != shown) {
        display.change(*latest);
        changed = Clock::now();
      }
      shown = now;
    } catch (const Error& error) {  // half-written, or not there yet
      if (interrupted()) break;
      problem = error;
      display.wait_for(error.what());
    }
    const std::chrono::duration<double> idle = Clock::now() - changed;
    if (arguments.until_idle_s > 0.0 && idle.count() >= arguments.until_idle_s) break;
    rest_after(Clock::now() - begin);
  }
  if (latest)
    display.finish(*latest);
  else if (problem)
    throw Error(*problem);
  return 0;
}

int look_once(RecordWatch& watch, const RecordCheckArguments& arguments, const Terminal& terminal) {
  const RecordCheck check = watch.look();
  if (arguments.common.json) std::puts(json_text(json_of(check)).c_str());
  for (const std::string& line : summary_of(terminal, check)) terminal.line(line);
  return 0;
}

}  // namespace

int record_check_command(const RecordCheckArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  if (arguments.until_idle_s > 0.0 && !arguments.follow) throw Error("--until-idle: belongs to --follow");
  RecordCheckOptions options = options_of(arguments);
  std::optional<ProgressLine> progress;
  if (!arguments.follow) progress.emplace(terminal, "look", "images");
  options.progress = [&progress](std::size_t done, std::size_t total) {
    return progress ? progress->update(done, total) : !interrupted();
  };
  RecordWatch watch(options);
  return arguments.follow ? follow(watch, arguments, terminal) : look_once(watch, arguments, terminal);
}

}  // namespace rigproof
