#include "rigproof/truth/truth.h"

#include <algorithm>

#include "rigproof/core/files.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/truth/truth_schema.h"

namespace rigproof {
namespace {

// A hundred thousand stops.
constexpr std::uintmax_t kMaxBytes = 64U << 20U;
const char* const kFormat = "rigproof-truth";
constexpr int kVersion = 1;
// What the poses in `stops` are, for people who read the file.
const char* const kStopPose = "T_world_robot in the middle of the exposure of the middle row";

void visit_required(FieldVisitor& visitor, const char* key, Rigid3& T, const char* description) {
  visitor.require(key, "{translation_m, quaternion_xyzw}");
  visitor.nested(key, T, description);
}

// Both or none.
void visit_velocity(FieldVisitor& visitor, std::optional<Vector6d>& velocity) {
  const Vector6d v = velocity.value_or(Vector6d::Zero());
  std::vector<double> linear = {v[0], v[1], v[2]}, angular = {v[3], v[4], v[5]};
  const bool is_linear = visitor.takes("velocity_m_s", velocity.has_value());
  const bool is_angular = visitor.takes("turn_rate_rad_s", velocity.has_value());
  visitor.check(is_linear == is_angular, is_linear ? "velocity_m_s" : "turn_rate_rad_s",
                "velocity_m_s and turn_rate_rad_s belong together");
  if (!is_linear || !is_angular) return;
  visitor.field("velocity_m_s", linear, {-1e3, 1e3}, 3, 3, "of the robot, along its own axes");
  visitor.field("turn_rate_rad_s", angular, {-1e3, 1e3}, 3, 3, "of the robot, about its own axes");
  if (!visitor.is_reading()) return;
  velocity.emplace();
  *velocity << linear[0], linear[1], linear[2], angular[0], angular[1], angular[2];
}

void visit_odometry(FieldVisitor& visitor, Truth& truth) {
  visitor.nested("noise", truth.odometry_noise, "what it was drawn with");
  visitor.field("scale", truth.odometry_scale, {0.01, 100.0}, "measured over true length of a motion");
  visitor.field("yaw_factor", truth.odometry_yaw_factor, {0.01, 100.0}, "measured over true angle of a turn");
}

void visit_corners(FieldVisitor& visitor, TrueBoard& truth) {
  if (!visitor.takes("printed_corners_m", !truth.printed_corners.empty())) return;
  std::vector<std::vector<double>> rows;
  for (const Eigen::Vector3d& p : truth.printed_corners) rows.push_back({p.x(), p.y(), p.z()});
  visitor.field("printed_corners_m", rows, {-1e3, 1e3}, 3, "where its corners truly are, by id, in the board's frame");
  if (!visitor.is_reading()) return;
  const std::size_t corners = static_cast<std::size_t>(std::max(0, truth.board.corner_count()));
  visitor.check(rows.size() == corners, "printed_corners_m",
                "must have a corner of the board in each line: " + std::to_string(corners));
  if (rows.size() != corners) return;
  truth.printed_corners.clear();
  for (const std::vector<double>& row : rows) truth.printed_corners.emplace_back(row[0], row[1], row[2]);
}

void visit_true_board(FieldVisitor& visitor, TrueBoard& truth) {
  visitor.require("board", "{type, squares, square_mm}");
  visitor.nested("board", truth.board, "as it is told");
  visit_corners(visitor, truth);
  visit_required(visitor, "T_world_board", truth.T_world_board, "pose of the board in the world");
}

}  // namespace

static void visit_fields(FieldVisitor& visitor, LensResidual& field) {
  for (const char* key : {"cell_px", "columns", "dx_px", "dy_px"}) visitor.require(key, "a value");
  visitor.field("cell_px", field.cell_px, {1.0, 1e5},
                "distance of the lattice's nodes; the first is two cells outside");
  visitor.field("columns", field.columns, {4.0, 1e4}, "nodes in a row of the lattice");
  visitor.field("dx_px", field.dx_px, {-100.0, 100.0}, 16, 1U << 20U, "coefficients to the right, row by row");
  visitor.field("dy_px", field.dy_px, {-100.0, 100.0}, 16, 1U << 20U, "the same downwards");
  const bool whole = field.columns >= 4 && field.dx_px.size() == field.dy_px.size() && field.rows() >= 4 &&
                     field.dx_px.size() % static_cast<std::size_t>(field.columns) == 0;
  visitor.check(whole || !visitor.is_reading(), "dx_px",
                "dx_px and dy_px must have as many numbers, in four rows or more of `columns`");
}

static void visit_fields(FieldVisitor& visitor, TrueStop& stop) {
  visitor.on_one_line();
  visitor.require("stamp_s", "a number");
  visitor.field("stamp_s", stop.stamp_s, {}, "of the robot's clock");
  visit_pose(visitor, stop.T_world_robot);
  visit_velocity(visitor, stop.velocity);
}

static void visit_fields(FieldVisitor& visitor, TrueCamera& camera) {
  visit_required(visitor, "T_robot_camera", camera.T_robot_camera, "pose of the camera in the robot");
  visitor.require("intrinsics", "a block of intrinsics");
  visitor.nested("intrinsics", camera.camera, "true ones; the recording may tell others");
  visitor.field("depth_scale", camera.depth_scale, {0.1, 10.0}, "measured over true depth");
  visitor.nested("depth_camera", camera.depth_camera, "where depth is not registered to colour");
  visitor.nested("lens_residual", camera.lens_residual,
                 "what the lens does beyond its intrinsics: cubic B-splines over a lattice in the image");
  visitor.field("sensing", camera.sensing, "what else is simulated of the sensor, by name with unit", true);
  if (visitor.takes("stops", !camera.stops.empty()))
    visitor.nested_list("stops", camera.stops, "of a camera that takes its images while the robot moves");
}

static void visit_fields(FieldVisitor& visitor, TrueBoard& board) { visit_true_board(visitor, board); }

static void visit_fields(FieldVisitor& visitor, Truth& truth) {
  visitor.format(kFormat, kVersion);
  visitor.field("scene", truth.scene, TextChoices{}, "the world");
  visitor.require("seed", "a whole number, >= 0");
  visitor.field("seed", truth.seed, "of all random numbers");
  visit_true_board(visitor, truth);
  if (visitor.takes("more_boards", !truth.more_boards.empty()))
    visitor.nested_list("more_boards", truth.more_boards,
                        "boards that stand elsewhere, as in the recording's rig.yaml");
  visitor.require("odometry", "a block with noise, scale, yaw_factor");
  visitor.section(
      "odometry", [&truth](FieldVisitor& block) { visit_odometry(block, truth); }, "what is wrong with it");
  visitor.field("drawn", truth.drawn, "what was drawn once for the run, by the field of its configuration");
  visitor.nested("T_robot_chassis", truth.T_robot_chassis,
                 "how the frame of the rig's mountings stands, on unequal wheels or under a load");
  visitor.require("cameras", "a map of cameras by name");
  visitor.map("cameras",
              map_by_name(truth.cameras, [](FieldVisitor& block, TrueCamera& camera) { visit_fields(block, camera); }),
              "in the order of the recording");
  std::string stop_pose = kStopPose;
  visitor.field("stop_pose", stop_pose, TextChoices{}, "what the poses of stops are, for people");
  visitor.require("stops", "a list of stops");
  visitor.nested_list("stops", truth.stops, "where the robot was when images were taken");
}

bool Truth::project_corner(std::size_t camera, const TrueStop& stop, const TrueBoard& seen, int id, double row,
                           Eigen::Vector2d* pixel) const {
  const TrueCamera& seeing = cameras[camera];
  const auto readout_ms = seeing.sensing.find("readout_ms");
  const double readout_s = readout_ms == seeing.sensing.end() ? 0.0 : readout_ms->second / 1000.0;
  const Rigid3 T_world_robot = stop.T_world_robot_after(row_delay_s(row, seeing.camera.height_px, readout_s));
  return seeing.project((T_world_robot * seeing.T_robot_camera).inverse() * (seen.T_world_board * seen.corner(id)),
                        pixel);
}

Truth load_truth(const std::filesystem::path& file) {
  Truth truth;
  read_fields_of_tree(read_yaml_file(file, kMaxBytes),
                      [&truth](FieldVisitor& visitor) { visit_fields(visitor, truth); });
  return truth;
}

void save_truth(const Truth& truth, const std::filesystem::path& file) {
  write_file_atomically(file, emit_yaml(tree_of(truth)));
}

std::string truth_schema() { return schema_of<Truth>("Rigproof truth: truth/truth.yaml", {kVersion, false}); }

}  // namespace rigproof
