// One description of a file: each struct lists its fields once, in `void visit(FieldVisitor&)` or in a free
// `visit_fields(FieldVisitor&, Struct&)`. From that list come the reader with all its errors, the writer, the JSON
// Schema and the reference page. The default of a field is its in-class initialiser.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rigproof/core/distribution.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/core/yaml.h"

namespace rigproof {

class FieldVisitor;
using VisitFields = std::function<void(FieldVisitor&)>;

/// Allowed values of a text: one of `choices`, or anything if there is none.
struct TextChoices {
  std::vector<std::string> choices;
};

/// One value, whatever its type.
struct FieldValue {
  /// Takes what the file says, or adds a problem and leaves the value as it was.
  std::function<void(const YamlTree& tree, const std::string& path, Problems* problems)> read;
  /// As a file has it; nothing = the key is left out.
  std::function<std::optional<YamlTree>()> write;
  /// Its JSON Schema, but for description and default.
  std::function<YamlTree()> schema;
};

/// A block whose keys are names: cameras, axes, files.
struct FieldMap {
  std::function<std::vector<std::string>()> names;  ///< of the entries that are there, in the order of the file
  /// Lists the fields of one entry; when reading a new name makes a new entry.
  std::function<void(const std::string& name, FieldVisitor&)> visit;
  VisitFields visit_default;  ///< the fields of an entry with its defaults, for the schema
  std::size_t size_min = 0, size_max = 1U << 30U;
  std::string size_rule;                            ///< what a wrong number of entries is told: "must be a map of .."
  std::function<bool(const std::string&)> is_name;  ///< empty: every name is allowed
  std::string name_rule, name_pattern;              ///< the same for people and as a regular expression
};

/// A text that may stand where a block is expected: `depth: none`, `board: PRESET`.
struct TextInstead {
  std::vector<std::string> choices;  ///< none: any text
  std::string description;
  std::function<void(const std::string& text)> read;        ///< throws Error where the text is not allowed
  std::function<std::optional<std::string>()> write = [] {  ///< the text, where one says everything
    return std::optional<std::string>();
  };
};

/// Visits the fields of a file. Keys carry their unit (height_m, yaw_deg); the member that is visited holds the value
/// in the key's unit as well, but for what `scaled` visits.
class FieldVisitor {
 public:
  virtual ~FieldVisitor() = default;

  virtual void value(const char* key, const FieldValue& value, const char* description) = 0;
  /// A nested block whose fields `visit` lists. One that is absent is visited all the same: its checks hold for
  /// defaults, too.
  virtual void section(const char* key, const VisitFields& visit, const char* description) = 0;
  /// A list of blocks. `resize` sets the length when reading; `visit` lists the fields of element i.
  /// When `size` is 0 a schema writer visits element 0 of a list resized to 1 and empties it again.
  virtual void list(const char* key, const std::function<std::size_t()>& size,
                    const std::function<void(std::size_t)>& resize,
                    const std::function<void(std::size_t, FieldVisitor&)>& visit, const char* description) = 0;
  virtual void map(const char* key, const FieldMap& map, const char* description) = 0;
  /// Asked first in a block that a text may stand for. True: it does, there is nothing more to visit.
  virtual bool instead(const TextInstead& text) = 0;
  /// Asked before a field that may be left out. A reader says whether the file has it, a writer whether there is a
  /// value, a schema visits everything.
  virtual bool takes(const char* key, bool has_value) = 0;

  // What only a reader keeps:
  /// Reports a problem that concerns several fields together, or the block for an empty key. Not where the value of the
  /// key itself was refused.
  virtual void check(bool /*holds*/, const char* /*key*/, const std::string& /*message*/) {}
  /// The key must be given; `allowed` says what it holds.
  virtual void require(const char* /*key*/, const std::string& /*allowed*/) {}
  /// Unknown keys that begin so are somebody else's.
  virtual void tolerate(const char* /*prefix*/) {}
  /// What the file says of a key; null where it says nothing, and for what is no reader.
  virtual const YamlTree* given(const char* /*key*/) { return nullptr; }
  /// Where a reader puts problems; null for what is no reader.
  virtual Problems* problems() { return nullptr; }
  bool is_reading() { return problems() != nullptr; }
  /// Whether every field is asked for that there can be, as a schema does.
  virtual bool describes() { return false; }
  /// A writer puts the block on one line.
  virtual void on_one_line() {}

  void field(const char* key, double& value, const NumberRange& range, const char* description);
  void field(const char* key, std::int64_t& value, const NumberRange& range, const char* description);
  void field(const char* key, int& value, const NumberRange& range, const char* description);
  /// A whole number of all 64 bits: a seed, a count.
  void field(const char* key, std::uint64_t& value, const char* description);
  void field(const char* key, bool& value, const char* description);
  void field(const char* key, std::string& value, const TextChoices& choices, const char* description);
  /// A number or a distribution of it: {uniform: [a, b]}, {normal: {mean: m, stddev: s}}, {choice: [..]}.
  void field(const char* key, Distribution& value, const NumberRange& range, const char* description);
  /// A list of numbers; size_min <= length <= size_max.
  void field(const char* key, std::vector<double>& value, const NumberRange& range, std::size_t size_min,
             std::size_t size_max, const char* description);
  /// A list of lists of numbers; `width` of them in each, for 0 any number.
  void field(const char* key, std::vector<std::vector<double>>& rows, const NumberRange& range, std::size_t width,
             const char* description);
  /// A list of texts, written on one line or a line each.
  void field(const char* key, std::vector<std::string>& value, const char* description, bool on_one_line = true);
  /// A block of numbers by name; an empty one is left out.
  void field(const char* key, std::map<std::string, double>& values, const char* description, bool on_one_line = false);
  /// Left out where there is none.
  void field(const char* key, std::optional<double>& value, const NumberRange& range, const char* description);
  /// A number that must be given.
  void required(const char* key, double& value, const NumberRange& range, const char* description);
  /// A number in the key's unit whose member is in SI units: member = number / units_per_si.
  void scaled(const char* key, double& si, double units_per_si, const NumberRange& range, const char* description);
  void scaled(const char* key, std::optional<double>& si, double units_per_si, const NumberRange& range,
              const char* description);
  /// A text that is left out where it is empty.
  void optional(const char* key, std::string& value, const char* description) {
    if (takes(key, !value.empty())) field(key, value, TextChoices{}, description);
  }
  /// A text that people read and nobody keeps.
  void ignored(const char* key, const char* description);
  /// Keys `format` and `version` of a file that the program writes.
  void format(const char* name, std::int64_t version);

  /// One of several values by their names.
  template <typename Value>
  void choice(const char* key, Value& value, const std::vector<std::pair<const char*, Value>>& names,
              const char* description) {
    TextChoices choices;
    std::string text;
    for (const auto& [name, candidate] : names) {
      choices.choices.emplace_back(name);
      if (candidate == value && text.empty()) text = name;
    }
    field(key, text, choices, description);
    for (const auto& [name, candidate] : names)
      if (is_reading() && text == name) value = candidate;
  }
  /// A nested struct.
  template <typename Struct>
  void nested(const char* key, Struct& value, const char* description) {
    section(
        key, [&value](FieldVisitor& visitor) { visit_fields(visitor, value); }, description);
  }
  /// One that may be left out.
  template <typename Struct>
  void nested(const char* key, std::optional<Struct>& value, const char* description) {
    if (!takes(key, value.has_value())) return;
    Struct here = value.value_or(Struct());
    nested(key, here, description);
    if (is_reading()) value = std::move(here);
  }
  /// A list of structs, each with the fields that `visit(visitor, struct)` lists.
  template <typename Struct, typename Visit>
  void nested_list(const char* key, std::vector<Struct>& values, const char* description, const Visit& visit) {
    list(
        key, [&values] { return values.size(); }, [&values](std::size_t size) { values.resize(size); },
        [&values, &visit](std::size_t i, FieldVisitor& visitor) { visit(visitor, values[i]); }, description);
  }
  template <typename Struct>
  void nested_list(const char* key, std::vector<Struct>& values, const char* description) {
    nested_list(key, values, description, [](FieldVisitor& visitor, Struct& value) { visit_fields(visitor, value); });
  }
};

/// Blocks by name of structs that have a `name`, each with the fields that `visit(visitor, struct)` lists.
template <typename Struct, typename Visit>
FieldMap map_by_name(std::vector<Struct>& values, const Visit& visit) {
  FieldMap map;
  map.names = [&values] {
    std::vector<std::string> names;
    for (const Struct& value : values) names.push_back(value.name);
    return names;
  };
  map.visit = [&values, visit](const std::string& name, FieldVisitor& visitor) {
    const auto is_it = [&name](const Struct& value) { return value.name == name; };
    auto found = std::find_if(values.begin(), values.end(), is_it);
    if (found == values.end()) {
      found = values.insert(values.end(), Struct());
      found->name = name;
    }
    visit(visitor, *found);
  };
  map.visit_default = [visit](FieldVisitor& visitor) {
    Struct value;
    visit(visitor, value);
  };
  return map;
}

/// The same of a map.
template <typename Struct>
FieldMap map_by_name(std::map<std::string, Struct>& values) {
  FieldMap map;
  map.names = [&values] {
    std::vector<std::string> names;
    for (const auto& [name, value] : values) names.push_back(name);
    return names;
  };
  map.visit = [&values](const std::string& name, FieldVisitor& visitor) { visit_fields(visitor, values[name]); };
  map.visit_default = [](FieldVisitor& visitor) {
    Struct value;
    visit_fields(visitor, value);
  };
  return map;
}

template <typename Struct>
auto visit_fields(FieldVisitor& visitor, Struct& value) -> decltype(value.visit(visitor)) {
  value.visit(visitor);
}

/// A value in a key's unit such that value / units_per_si reads back to the same double, with as few digits as can be.
double value_in_unit(double value, double units_per_si);

/// Reads a YAML file into the fields. Unknown keys, wrong types and values out of range become Problems with
/// file:line, the field's dotted path, the value and what is allowed; an unknown key names the nearest known one.
/// `include: FILE` (or a list of them) is read first, relative to the including file. An empty file is fine.
/// Throws Error with all problems.
void read_fields(const std::filesystem::path& file, const VisitFields& visit);
/// The same from text; `file` is used in messages and to resolve includes.
void read_fields_from_text(const std::string& text, const std::filesystem::path& file, const VisitFields& visit);
/// The same from what was read already, without includes.
void read_fields_of_tree(const YamlTree& tree, const VisitFields& visit);
/// The same for a block of a larger file: `path` is its place in that file, problems are left to the caller.
void read_fields_of_block(const YamlTree& block, const std::string& path, Problems* problems, const VisitFields& visit);

/// Every field with its value, as a file has it; read back it gives the same values.
YamlTree tree_of_fields(const VisitFields& visit);
/// The same as YAML.
std::string write_fields(const VisitFields& visit);
/// The same of a struct.
template <typename Struct>
YamlTree tree_of(Struct value) {
  return tree_of_fields([&value](FieldVisitor& visitor) { visit_fields(visitor, value); });
}

/// What differs between two trees of fields, by dotted path: what each of them says on one line, or nothing.
struct FieldDifference {
  std::string path;
  std::string there, here;
};
std::vector<FieldDifference> field_differences(const YamlTree& there, const YamlTree& here);

/// JSON Schema (draft 7) of a block of fields, with descriptions, defaults and ranges.
YamlTree schema_of_block(const VisitFields& visit);
/// A key of what the program writes by hand: its dotted path ("stops[].x_m", "cameras.NAME.folder", "[].x" of a list; a
/// "?" at the end of a part = may be absent), its type and its meaning.
/// Types: number, integer, text, boolean, numbers, texts, anything, "a | b" for one of several texts, each also with
/// " or null".
struct KeyLine {
  std::string path;
  std::string type;
  std::string description;
};

struct SchemaOptions {
  std::int64_t version = 1;  ///< of the file's format
  bool includes = true;      ///< whether `include:` is read
};
/// The same of a file with its title, as JSON.
std::string schema_of_fields(const std::string& title, const VisitFields& visit, const SchemaOptions& options = {});
template <typename Struct>
std::string schema_of(const std::string& title, const SchemaOptions& options = {}) {
  Struct value;
  return schema_of_fields(
      title, [&value](FieldVisitor& visitor) { visit_fields(visitor, value); }, options);
}

/// JSON Schema of what is written by hand.
std::string schema_of_keys(const std::string& title, const std::vector<KeyLine>& keys, std::int64_t version = 1);

/// One field of a schema.
struct FieldSummary {
  std::string path;          ///< dotted; NAME stands for a name of the user's, [] for an element of a list
  std::string type;          ///< "number", "one of a, b", ..
  std::string unit;          ///< as the key ends: "m", "deg"; empty for none
  std::string range;         ///< "0 to 1"; empty for no limit
  std::string default_text;  ///< on one line; empty for none
  std::string description;
  bool is_block = false;  ///< its fields follow
};
/// @param lists whether to go into the elements of lists and of blocks by name, or to give one line of each
std::vector<FieldSummary> fields_of_schema(const YamlTree& schema, bool lists = true);
/// A table in Markdown, a line for each field.
std::string field_table(const YamlTree& schema);

}  // namespace rigproof
