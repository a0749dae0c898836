#include "rigproof/truth/truth.h"

#include <charconv>

#include "rigproof/core/files.h"
#include "rigproof/core/rig_yaml.h"

namespace rigproof {
namespace {

// A hundred thousand stops.
constexpr std::uintmax_t kMaxBytes = 64U << 20U;
const char* const kFormat = "rigproof-truth";
constexpr int kVersion = 1;
// What the poses in `stops` are, for people who read the file.
const char* const kStopPose = "T_world_robot in the middle of the exposure of the middle row";

// All 64 bits: a seed is no signed number.
std::uint64_t read_seed(MapReader& map) {
  map.require("seed", "a whole number, >= 0");
  const std::string text = map.text("seed").value_or("0");
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc() || end != text.data() + text.size()) map.problem("seed", "must be a whole number, >= 0");
  return seed;
}

YamlTree tree_of_seed(std::uint64_t seed) {
  YamlTree tree = YamlTree::integer(0);
  tree.scalar = std::to_string(seed);
  return tree;
}

Rigid3 required_transform(MapReader& map, const std::string& key) {
  map.require(key, "{translation_m, quaternion_xyzw}");
  const YamlTree* tree = map.find(key);
  if (tree == nullptr) return Rigid3();
  MapReader block(*tree, map.path_of(key), &map.problems());
  const Rigid3 T = read_transform(block);
  block.finish();
  return T;
}

std::map<std::string, double> read_sensing(const YamlTree& tree, MapReader& camera, Problems* problems) {
  std::map<std::string, double> sensing;
  MapReader map(tree, camera.path_of("sensing"), problems);
  for (const auto& [name, value] : tree.entries)
    if (const auto number = map.number(name)) sensing[name] = *number;
  return sensing;
}

// Both or none.
std::optional<Vector6d> read_velocity(MapReader& map) {
  const auto linear = map.numbers("velocity_m_s", 3, 3, {-1e3, 1e3});
  const auto angular = map.numbers("turn_rate_rad_s", 3, 3, {-1e3, 1e3});
  if (linear.has_value() != angular.has_value())
    map.problem(linear ? "velocity_m_s" : "turn_rate_rad_s", "velocity_m_s and turn_rate_rad_s belong together");
  if (!linear || !angular) return std::nullopt;
  Vector6d velocity;
  velocity << (*linear)[0], (*linear)[1], (*linear)[2], (*angular)[0], (*angular)[1], (*angular)[2];
  return velocity;
}

/// @param path of the list, for messages
std::vector<TrueStop> read_stops(const YamlTree& tree, const std::string& path, Problems* problems) {
  std::vector<TrueStop> stops;
  if (!tree.is_sequence()) problems->add({tree.file, tree.line, path, tree.shown(), "must be a list of stops"});
  for (std::size_t i = 0; i < tree.items.size(); ++i) {
    MapReader map(tree.items[i], path + "[" + std::to_string(i) + "]", problems);
    map.require("stamp_s", "a number");
    TrueStop stop;
    stop.stamp_s = map.number("stamp_s").value_or(0.0);
    stop.T_world_robot = read_transform(map);
    stop.velocity = read_velocity(map);
    map.finish();
    stops.push_back(stop);
  }
  return stops;
}

std::vector<TrueCamera> read_cameras(const YamlTree& tree, Problems* problems) {
  std::vector<TrueCamera> cameras;
  for (const auto& [name, value] : tree.entries) {
    MapReader map(value, "cameras." + for_message(name), problems);
    TrueCamera camera;
    camera.name = name;
    camera.T_robot_camera = required_transform(map, "T_robot_camera");
    map.require("intrinsics", "a block of intrinsics");
    if (const YamlTree* intrinsics = map.find("intrinsics")) {
      MapReader block(*intrinsics, map.path_of("intrinsics"), problems);
      camera.camera = read_intrinsics(block);
      block.finish();
    }
    camera.depth_scale = map.number("depth_scale", {0.1, 10.0});
    if (const YamlTree* sensing = map.find("sensing")) camera.sensing = read_sensing(*sensing, map, problems);
    if (const YamlTree* depth = map.find("depth_camera")) {
      MapReader block(*depth, map.path_of("depth_camera"), problems);
      camera.depth_camera = DepthStream::OwnCamera{read_intrinsics(block), required_transform(block, "T_color_depth")};
      block.finish();
    }
    if (const YamlTree* stops = map.find("stops")) camera.stops = read_stops(*stops, map.path_of("stops"), problems);
    map.finish();
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

void read_odometry(MapReader& map, Truth* truth) {
  map.require("odometry", "a block with noise, scale, yaw_factor");
  const YamlTree* tree = map.find("odometry");
  if (tree == nullptr) return;
  MapReader block(*tree, "odometry", &map.problems());
  truth->odometry_scale = block.number("scale", {0.01, 100.0}).value_or(1.0);
  truth->odometry_yaw_factor = block.number("yaw_factor", {0.01, 100.0}).value_or(1.0);
  if (const YamlTree* noise = block.find("noise")) {
    MapReader noise_map(*noise, "odometry.noise", &map.problems());
    truth->odometry_noise = read_odometry_noise(noise_map);
    noise_map.finish();
  }
  block.finish();
}

void read_drawn(const YamlTree& tree, Problems* problems, Truth* truth) {
  if (!tree.is_map()) problems->add({tree.file, tree.line, "drawn", tree.shown(), "must be a block of numbers"});
  MapReader map(tree, "drawn", problems);
  for (const auto& [name, value] : tree.entries)
    if (const auto number = map.number(name)) truth->drawn[name] = *number;
  map.finish();
}

void check_version(MapReader& map) {
  map.require("format", kFormat);
  map.text("format", {kFormat});
  map.require("version", std::to_string(kVersion));
  map.integer("version", {static_cast<double>(kVersion), static_cast<double>(kVersion)});
}

Truth read_truth(const YamlTree& tree, Problems* problems) {
  Truth truth;
  MapReader map(tree, "", problems);
  check_version(map);
  truth.scene = map.text("scene").value_or("");
  truth.seed = read_seed(map);
  map.require("board", "{type, squares, square_mm}");
  if (const YamlTree* board = map.find("board")) truth.board = read_board(*board, "board", problems);
  truth.T_world_board = required_transform(map, "T_world_board");
  read_odometry(map, &truth);
  if (const YamlTree* drawn = map.find("drawn")) read_drawn(*drawn, problems, &truth);
  map.require("cameras", "a map of cameras by name");
  if (const YamlTree* cameras = map.find("cameras")) truth.cameras = read_cameras(*cameras, problems);
  map.text("stop_pose");
  map.require("stops", "a list of stops");
  if (const YamlTree* stops = map.find("stops")) truth.stops = read_stops(*stops, "stops", problems);
  map.finish();
  return truth;
}

YamlTree tree_of(const TrueStop& stop) {
  YamlTree tree = YamlTree::inline_map();
  tree.set("stamp_s", YamlTree::number(stop.stamp_s));
  set_transform(stop.T_world_robot, &tree);
  if (!stop.velocity) return tree;
  const Vector6d& v = *stop.velocity;
  tree.set("velocity_m_s", YamlTree::numbers({v[0], v[1], v[2]}));
  tree.set("turn_rate_rad_s", YamlTree::numbers({v[3], v[4], v[5]}));
  return tree;
}

void set_stops(const std::vector<TrueStop>& stops, YamlTree* tree) {
  YamlTree& list = tree->set("stops", YamlTree::sequence());
  for (const TrueStop& stop : stops) list.add(tree_of(stop));
}

YamlTree tree_of(const TrueCamera& camera) {
  YamlTree tree = YamlTree::map();
  tree.set("T_robot_camera", rigproof::tree_of(camera.T_robot_camera));
  tree.set("intrinsics", rigproof::tree_of(camera.camera));
  if (camera.depth_scale) tree.set("depth_scale", YamlTree::number(*camera.depth_scale));
  if (camera.depth_camera) {
    YamlTree& depth = tree.set("depth_camera", rigproof::tree_of(camera.depth_camera->camera));
    depth.set("T_color_depth", rigproof::tree_of(camera.depth_camera->T_color_depth));
  }
  if (!camera.sensing.empty()) {
    YamlTree& sensing = tree.set("sensing", YamlTree::inline_map());
    for (const auto& [name, value] : camera.sensing) sensing.set(name, YamlTree::number(value));
  }
  if (!camera.stops.empty()) set_stops(camera.stops, &tree);
  return tree;
}

YamlTree tree_of(const Truth& truth) {
  YamlTree tree = YamlTree::map();
  tree.set("format", YamlTree::text(kFormat));
  tree.set("version", YamlTree::integer(kVersion));
  tree.set("scene", YamlTree::text(truth.scene));
  tree.set("seed", tree_of_seed(truth.seed));
  tree.set("board", rigproof::tree_of(truth.board));
  tree.set("T_world_board", rigproof::tree_of(truth.T_world_board));
  YamlTree& odometry = tree.set("odometry", YamlTree::map());
  odometry.set("noise", rigproof::tree_of(truth.odometry_noise));
  odometry.set("scale", YamlTree::number(truth.odometry_scale));
  odometry.set("yaw_factor", YamlTree::number(truth.odometry_yaw_factor));
  if (!truth.drawn.empty()) {
    YamlTree& drawn = tree.set("drawn", YamlTree::map());
    for (const auto& [name, value] : truth.drawn) drawn.set(name, YamlTree::number(value));
  }
  YamlTree& cameras = tree.set("cameras", YamlTree::map());
  for (const TrueCamera& camera : truth.cameras) cameras.set(camera.name, tree_of(camera));
  tree.set("stop_pose", YamlTree::text(kStopPose));
  set_stops(truth.stops, &tree);
  return tree;
}

}  // namespace

Truth load_truth(const std::filesystem::path& file) {
  Problems problems;
  Truth truth = read_truth(read_yaml_file(file, kMaxBytes), &problems);
  problems.sort();
  problems.throw_if_any();
  return truth;
}

void save_truth(const Truth& truth, const std::filesystem::path& file) {
  write_file_atomically(file, emit_yaml(tree_of(truth)));
}

}  // namespace rigproof
