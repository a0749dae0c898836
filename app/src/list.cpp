// `rigproof methods`, `scenes`, `rigs`, `robots`, `sensors`, `boards`: what there is.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "json_text.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/text.h"
#include "rigproof/sim/models.h"
#include "terminal.h"

namespace rigproof {
namespace {

/// One thing in a list: its name, then what is said about it.
struct Entry {
  std::string name;
  std::vector<std::pair<std::string, std::string>> facts;
};

std::vector<Entry> list_methods() {
  std::vector<Entry> entries;
  for (const Method* method : all_methods()) {
    const MethodTraits traits = method->traits();
    const bool is_default = method == &default_method();
    entries.push_back({traits.name + (is_default ? " (default)" : ""),
                       {{"summary", traits.summary}, {"needs", traits.needs}, {"gives", traits.gives}}});
  }
  return entries;
}

std::vector<Entry> list_scenes() {
  std::vector<Entry> entries;
  for (const std::string& name : scene_model_names()) {
    const SceneModel scene = load_scene_model(name);
    entries.push_back({name, {{"summary", scene.description}, {"place", scene.outdoor ? "outdoor" : "indoor"}}});
  }
  return entries;
}

std::vector<Entry> list_rigs() {
  std::vector<Entry> entries;
  for (const std::string& name : rig_model_names()) {
    const RigModel rig = load_rig_model(name);
    std::vector<std::string> cameras;
    for (const RigCamera& camera : rig.rig.cameras) cameras.push_back(camera.name + " (" + camera.sensor + ")");
    entries.push_back({name, {{"summary", rig.description}, {"robot", rig.robot.name}, {"cameras", joined(cameras)}}});
  }
  return entries;
}

std::vector<Entry> list_robots() {
  std::vector<Entry> entries;
  for (const std::string& name : list_presets("robots")) {
    const RobotModel robot = load_robot_model(name);
    entries.push_back({name,
                       {{"summary", robot.description},
                        {"size", number_text(robot.footprint_length_m) + " x " + number_text(robot.footprint_width_m) +
                                     " m, " + number_text(robot.mass_kg) + " kg"},
                        {"wheels", "radius " + number_text(robot.wheel_radius_m) + " m, track " +
                                       number_text(robot.track_m) + " m"}}});
  }
  return entries;
}

std::string field_of_view(const Camera& camera) {
  Eigen::Vector3d left, right;
  if (!camera.unproject({-0.5, camera.cy_px}, &left) ||
      !camera.unproject({camera.width_px - 0.5, camera.cy_px}, &right))
    return "";
  return ", " + number_text(std::round(rad_to_deg(std::atan(right.x()) - std::atan(left.x())))) + " deg wide";
}

std::string depth_in_words(const DepthStream& depth) {
  const auto sigma_at = [&depth](double z_m) {
    return number_text(std::round(depth.noise.sigma_m(z_m) * 1e4) / 10.0) + " mm at " + number_text(z_m) + " m";
  };
  // 4 m, or the end of the range where that is nearer.
  return number_text(depth.min_m) + " to " + number_text(depth.max_m) + " m, sigma " + sigma_at(1.0) + ", " +
         sigma_at(std::min(4.0, depth.max_m));
}

std::vector<Entry> list_sensors() {
  std::vector<Entry> entries;
  for (const std::string& name : list_presets("sensors")) {
    const SensorPreset sensor = load_sensor_preset(name);
    const Camera& camera = sensor.camera;
    const std::string color = std::to_string(camera.width_px) + " x " + std::to_string(camera.height_px) + " px, " +
                              lens_name(camera.lens) + field_of_view(camera);
    entries.push_back({name,
                       {{"summary", sensor.description},
                        {"color", color},
                        {"depth", sensor.depth ? depth_in_words(*sensor.depth) : "none"}}});
  }
  return entries;
}

std::vector<Entry> list_boards() {
  std::vector<Entry> entries;
  for (const std::string& name : list_presets("boards")) {
    const Board board = load_board(name);
    entries.push_back({name,
                       {{"type", board.type},
                        {"squares", std::to_string(board.squares_x) + " x " + std::to_string(board.squares_y) + " of " +
                                        number_text(board.square_m * 1000.0) + " mm"}}});
  }
  return entries;
}

}  // namespace

int list_command(const CommonArguments& common, const std::string& kind) {
  const std::map<std::string, std::function<std::vector<Entry>()>> lists = {
      {"methods", list_methods}, {"scenes", list_scenes},   {"rigs", list_rigs},
      {"robots", list_robots},   {"sensors", list_sensors}, {"boards", list_boards}};
  const std::vector<Entry> entries = lists.at(kind)();
  if (common.json) {
    nlohmann::json json = nlohmann::json::array();
    for (const Entry& entry : entries) {
      nlohmann::json item = {{"name", entry.name.substr(0, entry.name.find(' '))}};
      for (const auto& [key, value] : entry.facts) item[key] = value;
      json.push_back(item);
    }
    std::puts(json_text(json).c_str());
    return 0;
  }
  const Terminal terminal(common.quiet);
  for (const Entry& entry : entries) {
    terminal.line(entry.name);
    for (const auto& [key, value] : entry.facts) terminal.line("  " + key + std::string(9 - key.size(), ' ') + value);
  }
  return 0;
}

}  // namespace rigproof
