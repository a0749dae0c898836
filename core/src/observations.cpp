#include "rigproof/core/observations.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "rigproof/core/file_schemas.h"
#include "rigproof/core/files.h"
#include "rigproof/core/finding_tree.h"
#include "rigproof/core/observations_text.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

// Ordered: the order of the cameras is their index.
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMaxBytes = 512U << 20U;
constexpr int kMaxDepth = 12;
constexpr int kVersion = 2;  // 1: exclusions were in words
constexpr std::size_t kMaxProblems = 50;
constexpr std::size_t kMaxNodes = 2000000;
const char* const kFormat = "rigproof-observations";

// ------------------------------------------------------------------------------------------------- what the file has

// Determinants of the leading blocks, to rounding.
bool is_positive(const Eigen::Matrix2d& c) {
  return c(0, 0) > 0.0 && c(1, 1) > 0.0 && c(0, 1) * c(0, 1) <= c(0, 0) * c(1, 1) * (1.0 + 1e-9);
}

bool is_positive(const Eigen::Matrix3d& c) {
  if (!(c.diagonal().minCoeff() > 0.0)) return false;
  // Scaled to correlations, so that one bound on rounding serves all sizes.
  const Eigen::Vector3d s = c.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d r = s.asDiagonal() * c * s.asDiagonal();
  const double minors = std::min({1.0 - r(0, 1) * r(0, 1), 1.0 - r(0, 2) * r(0, 2), 1.0 - r(1, 2) * r(1, 2)});
  return minors >= -1e-9 && r.determinant() >= -1e-9;
}

// By index other parts name a camera, and programs that rewrite JSON may sort the keys of `cameras`.
void visit_camera_order(FieldVisitor& visitor, std::vector<RigCamera>& cameras) {
  std::vector<std::string> order;
  for (const RigCamera& camera : cameras) order.push_back(camera.name);
  if (!visitor.takes("camera_order", cameras.size() > 1)) return;
  const std::vector<std::string> names = order;
  visitor.field("camera_order", order, "names of the cameras in the order of their indices; without it, as in cameras");
  const bool names_each =
      order.size() == names.size() && std::is_permutation(order.begin(), order.end(), names.begin());
  visitor.check(names_each, "camera_order", "must name each of the cameras once: " + joined(names));
  if (!visitor.is_reading() || !names_each) return;
  const auto index_of = [&order](const RigCamera& camera) {
    return std::find(order.begin(), order.end(), camera.name) - order.begin();
  };
  std::stable_sort(cameras.begin(), cameras.end(),
                   [&](const RigCamera& a, const RigCamera& b) { return index_of(a) < index_of(b); });
}

// What rig.yaml has, too, in the same words.
void visit_head(FieldVisitor& visitor, Observations& o) {
  visitor.format(kFormat, kVersion);
  visitor.field("source", o.source, TextChoices{}, "what they were observed in");
  visitor.field("robot_frame", o.robot_frame, TextChoices{}, "name of the robot frame in results");
  visitor.require("board", "{type, squares, square_mm}");
  visitor.nested("board", o.board, "the calibration board");
  visit_more_boards(visitor, o.more_boards);
  visitor.nested("odometry_noise", o.odometry_noise, "what is known of the odometry's noise");
  visitor.nested("accept", o.accept, "limits of rig.yaml on the stated uncertainty");
  visitor.require("cameras", "an object of cameras by name");
  visit_rig_cameras(visitor, {}, o.cameras);
  visit_camera_order(visitor, o.cameras);
}

void visit_index(FieldVisitor& visitor, const char* key, int& index, int low, std::size_t count) {
  const double high = visitor.is_reading() ? static_cast<double>(count) - 1.0 : NumberRange().max;
  visitor.require(key, "an index");
  visitor.field(key, index, {static_cast<double>(low), high}, "index into the file's list of them");
}

void visit_stop_and_camera(FieldVisitor& visitor, int& stop, int& camera, const Observations& o, int first_stop = 0) {
  visit_index(visitor, "stop", stop, first_stop, o.stops.size());
  visit_index(visitor, "camera", camera, 0, o.cameras.size());
}

void visit_file(FieldVisitor& visitor, std::string& file, const char* description) {
  visitor.require("file", "text");
  visitor.field("file", file, TextChoices{}, description);
}

void visit_way(FieldVisitor& visitor, std::vector<Eigen::Vector3d>& way) {
  if (!visitor.takes("way", !way.empty())) return;
  std::vector<std::vector<double>> rows;
  for (const Eigen::Vector3d& pose : way) rows.push_back({pose.x(), pose.y(), pose.z()});
  visitor.field("way", rows, {}, 3, "[x_m, y_m, yaw_rad] of odometry's rows since the stop before, thinned");
  way.clear();
  for (const std::vector<double>& row : rows)
    if (row.size() == 3) way.emplace_back(row[0], row[1], row[2]);
}

// (forward, left, turn) of a robot that moves; absent where zero.
void visit_motion(FieldVisitor& visitor, const char* along, const char* turn, Eigen::Vector3d& motion) {
  const bool moves = !motion.isZero(0.0);
  std::vector<double> xy = {motion.x(), motion.y()};
  if (visitor.takes(along, moves)) visitor.field(along, xy, {-1e3, 1e3}, 2, 2, "[forward, left] of a robot that moves");
  motion.head<2>() << xy[0], xy[1];
  if (visitor.takes(turn, moves)) visitor.field(turn, motion.z(), {-1e3, 1e3}, "of a robot that moves");
}

void visit_stop(FieldVisitor& visitor, Stop& stop) {
  visitor.required("stamp_s", stop.stamp_s, {}, "of the robot's clock");
  visitor.required("x_m", stop.x_m, {}, "of the odometry");
  visitor.required("y_m", stop.y_m, {}, "of the odometry");
  visitor.required("yaw_rad", stop.yaw_rad, {}, "of the odometry");
  visitor.required("interpolation_sigma_m", stop.interpolation_sigma_m, {0.0},
                   "of the interpolation between odometry's rows; 0 = a row was met");
  visit_way(visitor, stop.way);
  visit_motion(visitor, "velocity_m_per_s", "yaw_rate_rad_per_s", stop.velocity);
  visit_motion(visitor, "acceleration_m_per_s2", "yaw_acceleration_rad_per_s2", stop.acceleration);
}

std::vector<double> row_of(const CornerObservation& corner) {
  const Eigen::Matrix2d& c = corner.covariance_px2;
  return {static_cast<double>(corner.id), corner.pixel.x(), corner.pixel.y(), c(0, 0), c(0, 1), c(1, 1)};
}

// What is wrong with it, or nothing.
std::string fault_of(const std::vector<double>& row, int count, std::vector<bool>* seen) {
  if (row.size() != 6) return "a corner must be [id, u_px, v_px, cov_uu, cov_uv, cov_vv]";
  if (row[0] != std::floor(row[0]) || row[0] < 0.0 || row[0] >= count)
    return "a corner's id must be a whole number, 0 to " + std::to_string(count - 1);
  if ((*seen)[static_cast<std::size_t>(row[0])]) return "a corner is given twice";
  (*seen)[static_cast<std::size_t>(row[0])] = true;
  Eigen::Matrix2d covariance;
  covariance << row[3], row[4], row[4], row[5];
  if (is_positive(covariance)) return "";
  return "the covariance of a corner must be positive: cov_uu, cov_vv > 0, cov_uv^2 <= product";
}

CornerObservation corner_of(const std::vector<double>& row) {
  CornerObservation corner;
  corner.id = static_cast<int>(row[0]);
  corner.pixel << row[1], row[2];
  corner.covariance_px2 << row[3], row[4], row[4], row[5];
  return corner;
}

// @param board null where it is not known: whose ids they are cannot be told
void visit_corners(FieldVisitor& visitor, std::vector<CornerObservation>& corners, const Board* board) {
  std::vector<std::vector<double>> rows;
  for (const CornerObservation& corner : corners) rows.push_back(row_of(corner));
  visitor.require("corners", "a list of corners");
  visitor.field("corners", rows, {-1e9, 1e9}, 0, "[id, u_px, v_px, cov_uu, cov_uv, cov_vv] of each inner corner");
  if (!visitor.is_reading() || board == nullptr) return;
  std::vector<bool> seen(static_cast<std::size_t>(board->corner_count()), false);
  corners.clear();
  for (const std::vector<double>& row : rows) {
    const std::string fault = fault_of(row, board->corner_count(), &seen);
    visitor.check(fault.empty(), "corners", "entry " + std::to_string(&row - rows.data()) + ": " + fault);
    if (fault.empty()) corners.push_back(corner_of(row));
  }
}

// -> the board that the corners are of; null where there is no such one
const Board* visit_board_of(FieldVisitor& visitor, BoardView& view, const Observations& o) {
  const std::size_t problems = visitor.is_reading() ? visitor.problems()->all().size() : 0;
  if (visitor.takes("board", view.board != 0))
    visitor.field("board", view.board, {0.0, visitor.is_reading() ? o.boards() - 1.0 : NumberRange().max},
                  "which it is: 0, the default, is `board`, 1 the first of `more_boards`");
  const bool refused = visitor.is_reading() && visitor.problems()->all().size() != problems;
  return !refused && view.board >= 0 && view.board < o.boards() ? &o.board_at(view.board) : nullptr;
}

void visit_view(FieldVisitor& visitor, BoardView& view, const Observations& o) {
  visit_stop_and_camera(visitor, view.stop, view.camera, o);
  visitor.required("stamp_s", view.stamp_s, {}, "of the image");
  visit_file(visitor, view.file, "the image");
  visit_corners(visitor, view.corners, visit_board_of(visitor, view, o));
}

void visit_plane_values(FieldVisitor& visitor, Eigen::Vector3d& plane, Eigen::Matrix3d& covariance) {
  std::vector<double> a = {plane.x(), plane.y(), plane.z()}, c;
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = i; j < 3; ++j) c.push_back(covariance(i, j));
  visitor.require("inverse_depth_plane_per_m", "three numbers");
  visitor.field("inverse_depth_plane_per_m", a, {}, 3, 3, "a, three numbers");
  visitor.require("covariance_per_m2", "six numbers");
  visitor.field("covariance_per_m2", c, {}, 6, 6, "of a: the upper triangle, row by row");
  plane << a[0], a[1], a[2];
  covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  visitor.check(is_positive(covariance), "covariance_per_m2", "must be the upper triangle of a positive covariance");
}

void visit_plane(FieldVisitor& visitor, PlaneObservation& plane, const Observations& o) {
  visit_stop_and_camera(visitor, plane.stop, plane.camera, o);
  visit_file(visitor, plane.file, "the depth image");
  visit_plane_values(visitor, plane.inverse_depth_plane, plane.covariance_per_m2);
  visitor.required("effective_points", plane.effective_points, {0.0}, "independent measurements");
  visitor.require("inlier_points", "a whole number");
  visitor.field("inlier_points", plane.inlier_points, {0.0, 2147483647.0}, "points on the plane");
  visitor.required("residual_rms_sigma", plane.residual_rms, {0.0}, "of them, in the sensor's sigmas");
}

void visit_exclusion(FieldVisitor& visitor, Exclusion& exclusion, const Observations& o) {
  visit_stop_and_camera(visitor, exclusion.stop, exclusion.camera, o, -1);
  visit_file(visitor, exclusion.file, "the image");
  visit_why(visitor, exclusion, {});
}

// Each list: its key, its elements, what it holds, and what visits one of them.
template <typename Do>
void for_each_list(Observations& o, const Do& act) {
  const auto with_rest = [&o](auto visit) {
    return [&o, visit](FieldVisitor& visitor, auto& element) { visit(visitor, element, o); };
  };
  const char* const planes = "planes in depth images: 1/z = a . (x/z, y/z, 1); sorted by stop, then camera";
  act("stops", o.stops, "where the robot took images, in the order of driving", visit_stop);
  act("board_views", o.board_views, "the board as a camera sees it from a stop; sorted by stop, then camera",
      with_rest(visit_view));
  act("ground_planes", o.ground_planes, planes, with_rest(visit_plane));
  act("board_planes", o.board_planes, planes, with_rest(visit_plane));
  act("exclusions", o.exclusions, "what is not used, and why; of no stop: -1", with_rest(visit_exclusion));
}

void visit_observations(FieldVisitor& visitor, Observations& o) {
  visit_head(visitor, o);
  for_each_list(o, [&visitor](const char* key, auto& elements, const char* description, const auto& visit) {
    visitor.require(key, "a list");
    visitor.nested_list(key, elements, description, visit);
  });
}

// ---------------------------------------------------------------------------------------------------------- writing

// One element a line: readable, and a small change is a small difference.
std::string lines_of(const YamlTree& tree) {
  std::string lines;
  for (const YamlTree& item : tree.items) lines += (lines.empty() ? "\n  " : ",\n  ") + emit_json(item);
  for (const auto& [name, value] : tree.entries)
    lines += (lines.empty() ? "\n  \"" : ",\n  \"") + name + "\": " + emit_json(value);
  if (lines.empty()) return "[]";
  return tree.is_map() ? "{" + lines + "\n }" : "[" + lines + "\n ]";
}

std::string to_json(Observations o) {
  const YamlTree tree = tree_of_fields([&o](FieldVisitor& visitor) { visit_observations(visitor, o); });
  std::string out;
  for (const auto& [key, value] : tree.entries) {
    const bool in_lines = key == "cameras" || (value.is_sequence() && !value.flow);
    out += (out.empty()        ? "{\""
            : key == "version" ? ", \""
                               : ",\n \"") +
           key + "\": " + (in_lines ? lines_of(value) : emit_json(value));
  }
  return out + "}\n";
}

// ---------------------------------------------------------------------------------------------------------- reading

// Brackets outside of strings; deep nesting would cost memory long before it is refused for its shape.
void check_depth(const std::string& text, const std::string& file) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kMaxDepth) throw Error(file + ": nested deeper than " + std::to_string(kMaxDepth) + " levels");
  }
}

// What many small values cost in memory is far above what they cost on disk.
YamlTree tree_of_json(const Json& json, const std::string& file, std::size_t* nodes) {
  if (++*nodes > kMaxNodes) throw Error(file + ": one entry holds over " + std::to_string(kMaxNodes) + " values");
  YamlTree tree;
  tree.file = file;
  if (json.is_object()) {
    tree.kind = YamlTree::Kind::kMap;
    for (const auto& [key, value] : json.items()) tree.set(key, tree_of_json(value, file, nodes));
  } else if (json.is_array()) {
    tree.kind = YamlTree::Kind::kSequence;
    for (const Json& item : json) tree.add(tree_of_json(item, file, nodes));
  } else if (!json.is_null()) {
    tree.kind = YamlTree::Kind::kScalar;
    tree.quoted = json.is_string();
    tree.scalar = json.is_string() ? json.get<std::string>() : json.dump();
  }
  return tree;
}

YamlTree tree_of_json(const Json& json, const std::string& file) {
  std::size_t nodes = 0;
  return tree_of_json(json, file, &nodes);
}

// What calibration counts as one measurement must be given once.
template <typename Element>
void check_order(const std::vector<Element>& elements, const std::string& key, const std::string& file,
                 Problems* problems) {
  const auto place = [](const Element& e) { return std::make_pair(e.stop, e.camera); };
  for (std::size_t i = 1; i < elements.size(); ++i) {
    if (place(elements[i - 1]) < place(elements[i])) continue;
    const bool repeats = place(elements[i - 1]) == place(elements[i]);
    problems->add({file, 0, key + "[" + std::to_string(i) + "]", "",
                   repeats ? "is of stop " + std::to_string(elements[i].stop) + " and camera " +
                                 std::to_string(elements[i].camera) +
                                 ", as the entry before; one entry a stop and camera is allowed"
                           : "must be sorted by stop, then camera"});
    return;
  }
}

void check_stamps(const std::vector<Stop>& stops, const std::string& file, Problems* problems) {
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const double before = stops[i - 1].stamp_s, stamp = stops[i].stamp_s;
    if (before < stamp) continue;
    problems->add({file, 0, "stops[" + std::to_string(i) + "].stamp_s", number_text(stamp),
                   (before == stamp ? "repeats" : "is earlier than") + std::string(" the stamp of the stop before, ") +
                       number_text(before) + "; stops stand in the order of driving, and stamps must increase"});
    return;
  }
}

// An element at a time: as trees they all would need many times the memory.
template <typename Element, typename Visit>
void read_list(const Json& json, const std::string& key, const std::string& file, std::vector<Element>* elements,
               const Visit& visit, Problems* problems) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array()) {
    problems->add({file, 0, key, "", found == json.end() ? "is missing; it must be a list" : "must be a list"});
    return;
  }
  for (std::size_t i = 0; i < found->size() && problems->all().size() < kMaxProblems; ++i) {
    Element& element = elements->emplace_back();
    read_fields_of_block(tree_of_json((*found)[i], file), key + "[" + std::to_string(i) + "]", problems,
                         [&](FieldVisitor& visitor) { visit(visitor, element); });
  }
}

YamlTree head_of(const Json& json, const std::string& file) {
  std::vector<std::string> lists;
  Observations any;
  for_each_list(any, [&lists](const char* key, const auto&...) { lists.emplace_back(key); });
  YamlTree head = YamlTree::map();
  head.file = file;
  for (const auto& [key, value] : json.items())
    if (std::find(lists.begin(), lists.end(), key) == lists.end()) head.set(key, tree_of_json(value, file));
  return head;
}

Observations read_observations(const Json& json, const std::string& file) {
  Observations o;
  Problems problems;
  read_fields_of_block(head_of(json, file), "", &problems, [&o](FieldVisitor& visitor) { visit_head(visitor, o); });
  problems.throw_if_any();
  for_each_list(o, [&](const char* key, auto& elements, const char*, const auto& visit) {
    read_list(json, key, file, &elements, visit, &problems);
  });
  check_stamps(o.stops, file, &problems);
  check_order(o.board_views, "board_views", file, &problems);
  check_order(o.ground_planes, "ground_planes", file, &problems);
  check_order(o.board_planes, "board_planes", file, &problems);
  problems.throw_if_any();
  return o;
}

}  // namespace

std::string observations_text(const Observations& observations) { return to_json(observations); }

Observations parse_observations(const std::string& text, const std::string& name) {
  check_depth(text, name);
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::exception& error) {
    const std::string what = error.what();  // "[json.exception.parse_error.101] parse error at line 2, ..."
    throw Error(name + ": not valid JSON: " + for_message(what.substr(what.find("] ") + 2)));
  }
  if (!json.is_object()) throw Error(name + ": must be an object with format " + kFormat);
  return read_observations(json, name);
}

Observations load_observations(const std::filesystem::path& file) {
  return parse_observations(read_text_file(file, kMaxBytes), file.string());
}

std::string observations_schema() {
  Observations o;
  const auto visit = [&o](FieldVisitor& visitor) { visit_observations(visitor, o); };
  return schema_of_fields("Rigproof observations: observations.json", visit, {kVersion, false});
}

void save_observations(const Observations& observations, const std::filesystem::path& file) {
  write_file_atomically(file, to_json(observations));
}

}  // namespace rigproof
