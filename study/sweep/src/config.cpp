#include "rigproof/study/sweep/config.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "rigproof/calib/diagnose/ml_settings.h"
#include "rigproof/calib/vision/ground_source.h"
#include "rigproof/core/error.h"
#include "rigproof/core/includes.h"
#include "rigproof/core/text.h"
#include "rigproof/generator/parameters.h"
#include "rigproof/study/workflow/overrides.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExternal = "external:";
constexpr const char* kImages = "images";
constexpr const char* kGeometric = "geometric.";
constexpr const char* kMeasured = "geometric.measured";  // a file, which is no level
constexpr std::size_t kMaxLevels = 10000;
constexpr std::int64_t kMaxSeed = 9007199254740992;

bool is_word(const std::string& text, const char* more) {
  return !text.empty() && text.size() < 100 && text[0] != '.' &&
         std::all_of(text.begin(), text.end(), [more](unsigned char c) {
           return std::isalnum(c) != 0 || std::string(more).find(static_cast<char>(c)) != std::string::npos;
         });
}

// Every field that an axis may set.
const std::vector<std::string>& known_fields() {
  static const std::vector<std::string> known = [] {
    std::vector<std::string> names;
    for (const Parameter& parameter : all_parameters())
      if (parameter.path != "name" && parameter.path != "scenes") names.push_back(parameter.path);
    for (const auto& [key, value] : tree_of(GeometricSweepConfig()).entries)
      if (kGeometric + key != kMeasured) names.push_back(kGeometric + key);
    names.push_back(kImages);
    return names;
  }();
  return known;
}

// The nearest known ones only: all of them would fill a page.
std::string field_suggestion(const std::string& name) {
  const std::optional<std::string> nearest = nearest_name(name, known_fields());
  std::string tail = name.substr(name.rfind('.') + 1);
  if (nearest) return "did you mean \"" + *nearest + "\"?";
  for (const std::string& known : known_fields())
    if (known.size() > tail.size() && known.compare(known.size() - tail.size() - 1, std::string::npos, "." + tail) == 0)
      return "did you mean \"" + known + "\"?";
  return "`rigproof schema run` lists those of a run; geometric.* and images are the others";
}

std::string label_of(const YamlTree& value) {
  if (value.is_scalar()) return value.scalar;
  if (value.is_null()) return "none";
  YamlTree flow = value;
  flow.flow = true;
  std::string text;
  if (value.is_sequence()) {
    std::vector<std::string> items;
    for (const YamlTree& item : value.items) items.push_back(label_of(item));
    return "[" + joined(items) + "]";
  }
  std::vector<std::string> items;
  for (const auto& [key, item] : value.entries) items.push_back(key + ": " + label_of(item));
  return "{" + joined(items) + "}";
}

class ConfigReader {
 public:
  ConfigReader(const YamlTree& tree, const fs::path& file) : map_(tree, "", &problems_), file_(file) {}

  SweepConfig read() {
    config_.name = map_.text("name").value_or(file_.stem().string());
    if (!is_word(config_.name, "_-.+")) map_.problem("name", "must be letters, digits, _, -, + and .");
    config_.geometric = map_.text("mode", {"rendered", "geometric"}).value_or("rendered") == "geometric";
    read_blocks();
    read_axes();
    read_seeds();
    read_methods();
    map_.finish();
    refuse_fields_set_twice();
    problems_.sort();
    problems_.throw_if_any();
    resolve();
    plan_sweep(config_);  // throws where a level's value is not allowed
    return std::move(config_);
  }

 private:
  void read_blocks() {
    config_.run = YamlTree::map();
    if (const YamlTree* run = map_.find("run"); run != nullptr && !run->is_null()) config_.run = resolve_includes(*run);
    for (const char* key : {"name", "scenes"}) {
      const YamlTree* entry = config_.run.find(key);
      if (entry == nullptr || std::string(key) == "name") continue;
      if (entry->is_sequence() && entry->items.empty()) continue;
      problems_.add({entry->file, entry->line, "run.scenes", entry->shown(),
                     "a sweep varies `scene` by an axis: world: {field: scene, values: [..], pool: true}"});
    }
    const YamlTree* geometric = map_.find("geometric");
    config_.geometric_block = geometric == nullptr ? YamlTree::map() : *geometric;
    for (auto& [key, value] : config_.geometric_block.entries)
      if (key == "measured" && value.is_scalar()) value.scalar = path_beside(value.scalar);
    if (geometric != nullptr && !config_.geometric) map_.problem("geometric", "belongs to mode: geometric");
  }

  void read_axes() {
    const YamlTree* axes = map_.find("axes");
    if (axes == nullptr || axes->is_null()) return;
    if (!axes->is_map()) return map_.problem("axes", "must be a block of axes by their names");
    for (const auto& [name, tree] : axes->entries) read_axis(name, tree);
  }

  void read_axis(const std::string& name, const YamlTree& tree) {
    static const std::set<std::string> taken = {"task",   "seed", "method", "subject", "camera",   "status",
                                                "reason", "axis", "unit",   "tasks",   "answered", "n"};
    const std::string path = "axes." + name;
    if (!is_word(name, "_") || taken.count(name) > 0)
      problems_.add(
          {tree.file, tree.line, path, "", "the name of an axis is letters, digits and _, and no other column's"});
    MapReader map(tree, path, &problems_);
    SweepAxis axis;
    axis.name = name;
    axis.title = map.text("title").value_or(name);
    axis.pooled = map.boolean("pool").value_or(false);
    const int ways = map.has("values") + map.has("range") + map.has("link") + map.has("points");
    if (ways != 1) map.problem("", "needs one of values, range, link, points");
    if (map.has("values") || map.has("range")) read_field_axis(&map, &axis);
    if (const YamlTree* link = map.find("link")) read_link(*link, &map, &axis);
    if (const YamlTree* points = map.find("points")) read_points(*points, &map, &axis);
    read_labels(&map, &axis);
    map.finish();
    refuse_equal_labels(tree, path, axis);
    config_.axes.push_back(std::move(axis));
  }

  void read_field_axis(MapReader* map, SweepAxis* axis) {
    map->require("field", "the dotted path of a field");
    const std::optional<std::string> field = map->text("field");
    if (!field) return;
    check_field(*field, *map->find("field"), map->path_of("field"));
    if (const YamlTree* values = map->find("values")) {
      if (!values->is_sequence() || values->items.empty()) return map->problem("values", "must be a list");
      for (const YamlTree& value : values->items) add_level(axis, {{*field, value}}, label_of(value));
    }
    if (const YamlTree* range = map->find("range"))
      for (const YamlTree& value : values_of_range(*range, map->path_of("range")))
        add_level(axis, {{*field, value}}, label_of(value));
  }

  std::vector<YamlTree> values_of_range(const YamlTree& tree, const std::string& path) {
    MapReader map(tree, path, &problems_);
    map.require("from", "a number");
    map.require("to", "a number");
    const auto from = map.number("from"), to = map.number("to"), step = map.number("step");
    const auto count = map.integer("count", {1, static_cast<double>(kMaxLevels)});
    const bool log = map.text("spacing", {"linear", "log"}).value_or("linear") == "log";
    map.finish();
    std::vector<YamlTree> values;
    if (!from || !to) return values;
    if (step.has_value() == count.has_value()) {
      map.problem("", "needs a step or a count");
      return values;
    }
    if (log && (step || *from <= 0.0 || *to <= 0.0)) {
      map.problem("spacing", "log needs a count and ends above 0");
      return values;
    }
    const double steps = step ? std::floor((*to - *from) / *step + 1e-9) : static_cast<double>(*count - 1);
    if (!(steps >= 0.0) || steps >= static_cast<double>(kMaxLevels)) {
      map.problem(step ? "step" : "count", "must lead from `from` to `to` in at most 10000 levels");
      return values;
    }
    for (int i = 0; i <= static_cast<int>(steps); ++i) {
      const double share = steps > 0.0 ? i / steps : 0.0;
      double value = step ? *from + i * *step : *from + share * (*to - *from);
      if (log) value = *from * std::pow(*to / *from, share);
      // 0.1 * 3 is 0.3 to a person.
      value = parse_number(short_text(value, 12)).value_or(value);
      YamlTree node = YamlTree::number(value);
      node.file = tree.file;
      node.line = tree.line;
      values.push_back(std::move(node));
    }
    return values;
  }

  void read_link(const YamlTree& link, MapReader* map, SweepAxis* axis) {
    if (!link.is_map() || link.entries.empty())
      return map->problem("link", "must be a block of fields, each with a list of values");
    std::size_t count = 0;
    for (const auto& [field, values] : link.entries) {
      check_field(field, values, map->path_of("link"));
      if (!values.is_sequence() || values.items.empty() || (count != 0 && values.items.size() != count))
        return problems_.add({values.file, values.line, map->path_of("link") + "." + field, values.shown(),
                              "must be a list, as long as those of the other fields"});
      count = values.items.size();
    }
    for (std::size_t i = 0; i < count; ++i) {
      std::vector<std::pair<std::string, YamlTree>> fields;
      for (const auto& [field, values] : link.entries) fields.emplace_back(field, values.items[i]);
      const std::string label = label_of(fields.front().second);
      add_level(axis, std::move(fields), label);
    }
  }

  void read_points(const YamlTree& points, MapReader* map, SweepAxis* axis) {
    if (!points.is_map() || points.entries.empty())
      return map->problem("points", "must be a block of points by their labels, each with the fields that it sets");
    for (const auto& [label, point] : points.entries) {
      if (!point.is_map() && !point.is_null()) {
        problems_.add(
            {point.file, point.line, map->path_of("points") + "." + label, point.shown(), "must be a block of fields"});
        continue;
      }
      std::vector<std::pair<std::string, YamlTree>> fields;
      for (const auto& [field, value] : point.entries) {
        check_field(field, value, map->path_of("points") + "." + label);
        fields.emplace_back(field, value);
      }
      add_level(axis, std::move(fields), label);
    }
  }

  static void add_level(SweepAxis* axis, std::vector<std::pair<std::string, YamlTree>> fields,
                        const std::string& label) {
    SweepLevel level;
    level.label = label;
    const std::optional<double> number = parse_number(label);
    level.value = number ? *number : static_cast<double>(axis->levels.size());
    level.fields = std::move(fields);
    axis->levels.push_back(std::move(level));
  }

  static void read_labels(MapReader* map, SweepAxis* axis) {
    const std::optional<std::vector<std::string>> labels = map->texts("labels");
    if (!labels) return;
    if (labels->size() != axis->levels.size())
      return map->problem("labels", "must be as many as the levels, " + std::to_string(axis->levels.size()));
    for (std::size_t i = 0; i < labels->size(); ++i) axis->levels[i].label = (*labels)[i];
  }

  void refuse_equal_labels(const YamlTree& tree, const std::string& path, const SweepAxis& axis) {
    std::set<std::string> seen;
    for (const SweepLevel& level : axis.levels)
      if (!seen.insert(level.label).second)
        problems_.add(
            {tree.file, tree.line, path, level.label, "two levels have this label; `labels` tells them apart"});
  }

  void check_field(const std::string& field, const YamlTree& where, const std::string& path) {
    const std::vector<std::string>& known = known_fields();
    if (std::find(known.begin(), known.end(), field) == known.end())
      problems_.add(
          {where.file, where.line, path, field, "is no field that can be varied; " + field_suggestion(field)});
    if (field.rfind(kGeometric, 0) == 0 && !config_.geometric)
      problems_.add({where.file, where.line, path, field, "belongs to mode: geometric"});
  }

  void read_seeds() {
    const YamlTree* tree = map_.find("seeds");
    if (tree == nullptr) return config_.seed_fields.clear();  // the run's own
    if (tree->is_scalar()) {
      if (const auto count = map_.integer("seeds", {1, static_cast<double>(kMaxLevels)})) count_seeds(0, *count);
      return;
    }
    if (tree->is_sequence()) return read_seed_list(*tree, "seeds");
    MapReader map(*tree, "seeds", &problems_);
    if (const YamlTree* field = map.find("field")) {
      config_.seed_fields = field->is_sequence() ? map.texts("field").value_or(std::vector<std::string>{})
                                                 : std::vector<std::string>{field->scalar};
      for (const std::string& name : config_.seed_fields) check_seed_field(name, *field);
    }
    const auto first = map.integer("first", {0, static_cast<double>(kMaxSeed)});
    const auto count = map.integer("count", {1, static_cast<double>(kMaxLevels)});
    if (const YamlTree* values = map.find("values")) {
      if (first || count) map.problem("values", "stands instead of first and count");
      read_seed_list(*values, "seeds.values");
    } else if (count) {
      count_seeds(first.value_or(0), *count);
    } else {
      map.problem("", "needs a count, or values");
    }
    map.finish();
  }

  void check_seed_field(const std::string& name, const YamlTree& where) {
    static const std::vector<std::string> fields = {"seed", "sensing.seed", "odometry.seed"};
    if (std::find(fields.begin(), fields.end(), name) == fields.end())
      problems_.add({where.file, where.line, "seeds.field", name, "is no seed; " + suggestion(name, fields)});
  }

  void read_seed_list(const YamlTree& tree, const std::string& path) {
    config_.seeds.clear();
    if (!tree.is_sequence() || tree.items.empty() || tree.items.size() > kMaxLevels)
      return problems_.add({tree.file, tree.line, path, tree.shown(), "must be a list of whole numbers"});
    for (const YamlTree& item : tree.items) {
      const auto seed = read_integer(item, path, {0, static_cast<double>(kMaxSeed)}, &problems_);
      if (!seed) continue;
      if (std::find(config_.seeds.begin(), config_.seeds.end(), *seed) != config_.seeds.end())
        problems_.add({item.file, item.line, path, item.shown(), "is in the list twice"});
      config_.seeds.push_back(*seed);
    }
  }

  void count_seeds(std::int64_t first, std::int64_t count) {
    config_.seeds.clear();
    for (std::int64_t i = 0; i < count; ++i) config_.seeds.push_back(first + i);
  }

  // A file that is named here, relative to this file, else to the working folder.
  std::string path_beside(const fs::path& named) const {
    const fs::path beside = fs::absolute(file_).parent_path() / named;
    std::error_code ignored;
    return (fs::exists(beside, ignored) ? beside : fs::absolute(named)).lexically_normal().string();
  }

  void read_methods() {
    config_.vision = read_vision(&map_, SweepVision());
    if (const YamlTree* methods = map_.find("methods")) {
      config_.methods.clear();
      if (!methods->is_sequence()) map_.problem("methods", "must be a list");
      for (const YamlTree& item : methods->items) read_method(item);
      if (methods->is_sequence() && methods->items.empty()) map_.problem("methods", "must name a method");
    }
    for (SweepMethodChoice& choice : config_.methods)
      if (!map_.has("methods")) choice.vision = config_.vision;
    std::set<std::string> labels;
    for (const SweepMethodChoice& choice : config_.methods)
      if (!labels.insert(choice.label()).second)
        map_.problem("methods", choice.label() + " is in the list twice; `name` tells one method's variants apart");
    const auto named = map_.text("reference");
    config_.reference = labels.count("ml") > 0 || config_.methods.empty() ? "ml" : config_.methods.front().label();
    if (named) config_.reference = labels.count(*named) > 0 ? *named : method_path(*named);
    if (named && labels.count(config_.reference) == 0) map_.problem("reference", "must be one of the methods");
  }

  // A text, or a block of a method with what is special about it.
  void read_method(const YamlTree& item) {
    SweepMethodChoice choice;
    choice.vision = config_.vision;
    if (!item.is_map()) {
      const auto name = read_text(item, "methods", {}, &problems_);
      if (!name) return;
      choice.method = method_path(*name);
    } else {
      MapReader map(item, "methods", &problems_);
      map.require("method", "as `rigproof methods` lists them, or external:FILE.yaml");
      if (const auto method = map.text("method")) choice.method = method_path(*method);
      choice.name = map.text("name").value_or("");
      if (!choice.name.empty() && !is_word(choice.name, "_-.+"))
        map.problem("name", "must be letters, digits, _, -, + and .");
      choice.vision = read_vision(&map, config_.vision);
      map.finish();
    }
    config_.methods.push_back(std::move(choice));
  }

  SweepVision read_vision(MapReader* map, SweepVision vision) {
    vision.ground = map->text("ground", ground_source_names()).value_or(vision.ground);
    const std::string onnx = "onnx:";
    const auto network = [&](const char* key, bool or_sift, std::string* value) {
      const auto text = map->text(key);
      if (!text) return;
      const bool is_network = text->rfind(onnx, 0) == 0 && text->size() > onnx.size();
      *value = is_network ? onnx + path_beside(text->substr(onnx.size())) : *text;
      if (!is_network && !(or_sift && *text == "sift"))
        map->problem(key, or_sift ? "must be sift or onnx:FILE" : "must be onnx:FILE");
    };
    network("features", true, &vision.features);
    network("horizon", false, &vision.horizon);
    return vision;
  }

  // One from outside, or settings in a file, by an absolute path.
  std::string method_path(const std::string& method) const {
    const bool ml = method.rfind(kMlPrefix, 0) == 0;
    const std::string prefix = ml ? kMlPrefix : kExternal;
    if (ml && !names_ml_file(method.substr(prefix.size()))) return method;
    return method.rfind(prefix, 0) == 0 ? prefix + path_beside(method.substr(prefix.size())) : method;
  }

  void refuse_fields_set_twice() {
    std::map<std::string, std::string> set_by;
    if (config_.seeds.size() > 1)
      for (const std::string& field : config_.seed_fields) set_by[field] = "the seeds";
    for (const SweepAxis& axis : config_.axes) {
      std::set<std::string> fields;
      for (const SweepLevel& level : axis.levels)
        for (const auto& [field, value] : level.fields) fields.insert(field);
      for (const std::string& field : fields) {
        const auto [other, is_new] = set_by.emplace(field, "axis " + axis.name);
        if (!is_new) map_.problem("axes", field + " is set by axis " + axis.name + " and by " + other->second);
      }
    }
  }

  // What the sweep's folder keeps.
  void resolve() {
    YamlTree& tree = config_.resolved = YamlTree::map();
    tree.set("name", YamlTree::text(config_.name));
    tree.set("mode", YamlTree::text(config_.geometric ? "geometric" : "rendered"));
    tree.set("run", config_.run);
    if (config_.geometric) tree.set("geometric", config_.geometric_block);
    if (const YamlTree* axes = map_.find("axes"); axes != nullptr && !axes->is_null()) tree.set("axes", *axes);
    resolve_seeds(&tree);
    set_vision(config_.vision, SweepVision(), &tree);
    YamlTree& methods = tree.set("methods", YamlTree::sequence());
    for (const SweepMethodChoice& choice : config_.methods) methods.add(resolved_method(choice));
    tree.set("reference", YamlTree::text(config_.reference));
  }

  YamlTree resolved_method(const SweepMethodChoice& choice) const {
    if (choice.name.empty() && choice.vision.text() == config_.vision.text()) return YamlTree::text(choice.method);
    YamlTree tree = YamlTree::inline_map();
    tree.set("method", YamlTree::text(choice.method));
    if (!choice.name.empty()) tree.set("name", YamlTree::text(choice.name));
    set_vision(choice.vision, config_.vision, &tree);
    return tree;
  }

  // What differs from what holds anyway.
  static void set_vision(const SweepVision& vision, const SweepVision& usual, YamlTree* tree) {
    if (vision.ground != usual.ground) tree->set("ground", YamlTree::text(vision.ground));
    if (vision.features != usual.features) tree->set("features", YamlTree::text(vision.features));
    if (vision.horizon != usual.horizon) tree->set("horizon", YamlTree::text(vision.horizon));
  }

  void resolve_seeds(YamlTree* tree) const {
    if (config_.seed_fields.empty()) return;
    YamlTree& seeds = tree->set("seeds", YamlTree::map());
    YamlTree& fields = seeds.set("field", YamlTree::sequence());
    for (const std::string& field : config_.seed_fields) fields.add(YamlTree::text(field));
    YamlTree& values = seeds.set("values", YamlTree::sequence());
    values.flow = true;
    for (const std::int64_t seed : config_.seeds) values.add(YamlTree::integer(seed));
  }

  Problems problems_;
  MapReader map_;
  fs::path file_;
  SweepConfig config_;
};

}  // namespace

std::string SweepVision::text() const {
  return "ground " + ground + ", features " + features + (horizon.empty() ? "" : ", horizon " + horizon);
}

void GeometricSweepConfig::visit(FieldVisitor& visitor) {
  constexpr double kMany = 1e6;
  visitor.field("rig", rig, TextChoices{{"reference", "random", "run"}},
                "reference: the rig of the accuracy goals; random: cameras and board in any orientation, by the seed; "
                "run: rig, world, board and stops as the run plans them");
  visitor.field("cameras", cameras, {1.0, 8.0}, "of a random rig");
  visitor.field("drive", drive, TextChoices{{"random", "steps", "straight", "turn_in_place", "arc", "standstill"}},
                "how the robot moves between stops; the last four are degenerate");
  visitor.field(
      "measured", measured, TextChoices{},
      "observations.json of pictures like those of the run: what it states of each camera's corners, ground and "
      "board planes is drawn, in place of the six fields below; with rig: run only");
  visitor.field("corner_sigma_px", corner_sigma_px, {0.0, 100.0}, "noise of a corner, one sigma");
  visitor.field("ground", ground, "ground planes in every depth camera that sees enough of it");
  visitor.field("board_planes", board_planes, "depth on the board itself");
  visitor.field("inverse_depth_sigma_per_m", inverse_depth_sigma_per_m, {0.0, 1.0}, "noise of 1/z, one sigma");
  visitor.field("ground_points", ground_points, {1.0, kMany}, "effective depth points on the ground in a frame");
  visitor.field("board_points", board_points, {1.0, kMany}, "effective depth points on the board in a frame");
  visitor.field("depth_scale_sigma", depth_scale_sigma, {0.0, 0.5}, "of each camera's true depth scale about 1");
  visitor.field("suspension_height_sigma_mm", suspension_height_sigma_mm, {0.0, 1000.0}, "the robot rocks: height");
  visitor.field("suspension_tilt_sigma_deg", suspension_tilt_sigma_deg, {0.0, 45.0}, "the robot rocks: roll and pitch");
  visitor.field("corner_outlier_fraction", corner_outlier_fraction, {0.0, 1.0}, "corners off by tens of pixels");
  visitor.field("odometry_outlier_fraction", odometry_outlier_fraction, {0.0, 1.0}, "odometry off by decimetres");
  visitor.field("plane_outlier_fraction", plane_outlier_fraction, {0.0, 1.0}, "planes of something else");
  visitor.check(rig != "run" || (drive == "random" && depth_scale_sigma == 0.0 && suspension_height_sigma_mm == 0.0 &&
                                 suspension_tilt_sigma_deg == 0.0 && odometry_outlier_fraction == 0.0),
                "rig",
                "run plans drive, odometry and depth scale itself: drive, depth_scale_sigma, suspension_* and "
                "odometry_outlier_fraction must be left alone");
  visitor.check(measured.empty() || rig == "run", "measured", "needs rig: run");
  const GeometricSweepConfig usual;
  visitor.check(measured.empty() || (corner_sigma_px == usual.corner_sigma_px && ground == usual.ground &&
                                     board_planes == usual.board_planes &&
                                     inverse_depth_sigma_per_m == usual.inverse_depth_sigma_per_m &&
                                     ground_points == usual.ground_points && board_points == usual.board_points),
                "measured",
                "tells the noise of corners and planes itself: corner_sigma_px, ground, board_planes, "
                "inverse_depth_sigma_per_m, ground_points and board_points must be left alone");
}

SweepConfig load_sweep_config(const fs::path& file, const std::vector<std::string>& overrides) {
  YamlTree tree = read_yaml_file(file);
  if (!overrides.empty()) merge_into(&tree, parse_yaml(overrides_as_yaml(overrides), "--set"));
  return ConfigReader(tree, file).read();
}

}  // namespace rigproof
