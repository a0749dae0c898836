// How each type of value is read, written and described.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "rigproof/core/fields.h"
#include "rigproof/core/includes.h"
#include "schema_nodes.h"

namespace rigproof {
namespace {

const char* const kUniform = "uniform";
const char* const kNormal = "normal";
const char* const kChoice = "choice";

YamlTree number_schema(const char* type, const NumberRange& range) {
  YamlTree schema = schema_of_type(type);
  if (range.min == std::numeric_limits<double>::min())
    schema.set("exclusiveMinimum", YamlTree::number(0.0));
  else if (std::isfinite(range.min))
    schema.set("minimum", YamlTree::number(range.min));
  if (std::isfinite(range.max)) schema.set("maximum", YamlTree::number(range.max));
  return schema;
}

YamlTree list_schema(YamlTree items, std::size_t size_min, std::size_t size_max) {
  YamlTree schema = schema_of_list(std::move(items));
  if (size_min > 0) schema.set("minItems", YamlTree::integer(static_cast<std::int64_t>(size_min)));
  if (size_max != std::numeric_limits<std::size_t>::max())
    schema.set("maxItems", YamlTree::integer(static_cast<std::int64_t>(size_max)));
  return schema;
}

FieldValue number_value(double& value, const NumberRange& range, double units_per_si = 1.0) {
  return {[&value, range, units_per_si](const YamlTree& tree, const std::string& path, Problems* problems) {
            if (const auto number = read_number(tree, path, range, problems)) value = *number / units_per_si;
          },
          [&value, units_per_si] {
            return YamlTree::number(units_per_si == 1.0 ? value : value_in_unit(value, units_per_si));
          },
          [range] { return number_schema("number", range); }};
}

// Built in place: g++ with sanitizers takes the move of a variant for a read of what it does not hold.
template <typename Kind>
std::optional<Distribution> distribution_of(Kind kind) {
  std::optional<Distribution> distribution;
  distribution.emplace(Distribution::Kind(std::in_place_type<Kind>, std::move(kind)));
  return distribution;
}

// What may lie anywhere within two turns is a direction, in degrees.
bool is_direction(const NumberRange& range) { return range.min == -360.0 && range.max == 360.0; }

// Directions from low on to the left, within two turns: [170, -170] are 170 to 190, [350, 10] are -10 to 10.
void unwrap(std::vector<double>* ends) {
  double &low = (*ends)[0], &high = (*ends)[1];
  while (high < low) high += 360.0;
  if (high <= 360.0) return;
  low -= 360.0;
  high -= 360.0;
}

std::optional<Distribution> read_uniform(const YamlTree& tree, const std::string& path, const NumberRange& range,
                                         Problems* problems) {
  auto ends = read_numbers(tree, path, 2, 2, {}, problems);
  if (!ends) return std::nullopt;
  const auto lies_within = [&range](double end) { return end >= range.min && end <= range.max; };
  if (is_direction(range) && std::all_of(ends->begin(), ends->end(), lies_within)) unwrap(&*ends);
  if ((*ends)[0] <= (*ends)[1]) return distribution_of(Distribution::Uniform{(*ends)[0], (*ends)[1]});
  problems->add({tree.file, tree.line, path, number_text((*ends)[0]) + ", " + number_text((*ends)[1]),
                 "must be [low, high] with low <= high"});
  return std::nullopt;
}

std::optional<Distribution> read_normal(const YamlTree& tree, const std::string& path, Problems* problems) {
  MapReader map(tree, path, problems);
  map.require("mean", "a number");
  map.require("stddev", "a number, >= 0");
  const auto mean = map.number("mean");
  const auto stddev = map.number("stddev", {0.0});
  map.finish();
  if (!mean || !stddev) return std::nullopt;
  return distribution_of(Distribution::Normal{*mean, *stddev});
}

std::optional<Distribution> read_distribution(const YamlTree& tree, const std::string& path, const NumberRange& range,
                                              Problems* problems) {
  if (tree.is_scalar()) {
    const auto number = read_number(tree, path, {}, problems);
    return number ? std::optional<Distribution>(*number) : std::nullopt;
  }
  if (!is_distribution(tree)) {
    problems->add({tree.file, tree.line, path, tree.shown(),
                   "must be a number, {uniform: [low, high]}, {normal: {mean: m, stddev: s}} or {choice: [..]}"});
    return std::nullopt;
  }
  const auto& [kind, value] = tree.entries.front();
  const std::string inner = path + "." + kind;
  if (kind == kUniform) return read_uniform(value, inner, range, problems);
  if (kind == kNormal) return read_normal(value, inner, problems);
  const auto values = read_numbers(value, inner, 1, 10000, {}, problems);
  return values ? distribution_of(Distribution::Choice{*values}) : std::nullopt;
}

void read_distribution_within(Distribution* value, const NumberRange& range, const YamlTree& tree,
                              const std::string& path, Problems* problems) {
  const auto distribution = read_distribution(tree, path, range, problems);
  if (!distribution) return;
  const double low = distribution->lowest(), high = distribution->highest();
  if (low >= range.min && high <= range.max) {
    *value = *distribution;
    return;
  }
  const std::string drawn = "draws from " + number_text(low) + " to " + number_text(high) + ", ";
  problems->add(
      {tree.file, tree.line, path, tree.shown(), (tree.is_scalar() ? "" : drawn) + "allowed is " + range_text(range)});
}

YamlTree tree_of_distribution(const Distribution& distribution) {
  YamlTree tree = YamlTree::inline_map();
  struct {
    YamlTree& tree;
    void operator()(double constant) const { tree = YamlTree::number(constant); }
    void operator()(const Distribution::Uniform& u) const { tree.set(kUniform, YamlTree::numbers({u.low, u.high})); }
    void operator()(const Distribution::Normal& n) const {
      YamlTree& normal = tree.set(kNormal, YamlTree::inline_map());
      normal.set("mean", YamlTree::number(n.mean));
      normal.set("stddev", YamlTree::number(n.standard_deviation));
    }
    void operator()(const Distribution::Choice& c) const { tree.set(kChoice, YamlTree::numbers(c.values)); }
  } write{tree};
  std::visit(write, distribution.kind());
  return tree;
}

YamlTree only(const char* key, YamlTree value) {
  YamlTree schema = schema_of_type("object");
  schema.set("properties", YamlTree::map()).set(key, std::move(value));
  schema.set("additionalProperties", YamlTree::boolean(false));
  schema.set("required", YamlTree::sequence()).add(YamlTree::text(key));
  return schema;
}

YamlTree distribution_schema(const NumberRange& range) {
  const YamlTree number = number_schema("number", range);
  YamlTree normal = schema_of_type("object");
  YamlTree& properties = normal.set("properties", YamlTree::map());
  properties.set("mean", number);
  properties.set("stddev", number_schema("number", {0.0}));
  normal.set("additionalProperties", YamlTree::boolean(false));
  normal.set("required", YamlTree::texts({"mean", "stddev"}));
  return schema_of_any({number, only(kUniform, list_schema(number, 2, 2)), only(kNormal, normal),
                        only(kChoice, list_schema(number, 1, std::numeric_limits<std::size_t>::max()))});
}

// Whether the file says true or false; text that only looks like it is neither.
void read_boolean(bool* value, const YamlTree& tree, const std::string& path, Problems* problems) {
  if (tree.is_scalar() && !tree.quoted && (tree.scalar == "true" || tree.scalar == "false"))
    *value = tree.scalar == "true";
  else
    problems->add({tree.file, tree.line, path, tree.shown(), "must be true or false"});
}

void read_numbers_by_name(std::map<std::string, double>* values, const YamlTree& tree, const std::string& path,
                          Problems* problems) {
  if (!tree.is_map()) problems->add({tree.file, tree.line, path, tree.shown(), "must be a block of numbers"});
  MapReader map(tree, path, problems);
  for (const auto& [name, entry] : tree.entries)
    if (const auto number = map.number(name)) (*values)[name] = *number;
}

}  // namespace

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

void FieldVisitor::field(const char* key, double& member, const NumberRange& range, const char* description) {
  value(key, number_value(member, range), description);
}

void FieldVisitor::scaled(const char* key, double& si, double units_per_si, const NumberRange& range,
                          const char* description) {
  value(key, number_value(si, range, units_per_si), description);
}

void FieldVisitor::scaled(const char* key, std::optional<double>& si, double units_per_si, const NumberRange& range,
                          const char* description) {
  const FieldValue any = {
      [&si, range, units_per_si](const YamlTree& tree, const std::string& path, Problems* problems) {
        if (const auto number = read_number(tree, path, range, problems)) si = *number / units_per_si;
      },
      [&si, units_per_si]() -> std::optional<YamlTree> {
        if (!si) return std::nullopt;
        return *number_value(*si, {}, units_per_si).write();
      },
      [range] { return number_schema("number", range); }};
  value(key, any, description);
}

void FieldVisitor::field(const char* key, std::optional<double>& member, const NumberRange& range,
                         const char* description) {
  scaled(key, member, 1.0, range, description);
}

void FieldVisitor::required(const char* key, double& member, const NumberRange& range, const char* description) {
  const std::string limits = range_text(range);
  require(key, "a number" + (limits.empty() ? "" : ", " + limits));
  field(key, member, range, description);
}

void FieldVisitor::field(const char* key, std::int64_t& member, const NumberRange& range, const char* description) {
  const FieldValue integer = {[&member, range](const YamlTree& tree, const std::string& path, Problems* problems) {
                                if (const auto number = read_integer(tree, path, range, problems)) member = *number;
                              },
                              [&member] { return YamlTree::integer(member); },
                              [range] { return number_schema("integer", range); }};
  value(key, integer, description);
}

void FieldVisitor::field(const char* key, int& member, const NumberRange& range, const char* description) {
  std::int64_t wide = member;
  field(key, wide, range, description);
  member = static_cast<int>(wide);
}

void FieldVisitor::field(const char* key, std::uint64_t& member, const char* description) {
  const auto read = [&member](const YamlTree& tree, const std::string& path, Problems* problems) {
    const std::string& text = tree.scalar;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), member);
    if (tree.quoted || text.empty() || error != std::errc() || end != text.data() + text.size())
      problems->add({tree.file, tree.line, path, tree.shown(), "must be a whole number, >= 0"});
  };
  const auto write = [&member] {
    YamlTree tree = YamlTree::integer(0);
    tree.scalar = std::to_string(member);
    return tree;
  };
  value(key, {read, write, [] { return number_schema("integer", {0.0}); }}, description);
}

void FieldVisitor::field(const char* key, bool& member, const char* description) {
  const FieldValue boolean = {[&member](const YamlTree& tree, const std::string& path, Problems* problems) {
                                read_boolean(&member, tree, path, problems);
                              },
                              [&member] { return YamlTree::boolean(member); },
                              [] { return schema_of_type("boolean"); }};
  value(key, boolean, description);
}

void FieldVisitor::field(const char* key, std::string& member, const TextChoices& choices, const char* description) {
  const FieldValue text = {[&](const YamlTree& tree, const std::string& path, Problems* problems) {
                             if (const auto found = read_text(tree, path, choices.choices, problems)) member = *found;
                           },
                           [&member] { return YamlTree::text(member); },
                           [&choices] {
                             YamlTree schema = schema_of_type("string");
                             if (!choices.choices.empty()) schema.set("enum", YamlTree::texts(choices.choices));
                             return schema;
                           }};
  value(key, text, description);
}

void FieldVisitor::ignored(const char* key, const char* description) {
  std::string nobody;
  if (takes(key, false)) field(key, nobody, TextChoices{}, description);
}

void FieldVisitor::field(const char* key, Distribution& member, const NumberRange& range, const char* description) {
  const FieldValue distribution = {[&member, range](const YamlTree& tree, const std::string& path, Problems* problems) {
                                     read_distribution_within(&member, range, tree, path, problems);
                                   },
                                   [&member] { return tree_of_distribution(member); },
                                   [range] { return distribution_schema(range); }};
  value(key, distribution, description);
}

void FieldVisitor::field(const char* key, std::vector<double>& member, const NumberRange& range, std::size_t size_min,
                         std::size_t size_max, const char* description) {
  const FieldValue numbers = {[&](const YamlTree& tree, const std::string& path, Problems* problems) {
                                if (const auto read = read_numbers(tree, path, size_min, size_max, range, problems))
                                  member = *read;
                              },
                              [&member] { return YamlTree::numbers(member); },
                              [&] { return list_schema(number_schema("number", range), size_min, size_max); }};
  value(key, numbers, description);
}

void FieldVisitor::field(const char* key, std::vector<std::vector<double>>& rows, const NumberRange& range,
                         std::size_t width, const char* description) {
  const std::size_t longest = width == 0 ? std::numeric_limits<std::size_t>::max() : width;
  const auto write = [&rows] {
    YamlTree list = YamlTree::sequence();
    for (const std::vector<double>& row : rows) list.add(YamlTree::numbers(row));
    return list;
  };
  const auto read = [&](const YamlTree& tree, const std::string& path, Problems* problems) {
    if (!tree.is_sequence()) problems->add({tree.file, tree.line, path, tree.shown(), "must be a list of lists"});
    rows.clear();
    for (std::size_t i = 0; i < tree.items.size(); ++i)
      rows.push_back(read_numbers(tree.items[i], path + "[" + std::to_string(i) + "]", width, longest, range, problems)
                         .value_or(std::vector<double>()));
  };
  const auto schema = [&] { return schema_of_list(list_schema(number_schema("number", range), width, longest)); };
  value(key, {read, write, schema}, description);
}

void FieldVisitor::field(const char* key, std::vector<std::string>& member, const char* description, bool on_one_line) {
  const FieldValue texts = {[&member](const YamlTree& tree, const std::string& path, Problems* problems) {
                              if (const auto read = read_texts(tree, path, problems)) member = *read;
                            },
                            [&member, on_one_line] {
                              YamlTree list = YamlTree::texts(member);
                              list.flow = on_one_line;
                              return list;
                            },
                            [] { return schema_of_list(schema_of_type("string")); }};
  value(key, texts, description);
}

void FieldVisitor::field(const char* key, std::map<std::string, double>& members, const char* description,
                         bool on_one_line) {
  const FieldValue numbers = {[&members](const YamlTree& tree, const std::string& path, Problems* problems) {
                                read_numbers_by_name(&members, tree, path, problems);
                              },
                              [&members, on_one_line]() -> std::optional<YamlTree> {
                                if (members.empty()) return std::nullopt;
                                YamlTree tree = YamlTree::map();
                                tree.flow = on_one_line;
                                for (const auto& [name, number] : members) tree.set(name, YamlTree::number(number));
                                return tree;
                              },
                              [] {
                                YamlTree schema = schema_of_type("object");
                                schema.set("additionalProperties", schema_of_type("number"));
                                return schema;
                              }};
  value(key, numbers, description);
}

void FieldVisitor::format(const char* name, std::int64_t version) {
  std::string kind = name;
  std::int64_t number = version;
  require("format", kind);
  field("format", kind, TextChoices{{name}}, "what kind of file this is");
  require("version", (version > 1 ? "1 to " : "") + std::to_string(version));
  field("version", number, {1.0, static_cast<double>(version)}, "of this format; earlier ones are read");
}

}  // namespace rigproof
