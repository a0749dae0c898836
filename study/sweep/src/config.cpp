#include "rigproof/study/sweep/config.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "rigproof/calib/diagnose/ml_settings.h"
#include "rigproof/calib/vision/ground_source.h"
#include "rigproof/core/error.h"
#include "rigproof/core/includes.h"
#include "rigproof/core/text.h"
#include "rigproof/generator/parameters.h"
#include "rigproof/study/workflow/external.h"
#include "rigproof/study/workflow/overrides.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr const char* kImages = "images";
constexpr const char* kGeometric = "geometric.";
constexpr const char* kMeasured = "geometric.measured";  // a file, which is no level
constexpr double kMaxLevels = 10000.0;
constexpr double kMaxSeed = 9007199254740992.0;
constexpr const char* kNameRule = "must be letters, digits, _, -, + and .";

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

void refuse(FieldVisitor& visitor, const YamlTree& where, const std::string& path, const std::string& value,
            const std::string& message) {
  visitor.problems()->add({where.file, where.line, path, value, message});
}

// A file that is named here, relative to the sweep's file, else to the working folder.
std::string path_beside(const fs::path& file, const fs::path& named) {
  const fs::path beside = fs::absolute(file).parent_path() / named;
  std::error_code ignored;
  return (fs::exists(beside, ignored) ? beside : fs::absolute(named)).lexically_normal().string();
}

// Part of the file that others read: left out where it is nothing.
void raw(FieldVisitor& visitor, const char* key, YamlTree& tree, const std::function<YamlTree()>& schema,
         const char* description) {
  const auto write = [&tree]() -> std::optional<YamlTree> {
    return tree.is_null() || (tree.is_map() && tree.entries.empty()) ? std::nullopt : std::optional<YamlTree>(tree);
  };
  visitor.value(key, {[&tree](const YamlTree& given, const std::string&, Problems*) { tree = given; }, write, schema},
                description);
}

void raw(FieldVisitor& visitor, const char* key, YamlTree& tree, const char* type, const char* description) {
  const auto schema = [type] {
    YamlTree of_type = YamlTree::map();
    of_type.set("type", YamlTree::text(type));
    return of_type;
  };
  raw(visitor, key, tree, schema, description);
}

// ------------------------------------------------------------------------------------------------------------- blocks

YamlTree run_schema() {
  YamlTree schema = parse_yaml(generate_config_schema(), "run");
  const auto of_a_file = [](const auto& entry) {
    return entry.first == "$schema" || entry.first == "title" || entry.first == "version";
  };
  schema.entries.erase(std::remove_if(schema.entries.begin(), schema.entries.end(), of_a_file), schema.entries.end());
  return schema;
}

YamlTree geometric_schema() {
  GeometricSweepConfig config;
  return schema_of_block([&config](FieldVisitor& visitor) { config.visit(visitor); });
}

void visit_blocks(FieldVisitor& visitor, SweepConfig& config, const fs::path& file) {
  raw(visitor, "run", config.run, run_schema, "the configuration that is varied");
  raw(visitor, "geometric", config.geometric_block, geometric_schema,
      "mode geometric: what observations are drawn from");
  if (!visitor.is_reading()) return;
  visitor.check(visitor.given("geometric") == nullptr || config.geometric, "geometric", "belongs to mode: geometric");
  for (auto& [key, value] : config.geometric_block.entries)
    if (key == "measured" && value.is_scalar()) value.scalar = path_beside(file, value.scalar);
  if (!config.run.is_null()) config.run = resolve_includes(config.run);
  const YamlTree* scenes = config.run.find("scenes");
  if (scenes == nullptr || (scenes->is_sequence() && scenes->items.empty())) return;
  refuse(visitor, *scenes, "run.scenes", scenes->shown(),
         "a sweep varies `scene` by an axis: world: {field: scene, values: [..], pool: true}");
}

// --------------------------------------------------------------------------------------------------------------- axes

// The levels of a range, or why there are none.
std::vector<double> values_of(const SweepRange& range, FieldVisitor& visitor) {
  const bool has_step = range.step.has_value();
  const bool one_way = has_step != (range.count > 0);
  const bool log_works = !range.log || (!has_step && range.from > 0.0 && range.to > 0.0);
  const double steps =
      has_step ? std::floor((range.to - range.from) / *range.step + 1e-9) : static_cast<double>(range.count - 1);
  const bool fits = steps >= 0.0 && steps < kMaxLevels;
  visitor.check(one_way, "", "needs a step or a count");
  visitor.check(log_works, "spacing", "log needs a count and ends above 0");
  visitor.check(fits || !one_way, has_step ? "step" : "count", "must lead from `from` to `to` in at most 10000 levels");
  if (!one_way || !log_works || !fits) return {};
  std::vector<double> values;
  for (int i = 0; i <= static_cast<int>(steps); ++i) {
    const double share = steps > 0.0 ? i / steps : 0.0;
    const double linear = has_step ? range.from + i * *range.step : range.from + share * (range.to - range.from);
    const double value = range.log ? range.from * std::pow(range.to / range.from, share) : linear;
    // 0.1 * 3 is 0.3 to a person.
    values.push_back(parse_number(short_text(value, 12)).value_or(value));
  }
  return values;
}

void check_field(FieldVisitor& visitor, const std::string& field, const YamlTree& where, const std::string& path,
                 bool geometric) {
  const std::vector<std::string>& known = known_fields();
  if (std::find(known.begin(), known.end(), field) == known.end())
    refuse(visitor, where, path, field, "is no field that can be varied; " + field_suggestion(field));
  if (field.rfind(kGeometric, 0) == 0 && !geometric) refuse(visitor, where, path, field, "belongs to mode: geometric");
}

using LevelFields = std::vector<std::pair<std::string, YamlTree>>;

// Its value is the label where that is a number, else its place.
SweepLevel level_of(const std::string& label, LevelFields fields, std::size_t place) {
  return {label, parse_number(label).value_or(static_cast<double>(place)), std::move(fields)};
}

std::vector<SweepLevel> levels_of_values(const SweepAxis& axis, FieldVisitor& visitor) {
  std::vector<YamlTree> values = axis.values.items;
  visitor.check(visitor.given("values") == nullptr || !values.empty(), "values", "must be a list of one value or more");
  for (const double value : axis.range ? axis.range->values : std::vector<double>()) {
    values.push_back(YamlTree::number(value));
    values.back().file = visitor.given("range")->file;
    values.back().line = visitor.given("range")->line;
  }
  std::vector<SweepLevel> levels;
  for (const YamlTree& value : values)
    levels.push_back(level_of(label_of(value), {{axis.field, value}}, levels.size()));
  return levels;
}

std::vector<SweepLevel> levels_of_link(const SweepAxis& axis, FieldVisitor& visitor) {
  const auto& fields = axis.link.entries;
  visitor.check(!fields.empty(), "link", "must be a block of fields, each with a list of values");
  const std::size_t count = fields.empty() ? 0 : fields.front().second.items.size();
  for (const auto& [field, values] : fields) {
    if (!values.items.empty() && values.items.size() == count) continue;
    refuse(visitor, values, "axes." + axis.name + ".link." + field, values.shown(),
           "must be a list, as long as those of the other fields");
    return {};
  }
  std::vector<SweepLevel> levels;
  for (std::size_t i = 0; i < count; ++i) {
    LevelFields linked;
    for (const auto& [field, values] : fields) linked.emplace_back(field, values.items[i]);
    levels.push_back(level_of(label_of(linked.front().second), linked, i));
  }
  return levels;
}

std::vector<SweepLevel> levels_of_points(const SweepAxis& axis, FieldVisitor& visitor) {
  visitor.check(!axis.points.entries.empty(), "points",
                "must be a block of points by their labels, each with the fields that it sets");
  std::vector<SweepLevel> levels;
  for (const auto& [label, point] : axis.points.entries) {
    if (!point.is_map() && !point.is_null())
      refuse(visitor, point, "axes." + axis.name + ".points." + label, point.shown(), "must be a block of fields");
    levels.push_back(level_of(label, point.entries, levels.size()));
  }
  return levels;
}

std::vector<SweepLevel> levels_of(const SweepAxis& axis, FieldVisitor& visitor) {
  std::vector<SweepLevel> levels;
  if (visitor.given("points") != nullptr)
    levels = levels_of_points(axis, visitor);
  else if (visitor.given("link") != nullptr)
    levels = levels_of_link(axis, visitor);
  else
    levels = levels_of_values(axis, visitor);
  visitor.check(axis.labels.empty() || axis.labels.size() == levels.size(), "labels",
                "must be as many as the levels, " + std::to_string(levels.size()));
  for (std::size_t i = 0; i < std::min(axis.labels.size(), levels.size()); ++i) levels[i].label = axis.labels[i];
  return levels;
}

void check_axis(FieldVisitor& visitor, const SweepAxis& axis, bool geometric) {
  const std::string path = "axes." + axis.name;
  if (const YamlTree* field = visitor.given("field"); field != nullptr && !axis.field.empty())
    check_field(visitor, axis.field, *field, path + ".field", geometric);
  for (const auto& [field, values] : axis.link.entries) check_field(visitor, field, values, path + ".link", geometric);
  for (const auto& [label, point] : axis.points.entries)
    for (const auto& [field, value] : point.entries)
      check_field(visitor, field, value, path + ".points." + label, geometric);
  std::set<std::string> seen;
  for (const SweepLevel& level : axis.levels)
    visitor.check(seen.insert(level.label).second, "",
                  level.label + ": two levels have this label; `labels` tells them apart");
}

void visit_axis(FieldVisitor& visitor, SweepAxis& axis, bool geometric) {
  const auto given = [&visitor](const char* key) { return visitor.given(key) != nullptr; };
  if (given("values") || given("range")) visitor.require("field", "the dotted path of a field");
  visitor.optional("field", axis.field, "dotted path of a run's field, of geometric.*, or images");
  raw(visitor, "values", axis.values, "array", "any values that the field takes");
  visitor.nested("range", axis.range, "both ends included; a step or a count");
  raw(visitor, "link", axis.link, "object", "fields varied together: lists of one length");
  raw(visitor, "points", axis.points, "object", "named points, each with the fields that it sets");
  if (visitor.takes("labels", !axis.labels.empty())) visitor.field("labels", axis.labels, "of the levels");
  visitor.optional("title", axis.title, "of the axis, for people and figures; default its name");
  if (visitor.takes("pool", axis.pooled))
    visitor.field("pool", axis.pooled, "the summary takes the levels as repetitions");
  if (!visitor.is_reading()) return;
  visitor.check(given("values") + given("range") + given("link") + given("points") == 1, "",
                "needs one of values, range, link, points");
  axis.levels = levels_of(axis, visitor);
  check_axis(visitor, axis, geometric);
}

void visit_axes(FieldVisitor& visitor, SweepConfig& config) {
  static const std::set<std::string> taken = {"task", "seed", "method", "subject", "camera",   "status", "reason",
                                              "code", "axis", "unit",   "tasks",   "answered", "n"};
  const bool geometric = config.geometric;
  FieldMap axes = map_by_name(
      config.axes, [geometric](FieldVisitor& inner, SweepAxis& axis) { visit_axis(inner, axis, geometric); });
  axes.is_name = [](const std::string& name) { return is_word(name, "_") && taken.count(name) == 0; };
  axes.name_rule = "the name of an axis is letters, digits and _, and no other column's";
  if (visitor.takes("axes", !config.axes.empty()))
    visitor.map("axes", axes, "axes by their names; every combination of levels is a point");
}

// -------------------------------------------------------------------------------------------------------------- seeds

const std::vector<std::string>& seed_names() {
  static const std::vector<std::string> names = {"seed", "sensing.seed", "odometry.seed"};
  return names;
}

YamlTree either(std::vector<YamlTree> kinds) {
  YamlTree schema = YamlTree::map();
  schema.set("anyOf", YamlTree::sequence()).items = std::move(kinds);
  return schema;
}

YamlTree list_of(YamlTree items) {
  YamlTree schema = YamlTree::map();
  schema.set("type", YamlTree::text("array"));
  schema.set("items", std::move(items));
  return schema;
}

YamlTree seed_schema() { return parse_yaml("{type: integer, minimum: 0}", "seeds"); }

std::vector<std::int64_t> read_seed_list(const YamlTree& tree, const std::string& path, Problems* problems) {
  std::vector<std::int64_t> seeds;
  if (!tree.is_sequence() || tree.items.empty() || tree.items.size() > static_cast<std::size_t>(kMaxLevels))
    problems->add({tree.file, tree.line, path, tree.shown(), "must be a list of whole numbers"});
  for (const YamlTree& item : tree.items) {
    const auto seed = read_integer(item, path, {0.0, kMaxSeed}, problems);
    if (!seed) continue;
    if (std::find(seeds.begin(), seeds.end(), *seed) != seeds.end())
      problems->add({item.file, item.line, path, item.shown(), "is in the list twice"});
    seeds.push_back(*seed);
  }
  return seeds;
}

std::vector<std::int64_t> counted_seeds(std::int64_t first, std::int64_t count) {
  std::vector<std::int64_t> seeds;
  for (std::int64_t i = 0; i < count; ++i) seeds.push_back(first + i);
  return seeds;
}

void visit_seed_fields(FieldVisitor& visitor, std::vector<std::string>& fields) {
  const auto read = [&fields](const YamlTree& tree, const std::string& path, Problems* problems) {
    fields = tree.is_sequence() ? read_texts(tree, path, problems).value_or(std::vector<std::string>())
                                : std::vector<std::string>{tree.scalar};
    for (const std::string& name : fields)
      if (std::find(seed_names().begin(), seed_names().end(), name) == seed_names().end())
        problems->add({tree.file, tree.line, path, name, "is no seed; " + suggestion(name, seed_names())});
  };
  const auto schema = [] {
    YamlTree name = YamlTree::map();
    name.set("enum", YamlTree::texts(seed_names()));
    return either({name, list_of(name)});
  };
  const auto write = [&fields] {
    return fields.empty() ? std::nullopt : std::optional<YamlTree>(YamlTree::texts(fields));
  };
  visitor.value("field", {read, write, schema}, "what the seeds are given to; default seed");
}

void visit_seed_block(FieldVisitor& visitor, SweepConfig& config) {
  std::int64_t first = 0, count = 1;
  visit_seed_fields(visitor, config.seed_fields);
  if (visitor.takes("first", false))
    visitor.field("first", first, {0.0, kMaxSeed}, "of `count` that follow each other");
  if (visitor.takes("count", false)) visitor.field("count", count, {1.0, kMaxLevels}, "of seeds");
  const auto read = [&config](const YamlTree& tree, const std::string& path, Problems* problems) {
    config.seeds = read_seed_list(tree, path, problems);
  };
  const auto write = [&config]() -> std::optional<YamlTree> {
    if (config.seed_fields.empty()) return std::nullopt;
    YamlTree list = YamlTree::sequence();
    list.flow = true;
    for (const std::int64_t seed : config.seeds) list.add(YamlTree::integer(seed));
    return list;
  };
  visitor.value("values", {read, write, [] { return list_of(seed_schema()); }}, "the seeds, one by one");
  if (!visitor.is_reading()) return;
  const bool counts = visitor.given("count") != nullptr, lists = visitor.given("values") != nullptr;
  visitor.check(counts || lists, "", "needs a count, or values");
  visitor.check(!lists || (!counts && visitor.given("first") == nullptr), "values",
                "stands instead of first and count");
  if (!lists) config.seeds = counted_seeds(first, count);
}

void visit_seeds(FieldVisitor& visitor, SweepConfig& config) {
  const auto visit = [&config](FieldVisitor& block) { visit_seed_block(block, config); };
  const auto read = [&config, &visit](const YamlTree& tree, const std::string& path, Problems* problems) {
    config.seed_fields = {seed_names().front()};
    if (tree.is_sequence())
      config.seeds = read_seed_list(tree, path, problems);
    else if (tree.is_scalar())
      config.seeds = counted_seeds(0, read_integer(tree, path, {1.0, kMaxLevels}, problems).value_or(1));
    else
      read_fields_of_block(tree, path, problems, visit);
  };
  const auto write = [&config, &visit] {
    return config.seed_fields.empty() ? std::nullopt : std::optional<YamlTree>(tree_of_fields(visit));
  };
  const auto schema = [&visit] {
    return either({parse_yaml("{type: integer, minimum: 1}", "seeds"), list_of(seed_schema()), schema_of_block(visit)});
  };
  visitor.value("seeds", {read, write, schema},
                "repetitions of every point, on the same seeds: a number, a list, or a block");
}

// ------------------------------------------------------------------------------------------------------------ methods

// One from outside, or settings in a file, by an absolute path.
std::string method_path(const fs::path& file, const std::string& method) {
  const bool ml = method.rfind(kMlPrefix, 0) == 0;
  const std::string prefix = ml ? kMlPrefix : kExternal;
  if (method.rfind(prefix, 0) != 0 || (ml && !names_ml_file(method.substr(prefix.size())))) return method;
  return prefix + path_beside(file, method.substr(prefix.size()));
}

void visit_network(FieldVisitor& visitor, const char* key, bool or_sift, std::string& value, const fs::path& file,
                   const char* description) {
  const std::string onnx = "onnx:";
  visitor.field(key, value, TextChoices{}, description);
  if (visitor.given(key) == nullptr) return;
  const bool is_network = value.rfind(onnx, 0) == 0 && value.size() > onnx.size();
  visitor.check(is_network || (or_sift && value == "sift"), key,
                or_sift ? "must be sift or onnx:FILE" : "must be onnx:FILE");
  if (is_network) value = onnx + path_beside(file, value.substr(onnx.size()));
}

// What differs from what holds anyway.
void visit_vision(FieldVisitor& visitor, SweepVision& vision, const SweepVision& usual, const fs::path& file) {
  if (visitor.takes("ground", vision.ground != usual.ground))
    visitor.field("ground", vision.ground, TextChoices{ground_source_names()}, "where the ground planes come from");
  if (visitor.takes("features", vision.features != usual.features))
    visit_network(visitor, "features", true, vision.features, file,
                  "where methods that follow features get them: sift, or onnx:FILE");
  if (visitor.takes("horizon", vision.horizon != usual.horizon))
    visit_network(visitor, "horizon", false, vision.horizon, file,
                  "network that sees horizon and way ahead: onnx:FILE");
}

// A text, or a block of a method with what is special about it.
void visit_method(FieldVisitor& visitor, SweepMethodChoice& choice, const SweepVision& usual, const fs::path& file) {
  static const char* const kNames = "as `rigproof methods` lists them, or external:FILE.yaml";
  const auto read = [&](const std::string& text) { choice.method = method_path(file, text); };
  const auto write = [&] {
    const bool says_all = choice.name.empty() && choice.vision.text() == usual.text();
    return says_all ? std::optional<std::string>(choice.method) : std::nullopt;
  };
  if (visitor.instead({{}, "ml:KEY=VALUE,.. or ml:FILE.yaml (schema ml), too", read, write})) return;
  visitor.on_one_line();
  visitor.require("method", kNames);
  visitor.field("method", choice.method, TextChoices{}, kNames);
  if (visitor.is_reading()) choice.method = method_path(file, choice.method);
  visitor.optional("name", choice.name, "in the tables; default the method's own");
  visitor.check(choice.name.empty() || is_word(choice.name), "name", kNameRule);
  visit_vision(visitor, choice.vision, usual, file);
}

void visit_methods(FieldVisitor& visitor, SweepConfig& config, const fs::path& file) {
  visit_vision(visitor, config.vision, SweepVision(), file);
  const auto resize = [&config](std::size_t size) { config.methods.assign(size, {"ml", "", config.vision}); };
  if (visitor.is_reading()) resize(1);
  visitor.list(
      "methods", [&config] { return config.methods.size(); }, resize,
      [&](std::size_t i, FieldVisitor& inner) { visit_method(inner, config.methods[i], config.vision, file); },
      "as `rigproof methods` lists them, or external:FILE.yaml; or a block with what is special");
  visitor.check(!config.methods.empty(), "methods", "must name a method");
}

void visit_reference(FieldVisitor& visitor, SweepConfig& config, const fs::path& file) {
  std::set<std::string> labels;
  for (const SweepMethodChoice& choice : config.methods)
    visitor.check(labels.insert(choice.label()).second, "methods",
                  choice.label() + " is in the list twice; `name` tells one method's variants apart");
  const bool has_ml = labels.count("ml") > 0 || config.methods.empty();
  if (visitor.is_reading()) config.reference = has_ml ? "ml" : config.methods.front().label();
  visitor.field("reference", config.reference, TextChoices{}, "method that the others are tested against");
  if (labels.count(config.reference) == 0) config.reference = method_path(file, config.reference);
  visitor.check(labels.count(config.reference) > 0 || visitor.given("reference") == nullptr, "reference",
                "must be one of the methods");
}

// -------------------------------------------------------------------------------------------------------------- whole

void refuse_fields_set_twice(FieldVisitor& visitor, const SweepConfig& config) {
  std::map<std::string, std::string> set_by;
  if (config.seeds.size() > 1)
    for (const std::string& field : config.seed_fields) set_by[field] = "the seeds";
  for (const SweepAxis& axis : config.axes) {
    std::set<std::string> fields;
    for (const SweepLevel& level : axis.levels)
      for (const auto& [field, value] : level.fields) fields.insert(field);
    for (const std::string& field : fields) {
      const auto [other, is_new] = set_by.emplace(field, "axis " + axis.name);
      visitor.check(is_new, "axes", field + " is set by axis " + axis.name + " and by " + other->second);
    }
  }
}

// `file` is what the names of other files are relative to.
void visit_sweep(FieldVisitor& visitor, SweepConfig& config, const fs::path& file) {
  visitor.field("name", config.name, TextChoices{}, "of the sweep; default the file's name");
  visitor.check(is_word(config.name), "name", kNameRule);
  visitor.choice("mode", config.geometric, {{"rendered", false}, {"geometric", true}},
                 "rendered: with images; geometric: observations drawn from geometry and noise, without images");
  visit_blocks(visitor, config, file);
  visit_axes(visitor, config);
  visit_seeds(visitor, config);
  visit_methods(visitor, config, file);
  visit_reference(visitor, config, file);
  refuse_fields_set_twice(visitor, config);
}

}  // namespace

std::string SweepVision::text() const {
  return "ground " + ground + ", features " + features + (horizon.empty() ? "" : ", horizon " + horizon);
}

void SweepRange::visit(FieldVisitor& visitor) {
  const std::size_t before = visitor.is_reading() ? visitor.problems()->all().size() : 0;
  visitor.required("from", from, {}, "first level");
  visitor.required("to", to, {}, "last level");
  visitor.field("step", step, {}, "from level to level");
  if (visitor.takes("count", count > 0))
    visitor.field("count", count, {0.0, kMaxLevels}, "of levels, instead of a step; 0 = none");
  visitor.choice("spacing", log, {{"linear", false}, {"log", true}}, "log: levels have one ratio");
  if (!visitor.is_reading() || visitor.problems()->all().size() > before) return;
  values = values_of(*this, visitor);
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
  SweepConfig config;
  config.name = file.stem().string();
  read_fields_of_tree(tree, [&](FieldVisitor& visitor) { visit_sweep(visitor, config, file); });
  check_sweep(config);
  return config;
}

YamlTree resolved_sweep(SweepConfig config) {
  return tree_of_fields([&config](FieldVisitor& visitor) { visit_sweep(visitor, config, {}); });
}

std::string sweep_config_schema() {
  SweepConfig config;
  return schema_of_fields("Rigproof sweep", [&config](FieldVisitor& visitor) { visit_sweep(visitor, config, {}); },
                          {1, false});
}

}  // namespace rigproof
