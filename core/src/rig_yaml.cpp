#include "rigproof/core/rig_yaml.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "camera_info.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/files.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxSize = 32768.0;
constexpr double kMaxPixel = 1e6;
constexpr std::size_t kMaxCameras = 64;
constexpr double kMmPerM = 1000.0;
constexpr double kDegPerRad = 180.0 / kPi;
const NumberRange kPositive = {std::numeric_limits<double>::min(), 1e9};
const NumberRange kNotNegative = {0.0, 1e9};

const char* law_name(DepthNoise::Law law) { return law == DepthNoise::Law::kStereo ? "stereo" : "time_of_flight"; }

double required_number(MapReader& map, const std::string& key, const NumberRange& range) {
  map.require(key, "a number, " + range_text(range));
  return map.number(key, range).value_or(0.0);
}

std::optional<Lens> lens_of(const std::string& name) {
  for (const Lens lens : {Lens::kPinhole, Lens::kBrownConrady, Lens::kKannalaBrandt})
    if (name == lens_name(lens)) return lens;
  return std::nullopt;
}

void read_lens(MapReader& map, Camera* camera) {
  const auto name = map.text("lens", {"pinhole", "brown_conrady", "kannala_brandt"});
  const auto coefficients = map.numbers("distortion", 0, 5, {-1e3, 1e3});
  if (name) camera->lens = *lens_of(*name);
  const bool any = coefficients && !coefficients->empty();
  if (!map.tree().find("lens") && any) camera->lens = Lens::kBrownConrady;
  const auto expected = static_cast<std::size_t>(coefficient_count(camera->lens));
  if (!coefficients && expected > 0) map.require("distortion", std::to_string(expected) + " coefficients");
  if (!coefficients) return;
  if (coefficients->size() != expected) {
    map.problem("distortion", "the lens " + std::string(lens_name(camera->lens)) + " has " + std::to_string(expected) +
                                  " coefficients (brown_conrady: k1 k2 p1 p2 k3, kannala_brandt: k1 k2 k3 k4)");
    return;
  }
  std::copy(coefficients->begin(), coefficients->end(), camera->distortion.begin());
}

DepthNoise read_depth_noise(MapReader& map, const DepthNoise& preset) {
  DepthNoise noise = preset;
  if (const auto law = map.text("law", {"stereo", "time_of_flight"}))
    noise.law = *law == "stereo" ? DepthNoise::Law::kStereo : DepthNoise::Law::kTimeOfFlight;
  const auto set = [&map](const char* key, double* value, const NumberRange& range) {
    *value = map.number(key, range).value_or(*value);
  };
  set("inverse_depth_sigma_per_m", &noise.inverse_depth_sigma_per_m, kNotNegative);
  set("constant_m", &noise.constant_m, {0.0, 10.0});
  set("proportional", &noise.proportional, {0.0, 1.0});
  set("correlation_px", &noise.correlation_px, {1.0, 1000.0});
  set("scale_sigma", &noise.scale_sigma, {0.0, 1.0});
  set("bias_inverse_depth_per_m", &noise.bias_inverse_depth_per_m, {0.0, 1.0});
  set("bias_m", &noise.bias_m, {0.0, 1.0});
  set("bias_cell_deg", &noise.bias_cell_deg, {1.0, 90.0});
  const bool silent = noise.law == DepthNoise::Law::kStereo ? noise.inverse_depth_sigma_per_m <= 0.0
                                                            : noise.constant_m <= 0.0 && noise.proportional <= 0.0;
  if (silent) map.problem("", "this law has no noise at all; give what rounding alone does, at least");
  return noise;
}

void read_own_camera(MapReader& map, DepthStream* depth) {
  const YamlTree* camera = map.find("camera");
  const YamlTree* transform = map.find("T_color_depth");
  if ((camera == nullptr) != (transform == nullptr))
    map.problem(camera ? "camera" : "T_color_depth", "camera and T_color_depth belong together; give both or none");
  if (camera == nullptr || transform == nullptr) return;
  MapReader camera_map(*camera, map.path_of("camera"), &map.problems());
  MapReader transform_map(*transform, map.path_of("T_color_depth"), &map.problems());
  depth->own_camera = DepthStream::OwnCamera{read_intrinsics(camera_map), read_transform(transform_map)};
  camera_map.finish();
  transform_map.finish();
}

// `depth: none`, a block that refines the preset's, or nothing: the preset's.
std::optional<DepthStream> read_optional_depth(MapReader& map, const std::optional<DepthStream>& preset) {
  const YamlTree* depth = map.find("depth");
  if (depth == nullptr) return preset;
  if (depth->is_scalar()) {
    if (depth->scalar != "none") map.problem("depth", "must be none or a block");
    return std::nullopt;
  }
  MapReader block(*depth, map.path_of("depth"), &map.problems());
  const DepthStream stream = read_depth_stream(block, preset.value_or(DepthStream()));
  block.finish();
  return stream;
}

// True if the block says all that a preset would: files that this program wrote need none.
bool describes_depth(const YamlTree* depth) {
  if (depth == nullptr) return false;
  if (!depth->is_map()) return true;
  const auto has_all = [](const YamlTree& tree, std::initializer_list<const char*> keys) {
    return std::all_of(keys.begin(), keys.end(), [&tree](const char* key) { return tree.find(key) != nullptr; });
  };
  return has_all(*depth, {"unit_m", "min_m", "max_m", "noise"}) &&
         has_all(*depth->find("noise"),
                 {"law", "inverse_depth_sigma_per_m", "constant_m", "proportional", "correlation_px", "scale_sigma"});
}

bool is_told(const Problems& problems, const std::string& message) {
  return std::any_of(problems.all().begin(), problems.all().end(),
                     [&message](const Problem& problem) { return problem.message == message; });
}

std::optional<SensorPreset> read_sensor(MapReader& map, const std::string& name, const RigReadOptions& options) {
  const bool told = describes_depth(map.tree().find("depth")) &&
                    !(options.nominal_intrinsics && map.tree().find("intrinsics") == nullptr);
  if (name.empty() || told) return std::nullopt;
  try {
    return load_sensor_preset(name);
  } catch (const Error& error) {
    const std::string reason = error.what();
    const bool is_unknown = reason.rfind("there is no ", 0) == 0;
    // What is wrong in a preset is told for the first camera that names it; an unknown name is each line's own mistake.
    if (!is_unknown && is_told(map.problems(), reason)) return std::nullopt;
    map.problem("sensor", reason + (is_unknown ? "; a preset of your own goes beside these, into models/sensors of the "
                                                 "data folder (RIGPROOF_DATA names another one)"
                                               : ""));
    return std::nullopt;
  }
}

void read_camera_info_file(MapReader& map, const fs::path& file, Camera* camera) {
  try {
    *camera = read_camera_info(read_yaml_file(file), &map.problems());
  } catch (const Error& error) {
    map.problem("", error.what());
  }
}

// Inline, else the file that is named, else camera_info.yaml in the camera's folder, else the sensor's nominal ones.
void read_camera_intrinsics(MapReader& map, const RigReadOptions& options, const std::optional<SensorPreset>& sensor,
                            RigCamera* camera) {
  const YamlTree* inline_block = map.find("intrinsics");
  const auto named = map.text("camera_info");
  if (inline_block != nullptr && named) map.problem("camera_info", "intrinsics are given twice; remove one of them");
  if (inline_block != nullptr) {
    MapReader block(*inline_block, map.path_of("intrinsics"), &map.problems());
    camera->camera = read_intrinsics(block);
    block.finish();
    return;
  }
  const fs::path inside = fs::path(camera->folder) / named.value_or("camera_info.yaml");
  if (!options.folder.empty()) {
    try {
      const fs::path file = path_inside(options.folder, inside.generic_string());
      std::error_code ignored;
      if (named || fs::exists(file, ignored)) return read_camera_info_file(map, file, &camera->camera);
    } catch (const Error& error) {
      return map.problem("camera_info", error.what());
    }
  }
  if (sensor && options.nominal_intrinsics) {
    camera->camera = sensor->camera;
    return;
  }
  // A sensor that cannot be read was told already.
  if (options.nominal_intrinsics && !camera->sensor.empty()) return;
  map.problem("",
              "has no intrinsics; give `intrinsics: {width_px, height_px, fx_px, fy_px, cx_px, cy_px, lens, "
              "distortion}` or put a ROS camera_info.yaml at " +
                  inside.generic_string());
}

// However it is spelled or linked to.
fs::path place_of(const std::string& camera_folder, const fs::path& recording) {
  std::error_code error;
  const fs::path place = recording.empty() ? fs::path() : fs::weakly_canonical(recording / camera_folder / ".", error);
  const fs::path normal = (place.empty() ? fs::path(camera_folder) / "." : place).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

// Two cameras with the same images would agree perfectly.
void check_own_folder(const std::vector<RigCamera>& before, const RigCamera& camera, const RigReadOptions& options,
                      MapReader* map) {
  const fs::path place = place_of(camera.folder, options.folder);
  for (const RigCamera& other : before)
    if (place_of(other.folder, options.folder) == place)
      map->problem("folder", "holds the images of " + other.name + " already (folder " + for_message(other.folder) +
                                 "); every camera needs a folder of its own");
}

double norm_of(const std::vector<double>& values) {
  double squared = 0.0;
  for (const double value : values) squared += value * value;
  return std::sqrt(squared);
}

}  // namespace

bool is_frame_name(const std::string& name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.';
  };
  return !name.empty() && name.size() <= 64 && name.front() != '.' && std::all_of(name.begin(), name.end(), allowed);
}

Board read_board(const YamlTree& tree, const std::string& path, Problems* problems) {
  Board board;
  if (tree.is_scalar()) {
    try {
      return load_board(find_preset("boards", tree.scalar).string());
    } catch (const Error& error) {
      problems->add({tree.file, tree.line, path, tree.shown(), error.what()});
      return board;
    }
  }
  MapReader map(tree, path, problems);
  map.text("description");
  if (const auto type = map.text("type", {"checkerboard", "charuco", "aprilgrid"})) board.type = *type;
  map.require("squares", "[columns, rows], the number of squares");
  map.require("square_mm", "the side of a square in millimetres");
  const auto squares = map.numbers("squares", 2, 2, {3.0, 100.0});
  const auto side = map.number("square_mm", {0.1, 1e5});
  if (squares && ((*squares)[0] != std::floor((*squares)[0]) || (*squares)[1] != std::floor((*squares)[1])))
    map.problem("squares", "must be whole numbers");
  if (squares) board.squares_x = static_cast<int>((*squares)[0]);
  if (squares) board.squares_y = static_cast<int>((*squares)[1]);
  if (side) board.square_m = *side / kMmPerM;
  if (map.has("inner_corners"))
    map.problem("inner_corners", "give squares: one more than inner corners along each side");
  if (squares && side && board.type == "checkerboard" && board.ambiguous_under_half_turn())
    map.problem("squares",
                "the board looks the same when turned by 180 degrees, so its first corner cannot be told; "
                "use one even and one odd number of squares");
  map.finish();
  return board;
}

Camera read_intrinsics(MapReader& map) {
  Camera camera;
  camera.width_px = static_cast<int>(map.integer("width_px", {1.0, kMaxSize}).value_or(0));
  camera.height_px = static_cast<int>(map.integer("height_px", {1.0, kMaxSize}).value_or(0));
  map.require("width_px", "the width of the image in pixels");
  map.require("height_px", "the height of the image in pixels");
  camera.fx_px = required_number(map, "fx_px", {1.0, kMaxPixel});
  camera.fy_px = required_number(map, "fy_px", {1.0, kMaxPixel});
  camera.cx_px = required_number(map, "cx_px", {-kMaxPixel, kMaxPixel});
  camera.cy_px = required_number(map, "cy_px", {-kMaxPixel, kMaxPixel});
  read_lens(map, &camera);
  return camera;
}

DepthStream read_depth_stream(MapReader& map, const DepthStream& preset) {
  DepthStream depth = preset;
  depth.unit_m = map.number("unit_m", {1e-6, 1.0}).value_or(depth.unit_m);
  depth.min_m = map.number("min_m", {0.0, 1000.0}).value_or(depth.min_m);
  depth.max_m = map.number("max_m", {0.0, 1000.0}).value_or(depth.max_m);
  if (!(depth.min_m < depth.max_m)) map.problem("min_m", "must be less than max_m");
  if (const YamlTree* noise = map.find("noise")) {
    MapReader block(*noise, map.path_of("noise"), &map.problems());
    depth.noise = read_depth_noise(block, depth.noise);
    block.finish();
  }
  read_own_camera(map, &depth);
  return depth;
}

// A simulated device is where its preset says; of a real one that has to be told.
void take_raw_depth(MapReader& map, const RigReadOptions& options, const SensorPreset& sensor, DepthStream* depth) {
  if (!sensor.delivers_raw_depth || depth->own_camera) return;
  if (options.nominal_intrinsics) {
    depth->own_camera = sensor.raw_depth;
    return;
  }
  map.problem("depth", "the sensor " + sensor.name +
                           " delivers depth that is not registered to colour; give depth.camera and "
                           "depth.T_color_depth");
}

RigCamera read_rig_camera(const std::string& name, MapReader& map, const RigReadOptions& options) {
  RigCamera camera;
  camera.name = name;
  camera.sensor = map.text("sensor").value_or("");
  const std::optional<SensorPreset> sensor = read_sensor(map, camera.sensor, options);
  camera.link = map.text("link").value_or(name);
  camera.folder = map.text("folder").value_or(name);
  read_camera_intrinsics(map, options, sensor, &camera);
  camera.depth = read_optional_depth(map, sensor ? sensor->depth : std::nullopt);
  if (sensor && camera.depth) take_raw_depth(map, options, *sensor, &*camera.depth);
  return camera;
}

std::vector<RigCamera> read_rig_cameras(const YamlTree& tree, const std::string& path, const RigReadOptions& options,
                                        Problems* problems) {
  std::vector<RigCamera> cameras;
  MapReader all(tree, path, problems);
  if (tree.entries.empty() || tree.entries.size() > kMaxCameras)
    all.problem("", "must be a map of 1 to " + std::to_string(kMaxCameras) + " cameras by name");
  if (tree.entries.size() > kMaxCameras) return cameras;
  for (const auto& [name, value] : tree.entries) {
    if (!is_frame_name(name))
      all.problem(name, "a camera's name has letters, digits, \"_\", \"-\" and \".\", at most 64, and no leading dot");
    MapReader map(value, all.path_of(name), problems);
    if (!value.is_map()) continue;
    RigCamera camera = read_rig_camera(name, map, options);
    check_own_folder(cameras, camera, options, &map);
    cameras.push_back(std::move(camera));
    map.finish("x-");
  }
  return cameras;
}

OdometryNoise read_odometry_noise(MapReader& map) {
  OdometryNoise noise;
  const auto model = map.text("model", {"unknown", "per_pose", "per_increment"});
  for (const OdometryModel candidate : {OdometryModel::kPerPose, OdometryModel::kPerIncrement})
    if (model && *model == odometry_model_name(candidate)) noise.model = candidate;
  if (const auto sigma = map.number("sigma_xy_mm", kNotNegative)) noise.sigma_xy_m = *sigma / kMmPerM;
  if (const auto sigma = map.number("sigma_yaw_deg", {0.0, 360.0})) noise.sigma_yaw_rad = *sigma / kDegPerRad;
  return noise;
}

AcceptLimits read_accept_limits(MapReader& map) {
  AcceptLimits accept;
  accept.xy_m = required_number(map, "xy_mm", kPositive) / kMmPerM;
  accept.z_m = required_number(map, "z_mm", kPositive) / kMmPerM;
  accept.angle_rad = required_number(map, "angle_deg", {kPositive.min, 180.0}) / kDegPerRad;
  return accept;
}

Rigid3 read_transform(MapReader& map) {
  Rigid3 T;
  map.require("translation_m", "[x, y, z]");
  map.require("quaternion_xyzw", "[x, y, z, w]");
  if (const auto t = map.numbers("translation_m", 3, 3, {-1e6, 1e6})) T.translation << (*t)[0], (*t)[1], (*t)[2];
  const auto q = map.numbers("quaternion_xyzw", 4, 4, {-2.0, 2.0});
  if (!q) return T;
  const double norm = norm_of(*q);
  if (std::abs(norm - 1.0) > 1e-3) {
    map.problem("quaternion_xyzw", "has the norm " + number_text(norm) + "; it must be 1 within 0.001, order x y z w");
    return T;
  }
  // What this program wrote is a unit to rounding, and reads back to the same bits.
  const double scale = std::abs(norm - 1.0) < 1e-14 ? 1.0 : 1.0 / norm;
  T.rotation.coeffs() << (*q)[0] * scale, (*q)[1] * scale, (*q)[2] * scale, (*q)[3] * scale;
  return T;
}

double value_in_unit(double value, double units_per_si) {
  const double exact = value * units_per_si;
  if (!std::isfinite(exact)) return exact;
  const double inf = std::numeric_limits<double>::infinity();
  std::vector<double> candidates;
  for (const int digits : {12, 15, 16}) candidates.push_back(parse_number(short_text(exact, digits)).value_or(exact));
  candidates.push_back(exact);
  candidates.push_back(std::nextafter(exact, -inf));
  candidates.push_back(std::nextafter(exact, inf));
  const auto distance = [&](double candidate) { return std::abs(candidate / units_per_si - value); };
  return *std::min_element(candidates.begin(), candidates.end(),
                           [&](double a, double b) { return distance(a) < distance(b); });
}

YamlTree tree_of(const Board& board) {
  YamlTree tree = YamlTree::inline_map();
  tree.set("type", YamlTree::text(board.type));
  tree.set("squares", YamlTree::numbers({static_cast<double>(board.squares_x), static_cast<double>(board.squares_y)}));
  tree.set("square_mm", YamlTree::number(value_in_unit(board.square_m, kMmPerM)));
  return tree;
}

YamlTree tree_of(const Camera& camera) {
  YamlTree tree = YamlTree::map();
  tree.set("width_px", YamlTree::integer(camera.width_px));
  tree.set("height_px", YamlTree::integer(camera.height_px));
  tree.set("fx_px", YamlTree::number(camera.fx_px));
  tree.set("fy_px", YamlTree::number(camera.fy_px));
  tree.set("cx_px", YamlTree::number(camera.cx_px));
  tree.set("cy_px", YamlTree::number(camera.cy_px));
  tree.set("lens", YamlTree::text(lens_name(camera.lens)));
  const auto count = static_cast<std::ptrdiff_t>(coefficient_count(camera.lens));
  if (count > 0)
    tree.set("distortion", YamlTree::numbers({camera.distortion.begin(), camera.distortion.begin() + count}));
  return tree;
}

YamlTree tree_of(const DepthStream& depth) {
  YamlTree tree = YamlTree::map();
  tree.set("unit_m", YamlTree::number(depth.unit_m));
  tree.set("min_m", YamlTree::number(depth.min_m));
  tree.set("max_m", YamlTree::number(depth.max_m));
  YamlTree& noise = tree.set("noise", YamlTree::map());
  noise.set("law", YamlTree::text(law_name(depth.noise.law)));
  noise.set("inverse_depth_sigma_per_m", YamlTree::number(depth.noise.inverse_depth_sigma_per_m));
  noise.set("constant_m", YamlTree::number(depth.noise.constant_m));
  noise.set("proportional", YamlTree::number(depth.noise.proportional));
  noise.set("correlation_px", YamlTree::number(depth.noise.correlation_px));
  noise.set("scale_sigma", YamlTree::number(depth.noise.scale_sigma));
  if (depth.noise.has_bias()) {
    const bool stereo = depth.noise.law == DepthNoise::Law::kStereo;
    noise.set(stereo ? "bias_inverse_depth_per_m" : "bias_m",
              YamlTree::number(stereo ? depth.noise.bias_inverse_depth_per_m : depth.noise.bias_m));
    noise.set("bias_cell_deg", YamlTree::number(depth.noise.bias_cell_deg));
  }
  if (depth.own_camera) {
    tree.set("camera", tree_of(depth.own_camera->camera));
    tree.set("T_color_depth", tree_of(depth.own_camera->T_color_depth));
  }
  return tree;
}

YamlTree tree_of(const RigCamera& camera) {
  YamlTree tree = YamlTree::map();
  if (!camera.sensor.empty()) tree.set("sensor", YamlTree::text(camera.sensor));
  tree.set("folder", YamlTree::text(camera.folder));
  tree.set("link", YamlTree::text(camera.link));
  tree.set("intrinsics", tree_of(camera.camera));
  tree.set("depth", camera.depth ? tree_of(*camera.depth) : YamlTree::text("none"));
  return tree;
}

YamlTree tree_of(const OdometryNoise& noise) {
  YamlTree tree = YamlTree::inline_map();
  tree.set("model", YamlTree::text(odometry_model_name(noise.model)));
  if (noise.sigma_xy_m) tree.set("sigma_xy_mm", YamlTree::number(value_in_unit(*noise.sigma_xy_m, kMmPerM)));
  if (noise.sigma_yaw_rad) tree.set("sigma_yaw_deg", YamlTree::number(value_in_unit(*noise.sigma_yaw_rad, kDegPerRad)));
  return tree;
}

YamlTree tree_of(const AcceptLimits& accept) {
  YamlTree tree = YamlTree::inline_map();
  tree.set("xy_mm", YamlTree::number(value_in_unit(accept.xy_m, kMmPerM)));
  tree.set("z_mm", YamlTree::number(value_in_unit(accept.z_m, kMmPerM)));
  tree.set("angle_deg", YamlTree::number(value_in_unit(accept.angle_rad, kDegPerRad)));
  return tree;
}

void set_transform(const Rigid3& T, YamlTree* map) {
  const Eigen::Vector3d& t = T.translation;
  // q and -q are one rotation: the file holds the one with w >= 0.
  const Eigen::Vector4d q = T.rotation.w() < 0.0 ? Eigen::Vector4d(-T.rotation.coeffs()) : T.rotation.coeffs();
  map->set("translation_m", YamlTree::numbers({t.x(), t.y(), t.z()}));
  map->set("quaternion_xyzw", YamlTree::numbers({q[0], q[1], q[2], q[3]}));
}

YamlTree tree_of(const Rigid3& T) {
  YamlTree tree = YamlTree::inline_map();
  set_transform(T, &tree);
  return tree;
}

}  // namespace rigproof
