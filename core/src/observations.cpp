#include "rigproof/core/observations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "finding_tree.h"
#include "rigproof/core/file_schemas.h"
#include "rigproof/core/files.h"
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
const char* const kFormat = "rigproof-observations";

// ---------------------------------------------------------------------------------------------------------- writing

// JSON has no -0 that reads back as one.
std::string number(double value) { return number_text(value + 0.0); }
std::string text(const std::string& value) { return Json(value).dump(-1, ' ', false, Json::error_handler_t::replace); }

template <typename... Values>
std::string numbers(const Values&... values) {
  std::string list;
  ((list += (list.empty() ? "" : ", ") + number(values)), ...);
  return "[" + list + "]";
}

std::string json_of(const CornerObservation& corner) {
  const Eigen::Matrix2d& c = corner.covariance_px2;
  return "[" + std::to_string(corner.id) + ", " + number(corner.pixel.x()) + ", " + number(corner.pixel.y()) + ", " +
         number(c(0, 0)) + ", " + number(c(0, 1)) + ", " + number(c(1, 1)) + "]";
}

std::string head_of(int stop, int camera) {
  return "{\"stop\": " + std::to_string(stop) + ", \"camera\": " + std::to_string(camera);
}

std::string json_of(const BoardView& view) {
  std::string corners;
  for (const CornerObservation& corner : view.corners) corners += (corners.empty() ? "" : ", ") + json_of(corner);
  return head_of(view.stop, view.camera) + ", \"stamp_s\": " + number(view.stamp_s) + ", \"file\": " + text(view.file) +
         ", \"corners\": [" + corners + "]}";
}

std::string json_of(const PlaneObservation& plane) {
  const Eigen::Vector3d& a = plane.inverse_depth_plane;
  const Eigen::Matrix3d& c = plane.covariance_per_m2;
  return head_of(plane.stop, plane.camera) + ", \"file\": " + text(plane.file) +
         ", \"inverse_depth_plane_per_m\": " + numbers(a.x(), a.y(), a.z()) +
         ", \"covariance_per_m2\": " + numbers(c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)) +
         ", \"effective_points\": " + number(plane.effective_points) +
         ", \"inlier_points\": " + std::to_string(plane.inlier_points) +
         ", \"residual_rms_sigma\": " + number(plane.residual_rms) + "}";
}

std::string json_of(const Stop& stop) {
  std::string way;
  const Eigen::Vector3d& v = stop.velocity;
  for (const Eigen::Vector3d& pose : stop.way) way += (way.empty() ? "" : ", ") + numbers(pose.x(), pose.y(), pose.z());
  return "{\"stamp_s\": " + number(stop.stamp_s) + ", \"x_m\": " + number(stop.x_m) + ", \"y_m\": " + number(stop.y_m) +
         ", \"yaw_rad\": " + number(stop.yaw_rad) +
         ", \"interpolation_sigma_m\": " + number(stop.interpolation_sigma_m) +
         (way.empty() ? "" : ", \"way\": [" + way + "]") +
         (v.isZero(0.0)
              ? ""
              : ", \"velocity_m_per_s\": " + numbers(v.x(), v.y()) + ", \"yaw_rate_rad_per_s\": " + number(v.z())) +
         "}";
}

std::string json_of(const Exclusion& exclusion) {
  YamlTree tree = YamlTree::map();
  set_exclusion(exclusion, {}, &tree);
  return head_of(exclusion.stop, exclusion.camera) + ", \"file\": " + text(exclusion.file) + ", " +
         emit_json(tree, -1).substr(1);
}

// One element a line: readable, and a small change is a small difference.
template <typename Element>
std::string list_of(const std::vector<Element>& elements) {
  std::string lines;
  for (const Element& element : elements) lines += (lines.empty() ? "\n  " : ",\n  ") + json_of(element);
  return elements.empty() ? "[]" : "[" + lines + "\n ]";
}

// What rig.yaml has, too, in the same words.
void visit_head(FieldVisitor& visitor, Observations& o) {
  visitor.format(kFormat, kVersion);
  visitor.field("source", o.source, TextChoices{}, "what they were observed in");
  visitor.field("robot_frame", o.robot_frame, TextChoices{}, "name of the robot frame in results");
  visitor.require("board", "{type, squares, square_mm}");
  visitor.nested("board", o.board, "the calibration board");
  visitor.nested("odometry_noise", o.odometry_noise, "what is known of the odometry's noise");
  visitor.nested("accept", o.accept, "limits of rig.yaml on the stated uncertainty");
  visitor.require("cameras", "an object of cameras by name");
  visit_rig_cameras(visitor, {}, o.cameras);
}

std::string cameras_json(const YamlTree& cameras) {
  std::string lines;
  for (const auto& [name, camera] : cameras.entries)
    lines += (lines.empty() ? "\n  " : ",\n  ") + text(name) + ": " + emit_json(camera);
  return "{" + lines + "\n }";
}

std::string to_json(Observations o) {
  std::string out;
  const auto add = [&out](const std::string& key, const std::string& value) {
    out += (out.empty() ? "{" : key == "version" ? ", " : ",\n ") + text(key) + ": " + value;
  };
  const YamlTree head = tree_of_fields([&o](FieldVisitor& visitor) { visit_head(visitor, o); });
  for (const auto& [key, value] : head.entries) add(key, key == "cameras" ? cameras_json(value) : emit_json(value));
  add("stops", list_of(o.stops));
  add("board_views", list_of(o.board_views));
  add("ground_planes", list_of(o.ground_planes));
  add("board_planes", list_of(o.board_planes));
  add("exclusions", list_of(o.exclusions));
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

// The parts that rig.yaml has, too, go through the same readers.
YamlTree tree_of_json(const Json& json, const std::string& file) {
  YamlTree tree;
  tree.file = file;
  if (json.is_object()) {
    tree.kind = YamlTree::Kind::kMap;
    for (const auto& [key, value] : json.items()) tree.set(key, tree_of_json(value, file));
  } else if (json.is_array()) {
    tree.kind = YamlTree::Kind::kSequence;
    for (const Json& item : json) tree.add(tree_of_json(item, file));
  } else if (!json.is_null()) {
    tree.kind = YamlTree::Kind::kScalar;
    tree.quoted = json.is_string();
    tree.scalar = json.is_string()         ? json.get<std::string>()
                  : json.is_number_float() ? number_text(json.get<double>())
                                           : json.dump();
  }
  return tree;
}

std::string shown(const Json& json) {
  if (json.is_array()) return "a list of " + std::to_string(json.size());
  if (json.is_object()) return "a block";
  return for_message(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// Reads the entries of one element of a list; keeps count of what was asked for, to find unknown keys.
class ElementReader {
 public:
  ElementReader(const Json& json, std::string path, const std::string& file, Problems* problems)
      : json_(json), path_(std::move(path)), file_(file), problems_(problems) {
    if (!json.is_object()) problem("", json, "must be an object");
  }

  double number(const char* key, const NumberRange& range = {}) {
    const Json* value = find(key);
    return value ? checked(*value, key, range) : 0.0;
  }
  int index(const char* key, int low, std::size_t count) {
    const Json* value = find(key);
    if (value == nullptr) return 0;
    const auto high = static_cast<std::int64_t>(count) - 1;
    if (value->is_number_integer() && *value >= low && *value <= high) return value->get<int>();
    problem(key, *value, "must be a whole number, " + std::to_string(low) + " to " + std::to_string(high));
    return 0;
  }
  std::string text(const char* key) {
    const Json* value = find(key);
    if (value == nullptr) return "";
    if (value->is_string()) return value->get<std::string>();
    problem(key, *value, "must be text");
    return "";
  }
  std::vector<double> numbers(const char* key, std::size_t size) {
    const Json* value = find(key);
    return value == nullptr ? std::vector<double>(size, 0.0) : checked_numbers(*value, key, size);
  }
  std::vector<double> checked_numbers(const Json& value, const char* key, std::size_t size) {
    std::vector<double> list(size, 0.0);
    if (!value.is_array() || value.size() != size) {
      problem(key, value, "must be a list of " + std::to_string(size) + " numbers");
      return list;
    }
    for (std::size_t i = 0; i < size; ++i) list[i] = checked(value[i], key, {});
    return list;
  }
  bool has(const char* key) const { return json_.is_object() && json_.contains(key); }
  const Json* list(const char* key) {
    const Json* value = find(key);
    if (value != nullptr && value->is_array()) return value;
    if (value != nullptr) problem(key, *value, "must be a list");
    return nullptr;
  }
  double checked(const Json& value, const std::string& key, const NumberRange& range) {
    if (value.is_number()) {
      const double number = value.get<double>();
      if (std::isfinite(number) && number >= range.min && number <= range.max) return number;
    }
    const std::string limits = range_text(range);
    problem(key, value, "must be a finite number" + (limits.empty() ? "" : ", " + limits));
    return 0.0;
  }
  void problem(const std::string& key, const Json& value, const std::string& message) {
    if (problems_->all().size() < kMaxProblems)
      problems_->add({file_, 0, key.empty() ? path_ : path_ + "." + key, shown(value), message});
  }
  /// Entries that have the same reader in YAML.
  template <typename Read>
  void rest(const Read& read, const std::vector<std::string>& keys) {
    YamlTree tree = YamlTree::map();
    tree.file = file_;
    for (const std::string& key : keys) {
      if (!has(key.c_str())) continue;
      tree.set(key, tree_of_json(json_.at(key), file_));
      known_.push_back(key);
    }
    MapReader map(tree, path_, problems_);
    read(&map);
    map.finish();
  }
  void finish() {
    if (!json_.is_object() || json_.size() == known_.size()) return;
    for (const auto& [key, value] : json_.items())
      if (std::find(known_.begin(), known_.end(), key) == known_.end())
        problems_->add({file_, 0, path_ + "." + for_message(key), "", "unknown key; " + suggestion(key, known_)});
  }

 private:
  const Json* find(const char* key) {
    if (!json_.is_object()) return nullptr;
    const auto found = json_.find(key);
    if (found == json_.end()) {
      if (problems_->all().size() < kMaxProblems) problems_->add({file_, 0, path_ + "." + key, "", "is missing"});
      return nullptr;
    }
    known_.emplace_back(key);
    return &*found;
  }

  const Json& json_;
  std::string path_;
  const std::string& file_;
  Problems* problems_;
  std::vector<std::string> known_;
};

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

class ObservationsReader {
 public:
  ObservationsReader(const Json& json, std::string file) : json_(json), file_(std::move(file)) {}

  Observations read() {
    read_head();
    problems_.throw_if_any();
    read_list("stops", &o_.stops, [this](ElementReader& e) { return read_stop(e); });
    read_list("board_views", &o_.board_views, [this](ElementReader& e) { return read_view(e); });
    read_list("ground_planes", &o_.ground_planes, [this](ElementReader& e) { return read_plane(e); });
    read_list("board_planes", &o_.board_planes, [this](ElementReader& e) { return read_plane(e); });
    read_list("exclusions", &o_.exclusions, [this](ElementReader& e) { return read_left_out(e); });
    check_stamps();
    check_order(o_.board_views, "board_views");
    check_order(o_.ground_planes, "ground_planes");
    check_order(o_.board_planes, "board_planes");
    problems_.throw_if_any();
    return std::move(o_);
  }

 private:
  void read_head() {
    YamlTree head = YamlTree::map();
    head.file = file_;
    static const std::vector<std::string> kLists = {"stops", "board_views", "ground_planes", "board_planes",
                                                    "exclusions"};
    for (const auto& [key, value] : json_.items())
      if (std::find(kLists.begin(), kLists.end(), key) == kLists.end()) head.set(key, tree_of_json(value, file_));
    read_fields_of_block(head, "", &problems_, [this](FieldVisitor& visitor) { visit_head(visitor, o_); });
  }

  template <typename Element, typename Read>
  void read_list(const std::string& key, std::vector<Element>* elements, const Read& read) {
    const auto found = json_.find(key);
    if (found == json_.end() || !found->is_array()) {
      problems_.add({file_, 0, key, found == json_.end() ? "" : shown(*found), "must be a list"});
      return;
    }
    elements->reserve(found->size());
    for (std::size_t i = 0; i < found->size() && problems_.all().size() < kMaxProblems; ++i) {
      ElementReader element((*found)[i], key + "[" + std::to_string(i) + "]", file_, &problems_);
      elements->push_back(read(element));
      element.finish();
    }
  }

  Stop read_stop(ElementReader& e) const {
    Stop stop;
    stop.stamp_s = e.number("stamp_s");
    stop.x_m = e.number("x_m");
    stop.y_m = e.number("y_m");
    stop.yaw_rad = e.number("yaw_rad");
    stop.interpolation_sigma_m = e.number("interpolation_sigma_m", {0.0});
    if (e.has("velocity_m_per_s")) {
      const std::vector<double> values = e.numbers("velocity_m_per_s", 2);
      stop.velocity.head<2>() << values[0], values[1];
    }
    if (e.has("yaw_rate_rad_per_s")) stop.velocity.z() = e.number("yaw_rate_rad_per_s");
    if (!e.has("way")) return stop;
    const Json* way = e.list("way");
    if (way == nullptr) return stop;
    for (const Json& pose : *way) {
      const std::vector<double> values = e.checked_numbers(pose, "way", 3);
      stop.way.emplace_back(values[0], values[1], values[2]);
    }
    return stop;
  }

  BoardView read_view(ElementReader& e) const {
    BoardView view;
    view.stop = e.index("stop", 0, o_.stops.size());
    view.camera = e.index("camera", 0, o_.cameras.size());
    view.stamp_s = e.number("stamp_s");
    view.file = e.text("file");
    const Json* corners = e.list("corners");
    if (corners == nullptr) return view;
    std::vector<bool> seen(static_cast<std::size_t>(o_.board.corner_count()), false);
    for (const Json& corner : *corners) view.corners.push_back(read_corner(corner, e, &seen));
    return view;
  }

  CornerObservation read_corner(const Json& json, ElementReader& e, std::vector<bool>* seen) const {
    CornerObservation corner;
    if (!json.is_array() || json.size() != 6) {
      e.problem("corners", json, "a corner must be [id, u_px, v_px, cov_uu, cov_uv, cov_vv]");
      return corner;
    }
    const int count = o_.board.corner_count();
    if (!json[0].is_number_integer() || json[0] < 0 || json[0] >= count) {
      e.problem("corners", json[0], "a corner's id must be a whole number, 0 to " + std::to_string(count - 1));
      return corner;
    }
    corner.id = json[0].get<int>();
    if ((*seen)[static_cast<std::size_t>(corner.id)]) e.problem("corners", json[0], "a corner is given twice");
    (*seen)[static_cast<std::size_t>(corner.id)] = true;
    const auto value = [&](std::size_t i) { return e.checked(json[i], "corners", {-1e9, 1e9}); };
    corner.pixel << value(1), value(2);
    corner.covariance_px2 << value(3), value(4), value(4), value(5);
    if (!is_positive(corner.covariance_px2))
      e.problem("corners", json,
                "the covariance of a corner must be positive: cov_uu, cov_vv > 0, cov_uv^2 <= product");
    return corner;
  }

  PlaneObservation read_plane(ElementReader& e) const {
    PlaneObservation plane;
    plane.stop = e.index("stop", 0, o_.stops.size());
    plane.camera = e.index("camera", 0, o_.cameras.size());
    plane.file = e.text("file");
    const std::vector<double> a = e.numbers("inverse_depth_plane_per_m", 3);
    const std::vector<double> c = e.numbers("covariance_per_m2", 6);
    plane.inverse_depth_plane << a[0], a[1], a[2];
    plane.covariance_per_m2 << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
    plane.effective_points = e.number("effective_points", {0.0});
    plane.inlier_points = e.index("inlier_points", 0, std::numeric_limits<int>::max());
    plane.residual_rms = e.number("residual_rms_sigma", {0.0});
    if (!is_positive(plane.covariance_per_m2))
      e.problem("covariance_per_m2", Json(c), "must be the upper triangle of a positive covariance");
    return plane;
  }

  Exclusion read_left_out(ElementReader& e) const {
    Exclusion exclusion;
    exclusion.stop = e.index("stop", -1, o_.stops.size());
    exclusion.camera = e.index("camera", 0, o_.cameras.size());
    exclusion.file = e.text("file");
    e.rest([&exclusion](MapReader* map) { read_exclusion(map, &exclusion); },
           {"code", "depth", "values", "because", "reason", "sentence"});
    return exclusion;
  }

  // What calibration counts as one measurement must be given once.
  template <typename Element>
  void check_order(const std::vector<Element>& elements, const std::string& key) {
    for (std::size_t i = 1; i < elements.size(); ++i) {
      const auto place = [](const Element& e) { return std::make_pair(e.stop, e.camera); };
      if (place(elements[i - 1]) < place(elements[i])) continue;
      const bool repeats = place(elements[i - 1]) == place(elements[i]);
      problems_.add({file_, 0, key + "[" + std::to_string(i) + "]", "",
                     repeats ? "is of stop " + std::to_string(elements[i].stop) + " and camera " +
                                   std::to_string(elements[i].camera) +
                                   ", as the entry before; one entry a stop and camera is allowed"
                             : "must be sorted by stop, then camera"});
      return;
    }
  }

  void check_stamps() {
    for (std::size_t i = 1; i < o_.stops.size(); ++i) {
      const double before = o_.stops[i - 1].stamp_s, stamp = o_.stops[i].stamp_s;
      if (before < stamp) continue;
      problems_.add({file_, 0, "stops[" + std::to_string(i) + "].stamp_s", number_text(stamp),
                     (before == stamp ? "repeats" : "is earlier than") +
                         std::string(" the stamp of the stop before, ") + number_text(before) +
                         "; stops stand in the order of driving, and stamps must increase"});
      return;
    }
  }

  const Json& json_;
  std::string file_;
  Problems problems_;
  Observations o_;
};

}  // namespace

Observations load_observations(const std::filesystem::path& file) {
  const std::string content = read_text_file(file, kMaxBytes);
  check_depth(content, file.string());
  Json json;
  try {
    json = Json::parse(content);
  } catch (const Json::exception& error) {
    const std::string what = error.what();  // "[json.exception.parse_error.101] parse error at line 2, ..."
    throw Error(file.string() + ": not valid JSON: " + for_message(what.substr(what.find("] ") + 2)));
  }
  if (!json.is_object()) throw Error(file.string() + ": must be an object with format " + kFormat);
  return ObservationsReader(json, file.string()).read();
}

std::string observations_schema() {
  Observations o;
  const std::vector<KeyLine> lists = {
      {"stops[]", "", "where the robot took images, in the order of driving"},
      {"stops[].stamp_s", "number", "of the robot's clock"},
      {"stops[].x_m", "number", "of the odometry"},
      {"stops[].y_m", "number", "of the odometry"},
      {"stops[].yaw_rad", "number", "of the odometry"},
      {"stops[].interpolation_sigma_m", "number", "of the interpolation between odometry's rows; 0 = a row was met"},
      {"stops[].way[]?", "numbers", "[x_m, y_m, yaw_rad] of odometry's rows since the stop before, thinned"},
      {"stops[].velocity_m_per_s?", "numbers", "[forward, left] of a robot that moves"},
      {"stops[].yaw_rate_rad_per_s?", "number", "of a robot that moves"},
      {"board_views[]", "", "the board as a camera sees it from a stop; sorted by stop, then camera"},
      {"board_views[].stop", "integer", "index into stops"},
      {"board_views[].camera", "integer", "index into cameras"},
      {"board_views[].stamp_s", "number", "of the image"},
      {"board_views[].file", "text", "the image"},
      {"board_views[].corners[]", "numbers", "[id, u_px, v_px, cov_uu, cov_uv, cov_vv] of an inner corner"},
      {"exclusions[]", "", "what is not used, and why"},
      {"exclusions[].camera", "integer", "index into cameras"}};
  SchemaOptions options{kVersion, false, lists};
  for (const KeyLine& line : exclusion_keys("exclusions")) options.more.push_back(line);
  for (const std::string list : {"ground_planes[]", "board_planes[]"})
    for (const KeyLine& line :
         std::vector<KeyLine>{{"", "", "planes in depth images: 1/z = a . (x/z, y/z, 1); sorted by stop, then camera"},
                              {".stop", "integer", "index into stops"},
                              {".camera", "integer", "index into cameras"},
                              {".file", "text", "the depth image"},
                              {".inverse_depth_plane_per_m", "numbers", "a, three numbers"},
                              {".covariance_per_m2", "numbers", "of a: the upper triangle, row by row"},
                              {".effective_points", "number", "independent measurements"},
                              {".inlier_points", "integer", "points on the plane"},
                              {".residual_rms_sigma", "number", "of them, in the sensor's sigmas"}})
      options.more.push_back({list + line.path, line.type, line.description});
  return schema_of_fields(
      "Rigproof observations: observations.json", [&o](FieldVisitor& visitor) { visit_head(visitor, o); }, options);
}

void save_observations(const Observations& observations, const std::filesystem::path& file) {
  write_file_atomically(file, to_json(observations));
}

}  // namespace rigproof
