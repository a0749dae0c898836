#include "rigproof/sim/models.h"

#include <algorithm>

#include "rigproof/core/conventions.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/fields.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/sim/model_schemas.h"
#include "scene_objects.h"
#include "textures.h"

namespace rigproof {
namespace {

constexpr std::size_t kMaxCameras = 8;

std::filesystem::path beside(const std::filesystem::path& yaml_file, const std::string& name) {
  return yaml_file.parent_path() / name;
}

// Optical axes (x right, y down, z forward) in body axes (x forward, y left, z up).
Eigen::Quaterniond optical_in_body() { return Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5); }

Rigid3 visit_mount(FieldVisitor& visitor) {
  double x_m = 0.0, y_m = 0.0, z_m = 0.0, roll_deg = 0.0, pitch_deg = 0.0, yaw_deg = 0.0;
  const auto visit = [&](FieldVisitor& mount) {
    const NumberRange place{-10.0, 10.0}, angle{-180.0, 180.0};
    for (const char* key : {"x_m", "y_m", "z_m"}) mount.require(key, "a place in the robot frame in metres, -10 to 10");
    mount.field("x_m", x_m, place, "in the robot frame, forward");
    mount.field("y_m", y_m, place, "in the robot frame, left");
    mount.field("z_m", z_m, place, "in the robot frame, up");
    mount.field("roll_deg", roll_deg, angle, "about the optical axis");
    mount.field("pitch_deg", pitch_deg, angle, "positive looks down");
    mount.field("yaw_deg", yaw_deg, angle, "positive looks left");
  };
  visitor.require("mount", "a block {x_m, y_m, z_m, roll_deg, pitch_deg, yaw_deg}");
  visitor.section("mount", visit, "where the camera is: R = Rz(yaw) Ry(pitch) Rx(roll) of its body axes");
  return mount_pose(x_m, y_m, z_m, roll_deg, pitch_deg, yaw_deg);
}

void visit_rig_model(FieldVisitor& visitor, RigModel& rig, std::string& robot) {
  visitor.field("description", rig.description, {}, "one sentence");
  visitor.field("robot_frame", rig.rig.robot_frame, {}, "name of the robot frame in results");
  visitor.require("robot", "the name of a robot in models/robots");
  visitor.field("robot", robot, {}, "robot in models/robots, or a YAML file");
  visitor.nested("board", rig.rig.board, "the calibration board");
  const RigReadOptions options{{}, true, kMaxCameras};
  visitor.require("cameras", "a block of 1 to 8 cameras by name");
  visit_rig_cameras(visitor, options, rig.rig.cameras, [&rig](FieldVisitor& camera) {
    const Rigid3 T_robot_camera = visit_mount(camera);
    if (camera.is_reading()) rig.T_robot_camera.push_back(T_robot_camera);
  });
  visitor.tolerate("x-");
}

void visit_color(FieldVisitor& visitor, const char* key, std::array<double, 3>& color, const char* description) {
  std::vector<double> values(color.begin(), color.end());
  visitor.field(key, values, {0.0, 1.0}, 3, 3, description);
  if (values.size() == 3) std::copy(values.begin(), values.end(), color.begin());
}

bool is_power_of_two(std::int64_t value) { return value > 0 && (value & (value - 1)) == 0; }

void visit_texture(FieldVisitor& visitor, SceneTexture& texture) {
  visitor.field("name", texture.name, {}, "name that the materials of the MJCF refer to");
  visitor.field("type", texture.type, {texture_types()}, "kind of pattern, or `file`");
  std::string file = texture.file.string();
  visitor.field("file", file, {}, "image for type `file`, relative to this scene");
  texture.file = file;
  visitor.field("size_px", texture.size_px, {16.0, 4096.0}, "side of the texture, a power of two");
  visitor.check(is_power_of_two(texture.size_px), "size_px", "must be a power of two");
  visitor.field("cube", texture.cube, "wrapped around boxes and cylinders instead of laid flat");
  visitor.field("scale", texture.scale, {0.05, 20.0}, "size of the features relative to the type's default");
  visitor.field("contrast", texture.contrast, {0.0, 4.0}, "strength of the pattern relative to the type's default");
  visit_color(visitor, "color", texture.color, "main colour, red green blue, 0 to 1");
  visit_color(visitor, "second_color", texture.second_color, "joints, mortar, stains: red green blue, 0 to 1");
  visitor.check(!texture.name.empty(), "name", "is missing: materials refer to a texture by its name");
  visitor.check(!texture.type.empty(), "type", "is missing: the kind of pattern");
  visitor.check(texture.type != "file" || !file.empty(), "file", "is missing: type `file` needs an image");
}

void visit_area(FieldVisitor& visitor, FloorArea& area) {
  const NumberRange range{-1000.0, 1000.0};
  visitor.field("x_min_m", area.x_min, range, "lower end along world x");
  visitor.field("x_max_m", area.x_max, range, "upper end along world x");
  visitor.field("y_min_m", area.y_min, range, "lower end along world y");
  visitor.field("y_max_m", area.y_max, range, "upper end along world y");
  visitor.check(area.x_max > area.x_min && area.y_max > area.y_min, "",
                "an area needs x_min_m < x_max_m and y_min_m < y_max_m");
}

void visit_texture_name(FieldVisitor& visitor, const SceneModel& scene, const char* key, std::string& name) {
  std::vector<std::string> names;
  for (const SceneTexture& texture : scene.world.textures) names.push_back(texture.name);
  visitor.field(key, name, {}, "one of this scene's textures");
  const bool known = name.empty() || std::find(names.begin(), names.end(), name) != names.end();
  visitor.check(known, key, for_message(name) + ": the scene has no such texture; " + suggestion(name, names));
}

// What objects and strewn objects have in common.
void visit_look(FieldVisitor& visitor, const SceneModel& scene, SceneObject& object) {
  visitor.field("kind", object.kind, {object_kinds()}, "what it is");
  visitor.check(!object.kind.empty(), "kind", "is missing: what it is");
  std::vector<double> size = {};
  if (object.size_m[0] > 0.0) size.assign(object.size_m.begin(), object.size_m.end());
  visitor.field("size_m", size, {0.005, 500.0}, 0, 3, "depth, width and height; empty = usual for its kind");
  visitor.check(size.empty() || size.size() == 3, "size_m", "must be [depth, width, height]");
  if (size.size() == 3) std::copy(size.begin(), size.end(), object.size_m.begin());
  visit_texture_name(visitor, scene, "texture", object.texture);
  visit_texture_name(visitor, scene, "second_texture", object.second_texture);
  std::vector<double> color;
  if (object.color) color.assign(object.color->begin(), object.color->end());
  visitor.field("color", color, {0.0, 1.0}, 0, 3, "of its main part, the tint of its texture: red green blue, 0 to 1");
  visitor.check(color.empty() || color.size() == 3, "color", "must be [red, green, blue]");
  if (color.size() == 3) object.color = {color[0], color[1], color[2]};
}

void visit_object(FieldVisitor& visitor, const SceneModel& scene, SceneObject& object) {
  visit_look(visitor, scene, object);
  std::vector<double> place = {object.x_m, object.y_m, object.z_m};
  visitor.field("place_m", place, {-1000.0, 1000.0}, 2, 3, "where it stands: [x, y], or [x, y, z] above the floor");
  object.x_m = place[0];
  object.y_m = place[1];
  object.z_m = place.size() > 2 ? place[2] : 0.0;
  visitor.field("heading_deg", object.heading_deg, {-360.0, 360.0}, "where its front looks: 0 = along world x");
}

void visit_scatter(FieldVisitor& visitor, const SceneModel& scene, SceneScatter& scatter) {
  visit_look(visitor, scene, scatter.object);
  visitor.field("count", scatter.count, {0.0, 500.0}, "how many; those that find no place are left out");
  visitor.field("x_m", scatter.x_m, {-1000.0, 1000.0}, "along world x");
  visitor.field("y_m", scatter.y_m, {-1000.0, 1000.0}, "along world y");
  visitor.field("heading_deg", scatter.heading_deg, {-360.0, 360.0}, "where its front looks");
  visitor.field("size_factor", scatter.size_factor, {0.05, 20.0}, "on its size, for each");
}

void visit_straight_path(FieldVisitor& visitor, StraightPath& path) {
  visitor.field("x_m", path.x_m, {-1000.0, 1000.0}, "start of the robot along world x");
  visitor.field("y_m", path.y_m, {-1000.0, 1000.0}, "start of the robot along world y");
  visitor.field("heading_deg", path.heading_deg, {-360.0, 360.0}, "where it drives");
  visitor.field("length_m", path.length_m, {0.0, 1000.0}, "0 = this scene has no straight path");
}

void visit_placement(FieldVisitor& visitor, BoardPlacementRange& board) {
  visitor.field("x_m", board.x_m, {-1000.0, 1000.0}, "middle of the board along world x");
  visitor.field("y_m", board.y_m, {-1000.0, 1000.0}, "middle of the board along world y");
  visitor.field("z_m", board.z_m, {0.0, 100.0}, "height of the middle above the floor");
  visitor.field("facing_deg", board.facing_deg, {-360.0, 360.0}, "heading in which the board faces");
  visitor.field("lean_deg", board.lean_deg, {-90.0, 90.0}, "how far the board leans back");
  visitor.field("roll_deg", board.roll_deg, {-180.0, 180.0}, "turn about the board's normal");
}

void visit_robot(FieldVisitor& visitor, RobotModel& robot, std::string& mjcf) {
  const NumberRange length{0.01, 10.0};
  visitor.field("description", robot.description, {}, "one sentence");
  visitor.field("mjcf", mjcf, {}, "the robot's body, relative to this file");
  visitor.check(!mjcf.empty(), "mjcf", "is missing: the MJCF file of the robot");
  visitor.field("mass_kg", robot.mass_kg, {0.1, 10000.0}, "whole mass");
  visitor.field("wheel_radius_m", robot.wheel_radius_m, length, "nominal, for odometry");
  visitor.field("track_m", robot.track_m, length, "between the middles of left and right wheels");
  visitor.field("wheelbase_m", robot.wheelbase_m, length, "between front and rear axles");
  visitor.field("slip_factor", robot.slip_factor, {1.0, 10.0}, "effective track over track; 1 for no slip");
  visitor.field("encoder_ticks_per_turn", robot.encoder_ticks_per_turn, {0.0, 1e9}, "of a wheel; 0 = continuous");
  visitor.field("footprint_length_m", robot.footprint_length_m, length, "along x");
  visitor.field("footprint_width_m", robot.footprint_width_m, length, "along y");
}

void visit_scene(FieldVisitor& visitor, SceneModel& scene, std::string& mjcf) {
  SceneDescription& world = scene.world;
  visitor.field("description", scene.description, {}, "one sentence");
  visitor.field("mjcf", mjcf, {}, "geometry and lights, relative to this file");
  visitor.check(!mjcf.empty(), "mjcf", "is missing: the MJCF file of the scene");
  visitor.field("outdoor", scene.outdoor, "time-of-flight cameras see next to nothing outdoors");
  visitor.section(
      "drivable_area", [&](FieldVisitor& area) { visit_area(area, world.drivable_area); },
      "rectangle of free floor in which a robot may be placed");
  visitor.section(
      "board", [&](FieldVisitor& board) { visit_placement(board, scene.board); }, "where the board stands by default");
  visitor.field("near_m", world.near_m, {0.01, 1.0}, "nearest visible distance; depth resolution depends on it");
  visitor.field("far_m", world.far_m, {2.0, 1000.0}, "farthest visible distance");
  visit_color(visitor, "sky_zenith", world.sky_zenith, "colour of the sky overhead");
  visit_color(visitor, "sky_horizon", world.sky_horizon, "colour of the sky at the horizon");
  visitor.field("cloud_cover", world.cloud_cover, {0.0, 1.0}, "share of the sky, roughly");
  visit_color(visitor, "cloud_color", world.cloud_color, "red green blue, 0 to 1");
  visitor.field("shadows", world.shadows, "lights cast shadows; rendering takes longer");
  visitor.nested_list("textures", world.textures, "procedural textures and image files", visit_texture);
  visitor.nested_list("objects", world.objects, "furniture, plants, machines, cars: things that stand in the scene",
                      [&scene](FieldVisitor& object, SceneObject& value) { visit_object(object, scene, value); });
  visitor.nested_list("scatter", scene.scatter,
                      "things strewn at random around the drivable area, other ones for each seed",
                      [&scene](FieldVisitor& scatter, SceneScatter& value) { visit_scatter(scatter, scene, value); });
  visitor.section(
      "straight_path", [&](FieldVisitor& path) { visit_straight_path(path, scene.world.straight_path); },
      "where a robot can drive straight ahead without the board in view");
}

// With their true mounting and the rig's intrinsics.
std::vector<WorldCamera> world_cameras(const RigModel& rig) {
  std::vector<WorldCamera> cameras;
  for (std::size_t i = 0; i < rig.rig.cameras.size(); ++i) {
    const RigCamera& camera = rig.rig.cameras[i];
    cameras.push_back({camera.name, rig.T_robot_camera[i], camera.camera});
    if (camera.depth) cameras.back().depth_camera = camera.depth->own_camera;
  }
  return cameras;
}

}  // namespace

Rigid3 mount_pose(double x_m, double y_m, double z_m, double roll_deg, double pitch_deg, double yaw_deg) {
  const Eigen::Quaterniond body = rotation_z(deg_to_rad(yaw_deg)) *
                                  Eigen::AngleAxisd(deg_to_rad(pitch_deg), Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(deg_to_rad(roll_deg), Eigen::Vector3d::UnitX());
  return Rigid3(body * optical_in_body(), Eigen::Vector3d(x_m, y_m, z_m));
}

Rigid3 place_board(const Board& board, const BoardPlacement& placement) {
  // A board that faces along world x shows a viewer, who looks along -x, its x axis to the right (world y) and its
  // y axis down.
  Eigen::Matrix3d upright;
  upright << 0.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  const Eigen::Quaterniond rotation = rotation_z(deg_to_rad(placement.facing_deg)) *
                                      Eigen::AngleAxisd(-deg_to_rad(placement.lean_deg), Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(deg_to_rad(placement.roll_deg), Eigen::Vector3d::UnitX()) *
                                      Eigen::Quaterniond(upright);
  const Eigen::Vector3d middle(placement.x_m, placement.y_m, placement.z_m);
  return Rigid3(rotation, middle - rotation * board.centre());
}

BoardPlacement BoardPlacementRange::sample(RandomStream& random) const {
  // Braces: drawn from left to right.
  return {x_m.sample(random),        y_m.sample(random),      z_m.sample(random),
          facing_deg.sample(random), lean_deg.sample(random), roll_deg.sample(random)};
}

BoardPlacement BoardPlacementRange::middle() const {
  return {x_m.mean(), y_m.mean(), z_m.mean(), facing_deg.mean(), lean_deg.mean(), roll_deg.mean()};
}

RobotModel load_robot_model(const std::string& name_or_file) {
  const std::filesystem::path file = find_data_file("robots", name_or_file);
  RobotModel robot;
  robot.file = file;
  robot.name = file.stem().string();
  std::string mjcf;
  read_fields(file, [&](FieldVisitor& visitor) { visit_robot(visitor, robot, mjcf); });
  robot.mjcf = beside(file, mjcf);
  return robot;
}

std::string robot_schema() {
  RobotModel robot;
  std::string mjcf;
  return schema_of_fields("Rigproof robot", [&](FieldVisitor& visitor) { visit_robot(visitor, robot, mjcf); });
}

std::string rig_model_schema() {
  RigModel rig;
  std::string robot;
  return schema_of_fields("Rigproof simulated rig",
                          [&](FieldVisitor& visitor) { visit_rig_model(visitor, rig, robot); }, {1, false});
}

std::string scene_schema() {
  SceneModel scene;
  std::string mjcf;
  return schema_of_fields("Rigproof scene", [&](FieldVisitor& visitor) { visit_scene(visitor, scene, mjcf); });
}

RigModel load_rig_model(const std::string& name_or_file) {
  const std::filesystem::path file = find_data_file("rigs", name_or_file);
  RigModel rig;
  rig.name = rig.rig.name = file.stem().string();
  std::string robot;
  read_fields_of_tree(read_yaml_file(file), [&](FieldVisitor& visitor) { visit_rig_model(visitor, rig, robot); });
  for (RigCamera& camera : rig.rig.cameras)
    if (camera.folder.empty()) camera.folder = camera.name;
  rig.robot = load_robot_model(robot);
  return rig;
}

SceneModel load_scene_model(const std::string& name_or_file) {
  const std::filesystem::path file = find_data_file("scenes", name_or_file);
  SceneModel scene;
  scene.name = file.stem().string();
  std::string mjcf;
  read_fields(file, [&](FieldVisitor& visitor) {
    visit_scene(visitor, scene, mjcf);
    for (const SceneTexture& texture : scene.world.textures) {
      std::error_code ignored;
      const bool exists =
          texture.file.empty() || std::filesystem::is_regular_file(beside(file, texture.file.string()), ignored);
      visitor.check(exists, "textures",
                    for_message(texture.name) + ": there is no image " + for_message(texture.file.string()) +
                        " beside the scene");
    }
  });
  scene.world.mjcf = beside(file, mjcf);
  for (SceneTexture& texture : scene.world.textures)
    if (!texture.file.empty()) texture.file = beside(file, texture.file.string());
  return scene;
}

std::string scene_text(const SceneModel& scene) {
  SceneModel plain = scene;
  plain.description.clear();
  for (SceneTexture& texture : plain.world.textures) texture.file = texture.file.filename();
  std::string mjcf = plain.world.mjcf.filename().string();
  return write_fields([&](FieldVisitor& visitor) { visit_scene(visitor, plain, mjcf); });
}

std::vector<std::string> rig_model_names() {
  std::vector<std::string> names = list_presets("rigs");
  // Folders hold variants of one rig for sweeps.
  names.erase(std::remove_if(names.begin(), names.end(),
                             [](const std::string& name) { return name.find('/') != std::string::npos; }),
              names.end());
  return names;
}
std::vector<std::string> scene_model_names() { return list_presets("scenes"); }

WorldDescription describe_world(const RigModel& rig, const SceneModel& scene, const Board& board,
                                const Rigid3& T_world_board, std::uint64_t seed) {
  WorldDescription description;
  description.robot_mjcf = rig.robot.mjcf;
  description.scene = strewn(scene, seed).world;
  description.scene_seed = seed;
  description.cameras = world_cameras(rig);
  description.board = board;
  description.T_world_board = T_world_board;
  return description;
}

}  // namespace rigproof
