// `rigproof suggest`.
#include "rigproof/calib/plan/suggest.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "json_text.h"
#include "observing.h"
#include "print_result.h"
#include "rigproof/calib/diagnose/ml_settings.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/figures.h"
#include "rigproof/core/files.h"
#include "rigproof/core/yaml.h"
#include "rigproof/study/export/export.h"
#include "rigproof/study/workflow/workflow.h"
#include "rigproof/truth/stop_at.h"
#include "rigproof/words/sentences.h"

namespace rigproof {
namespace {

MlOptions ml_options_of(const std::string& method) {
  const std::string prefix = kMlPrefix;
  if (method == ml_method().traits().name) return {};
  if (method.rfind(prefix, 0) != 0)
    throw Error("--method: " + for_message(method) + ": allowed: ml, ml:KEY=VALUE,.. or ml:FILE.yaml");
  return read_ml_settings(method.substr(prefix.size())).options();
}

SuggestOptions options_of(const SuggestArguments& arguments) {
  SuggestOptions options;
  options.ml = ml_options_of(arguments.method);
  options.stops = arguments.stops;
  options.criterion = arguments.criterion == "D"   ? SuggestCriterion::kDeterminant
                      : arguments.criterion == "E" ? SuggestCriterion::kEigenvalue
                                                   : SuggestCriterion::kWorstAxis;
  if (arguments.area_m.size() == 4)
    options.area = DriveArea{arguments.area_m[0], arguments.area_m[1], arguments.area_m[2], arguments.area_m[3]};
  options.reach_m = arguments.reach_m;
  options.clearance_m = arguments.clearance_m;
  options.min_turn_rad = deg_to_rad(arguments.min_turn_deg);
  options.min_cameras = arguments.min_cameras;
  options.candidates = arguments.candidates;
  options.min_gain = 0.01 * arguments.min_gain_percent;
  options.seed = arguments.seed;
  return options;
}

// By the robot's tree of frames beside the recording, where there is one.
std::vector<std::optional<Rigid3>> as_mounted(const Input& input, const Observations& observations) {
  const FrameTree frames = read_rig_facts(input.path).tf_static;
  std::vector<std::optional<Rigid3>> mounts;
  for (const RigCamera& camera : observations.cameras) {
    const std::optional<Rigid3> T_robot_optical =
        frames.between(observations.robot_frame, optical_frame_name(camera.name, camera.link, camera.optical_frame));
    const std::optional<Rigid3> T_robot_link = frames.between(observations.robot_frame, camera.link);
    mounts.push_back(T_robot_optical || !T_robot_link || !camera.T_link_camera
                         ? T_robot_optical
                         : std::optional<Rigid3>(*T_robot_link * *camera.T_link_camera));
  }
  return mounts;
}

double in_unit(double sigma, std::size_t axis) { return axis < 3 ? 100.0 * sigma : rad_to_deg(sigma); }

std::string sigma_text(const std::optional<double>& sigma, std::size_t axis) {
  if (!sigma) return "-";
  const double value = in_unit(*sigma, axis);
  return figure(value, decimals_for_sigma(value));
}

std::vector<std::string> gain_lines(const Suggestion& suggestion) {
  std::vector<std::vector<std::string>> rows = {with_axis_heads({"one sigma, now > then"})};
  for (const CameraForecast& camera : suggestion.cameras) {
    rows.push_back({" " + camera.camera});
    for (std::size_t axis = 0; axis < 6; ++axis)
      rows.back().push_back(sigma_text(camera.now[axis], axis) + " > " + sigma_text(camera.then[axis], axis));
  }
  return aligned(rows);
}

std::string names_of(const std::vector<int>& cameras, const Observations& observations) {
  std::vector<std::string> names;
  for (const int camera : cameras) names.push_back(observations.cameras[static_cast<std::size_t>(camera)].name);
  return joined(names);
}

double limit_of(const AcceptLimits& limits, std::size_t axis) {
  return axis < 2 ? limits.xy_m : axis == 2 ? limits.z_m : limits.angle_rad;
}

// "worst then: right ty .44 cm, accepted 0.8 cm".
std::string worst_text(const Suggestion& suggestion) {
  std::string text;
  double worst = 0.0;
  for (const CameraForecast& camera : suggestion.cameras) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const double limit = limit_of(suggestion.limits, axis), share = camera.then[axis].value_or(0.0) / limit;
      if (share <= worst) continue;
      worst = share;
      text = "worst: " + camera.camera + " " + kSpokenAxisNames[axis] + " " + sigma_text(camera.then[axis], axis) +
             ", accepted " + plain_figure(in_unit(limit, axis)) + (axis < 3 ? " cm" : " deg");
    }
  }
  return text;
}

// "board in left; rear may see it": what is known of a camera's mount tells more than its images so far.
std::string seen_text(const SuggestedStop& stop, const Observations& observations, const SuggestOptions& options) {
  std::vector<int> mounted, unknown;
  for (const int camera : stop.hoped)
    (options.T_robot_camera_as_mounted[static_cast<std::size_t>(camera)] ? mounted : unknown).push_back(camera);
  std::vector<std::string> parts;
  if (!stop.cameras.empty()) parts.push_back("board in " + names_of(stop.cameras, observations));
  if (!mounted.empty())
    parts.push_back(names_of(mounted, observations) + (mounted.size() == 1 ? " sees" : " see") +
                    " the board, as mounted");
  if (!unknown.empty()) parts.push_back(names_of(unknown, observations) + " may see the board");
  return joined(parts, "; ");
}

void print(const Terminal& terminal, const Suggestion& suggestion, const Observations& observations,
           const SuggestOptions& options) {
  terminal.line(std::to_string(observations.cameras.size()) + " cameras x " +
                std::to_string(observations.stops.size()) + " stops: " + result_status_name(suggestion.status_now));
  const std::vector<std::string> reasons_now = words::sentences_of(suggestion.reasons_now);
  for (const std::string& reason : reasons_now) terminal.line("NOW      " + reason);
  for (std::size_t i = 0; i < suggestion.stops.size(); ++i) {
    const SuggestedStop& stop = suggestion.stops[i];
    terminal.line((i == 0 ? terminal.colored("NEXT", Color::kGood) : std::string("    ")) + "  " + (i < 9 ? " " : "") +
                  std::to_string(i + 1) + "  " + stop.command.text() + "  (" + seen_text(stop, observations, options) +
                  ")");
  }
  for (const std::string& line : gain_lines(suggestion)) terminal.line(line);
  const std::string worst = worst_text(suggestion);
  terminal.line(std::string("THEN     ") + result_status_name(suggestion.status_then) +
                (worst.empty() ? "" : "; " + worst));
  for (const std::string& reason : words::sentences_of(suggestion.reasons_then))
    if (std::find(reasons_now.begin(), reasons_now.end(), reason) == reasons_now.end())
      terminal.line("         " + reason);
  for (const std::string& note : words::sentences_of(suggestion.notes))
    terminal.line(terminal.colored("NOTE", Color::kWarning) + "     " + note);
}

nlohmann::json sigmas_as_json(const AxisSigmas& sigmas) {
  nlohmann::json json;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const std::string key = std::string(kDegreeOfFreedomNames[axis]) + (axis < 3 ? "_m" : "_rad");
    json[key] = sigmas[axis] ? nlohmann::json(*sigmas[axis]) : nlohmann::json(nullptr);
  }
  return json;
}

std::string as_json(const Suggestion& suggestion, const Observations& observations) {
  nlohmann::json json = {{"status_now", result_status_name(suggestion.status_now)},
                         {"status_then", result_status_name(suggestion.status_then)},
                         {"reasons_now", json_of(suggestion.reasons_now)},
                         {"reasons_then", json_of(suggestion.reasons_then)},
                         {"notes", json_of(suggestion.notes)},
                         {"nothing_helps", suggestion.nothing_helps},
                         {"stops", nlohmann::json::array()},
                         {"cameras", nlohmann::json::array()}};
  for (const SuggestedStop& stop : suggestion.stops) {
    const auto names = [&observations](const std::vector<int>& cameras) {
      nlohmann::json list = nlohmann::json::array();
      for (const int camera : cameras) list.push_back(observations.cameras[static_cast<std::size_t>(camera)].name);
      return list;
    };
    json["stops"].push_back({{"command", stop.command.text()},
                             {"turn_before_deg", rad_to_deg(stop.command.turn_before_rad)},
                             {"distance_m", stop.command.distance_m},
                             {"turn_after_deg", rad_to_deg(stop.command.turn_after_rad)},
                             {"x_m", stop.T_world_robot.translation.x()},
                             {"y_m", stop.T_world_robot.translation.y()},
                             {"yaw_deg", rad_to_deg(yaw_of(stop.T_world_robot))},
                             {"cameras", names(stop.cameras)},
                             {"hoped", names(stop.hoped)}});
  }
  for (const CameraForecast& camera : suggestion.cameras)
    json["cameras"].push_back(
        {{"camera", camera.camera}, {"now", sigmas_as_json(camera.now)}, {"then", sigmas_as_json(camera.then)}});
  return json_text(json);
}

// On the floor below the board's centre, x towards its viewers.
Rigid3 T_world_board_on_floor(const Rigid3& T_world_board, const Board& board) {
  const Eigen::Vector3d centre = T_world_board * board.centre();
  const Eigen::Vector3d outward = -(T_world_board.rotation * Eigen::Vector3d::UnitZ());
  return planar_pose(centre.x(), centre.y(), std::atan2(outward.y(), outward.x()));
}

// Where the robot truly stood at the stops that calibration uses: frames of a straight drive are none. Empty where the
// truth does not know all of them.
std::vector<Rigid3> true_places(const Observations& observations, const Truth& truth) {
  std::vector<Rigid3> T_world_robot;
  for (const Stop& stop : observations.stops) {
    const std::optional<Rigid3> T = robot_at(truth, stop.stamp_s);
    if (!T) return {};
    T_world_robot.push_back(*T);
  }
  return T_world_robot;
}

// All stops, from the board. Those so far stand where the robot truly stood if that is known (a simulated run), else
// where it is estimated to have stood; the robot drives on from there.
YamlTree listed_stops(const Suggestion& suggestion, const Observations& observations,
                      const std::optional<Truth>& truth) {
  std::vector<Rigid3> T_world_robot = truth ? true_places(observations, *truth) : std::vector<Rigid3>();
  Rigid3 T_board_world;
  if (T_world_robot.empty()) {
    const auto of_first = [](const BoardView& view) { return view.board == 0; };
    if (std::none_of(observations.board_views.begin(), observations.board_views.end(), of_first))
      throw Error("--output: stops are told from the first board of rig.yaml, which is in no image");
    T_world_robot = suggestion.T_world_robot;
    T_board_world = T_world_board_on_floor(suggestion.T_world_board, observations.board).inverse();
  } else {
    T_board_world = T_world_board_on_floor(truth->T_world_board, truth->board).inverse();
  }
  for (const SuggestedStop& stop : suggestion.stops)
    T_world_robot.push_back(T_world_robot.back() * stop.command.motion());
  YamlTree list = YamlTree::sequence();
  for (const Rigid3& T : T_world_robot) {
    const Rigid3 T_board_robot = T_board_world * T;
    YamlTree place = YamlTree::inline_map();
    place.set("x_m", YamlTree::number(T_board_robot.translation.x()));
    place.set("y_m", YamlTree::number(T_board_robot.translation.y()));
    place.set("yaw_deg", YamlTree::number(rad_to_deg(yaw_of(T_board_robot))));
    list.add(std::move(place));
  }
  return list;
}

void save_replay(const std::filesystem::path& file, const Suggestion& suggestion, const Observations& observations,
                 const Input& input) {
  const std::optional<Truth> truth = truth_beside(input);
  YamlTree tree = YamlTree::map();
  const std::filesystem::path config = RunFolder{input.path}.config_file();
  if (truth && std::filesystem::is_regular_file(config)) {
    const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
    tree.set("include", YamlTree::text(std::filesystem::weakly_canonical(config)
                                           .lexically_relative(std::filesystem::weakly_canonical(folder))
                                           .generic_string()));
  }
  tree.set("name", YamlTree::text(file.stem().string()));
  YamlTree viewpoints = YamlTree::map();
  viewpoints.set("planner", YamlTree::text("list"));
  viewpoints.set("list_frame", YamlTree::text("board"));
  viewpoints.set("list", listed_stops(suggestion, observations, truth));
  tree.set("viewpoints", std::move(viewpoints));
  if (tree.find("include") != nullptr) {  // its straight drive is not driven again
    YamlTree straight_drive = YamlTree::map();
    straight_drive.set("frames", YamlTree::integer(0));
    tree.set("straight_drive", std::move(straight_drive));
  }
  std::string text = "# By rigproof suggest: the stops so far, then\n";
  for (const SuggestedStop& stop : suggestion.stops) text += "#   " + stop.command.text() + "\n";
  write_file_atomically(file, text + emit_yaml(tree));
}

}  // namespace

int suggest_command(const SuggestArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  SuggestOptions options = options_of(arguments);
  const Input input = open_input(arguments.input);
  const Observations observations = observe_with_progress(input, arguments.common.jobs, terminal);
  options.T_robot_camera_as_mounted = as_mounted(input, observations);
  const Suggestion suggestion = suggest_stops(observations, options);
  if (!arguments.output.empty() && !suggestion.stops.empty())
    save_replay(arguments.output, suggestion, observations, input);
  if (arguments.common.json) std::puts(as_json(suggestion, observations).c_str());
  print(terminal, suggestion, observations, options);
  if (!arguments.output.empty() && !suggestion.stops.empty()) terminal.line("viewpoints  " + arguments.output.string());
  return static_cast<int>(suggestion.stops.empty() && !suggestion.nothing_helps ? ExitCode::kRefused : ExitCode::kGood);
}

}  // namespace rigproof
