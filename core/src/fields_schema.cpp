// JSON Schema (draft 7) from the same description that reads and writes a file, and what a page says of it.
#include <limits>
#include <set>

#include "rigproof/core/fields.h"
#include "schema_nodes.h"

namespace rigproof {
namespace {

YamlTree object_schema(YamlTree properties) {
  YamlTree schema = schema_of_type("object");
  schema.set("additionalProperties", YamlTree::boolean(false));
  schema.set("properties", std::move(properties));
  return schema;
}

YamlTree text_schema(const TextInstead& text) {
  YamlTree schema = schema_of_type("string");
  if (!text.choices.empty()) schema.set("enum", YamlTree::texts(text.choices));
  schema.set("description", YamlTree::text(text.description));
  return schema;
}

class SchemaWriter : public FieldVisitor {
 public:
  void value(const char* key, const FieldValue& value, const char* description) override {
    YamlTree schema = value.schema();
    schema.set("description", YamlTree::text(description));
    const std::optional<YamlTree> usual = value.write();
    if (usual && required_.count(key) == 0) schema.set("default", *usual);
    properties_.set(key, std::move(schema));
  }
  void section(const char* key, const VisitFields& visit, const char* description) override {
    add_block(key, schema_of_block(visit), description);
  }
  void list(const char* key, const std::function<std::size_t()>& size, const std::function<void(std::size_t)>& resize,
            const std::function<void(std::size_t, FieldVisitor&)>& visit, const char* description) override {
    const bool empty = size() == 0;
    if (empty) resize(1);
    YamlTree element = schema_of_block([&visit](FieldVisitor& inner) { visit(0, inner); });
    if (empty) resize(0);
    add_block(key, schema_of_list(std::move(element)), description);
  }
  void map(const char* key, const FieldMap& map, const char* description) override {
    YamlTree schema = schema_of_type("object");
    if (map.size_min > 0) schema.set("minProperties", YamlTree::integer(static_cast<std::int64_t>(map.size_min)));
    if (map.size_max < FieldMap().size_max)
      schema.set("maxProperties", YamlTree::integer(static_cast<std::int64_t>(map.size_max)));
    if (!map.name_pattern.empty())
      schema.set("propertyNames", YamlTree::map()).set("pattern", YamlTree::text(map.name_pattern));
    schema.set("additionalProperties", schema_of_block(map.visit_default));
    add_block(key, std::move(schema), description);
  }
  bool instead(const TextInstead& text) override {
    instead_ = text_schema(text);
    return false;
  }
  bool takes(const char*, bool) override { return true; }
  bool describes() override { return true; }
  void require(const char* key, const std::string&) override { required_.insert(key); }
  void tolerate(const char* prefix) override { tolerated_ = prefix; }

  YamlTree schema() const {
    YamlTree schema = object_schema(properties_);
    if (!tolerated_.empty()) schema.set("patternProperties", YamlTree::map()).set("^" + tolerated_, YamlTree::map());
    if (!required_.empty()) schema.set("required", YamlTree::texts({required_.begin(), required_.end()}));
    return instead_ ? schema_of_any({*instead_, std::move(schema)}) : schema;
  }

 private:
  void add_block(const char* key, YamlTree schema, const char* description) {
    schema.set("description", YamlTree::text(description));
    properties_.set(key, std::move(schema));
  }

  YamlTree properties_ = YamlTree::map();
  std::set<std::string> required_;
  std::string tolerated_;
  std::optional<YamlTree> instead_;
};

YamlTree described(const char* type, const char* description) {
  YamlTree schema = schema_of_type(type);
  schema.set("description", YamlTree::text(description));
  return schema;
}

YamlTree include_schema() {
  YamlTree schema = YamlTree::map();
  schema.set("description", YamlTree::text("File, or list of files, read first: relative to this one, or a preset."));
  const YamlTree name = schema_of_type("string");
  schema.entries.push_back(schema_of_any({name, schema_of_list(name)}).entries.front());
  return schema;
}

// --------------------------------------------------------------------------------------------------- schema from keys

YamlTree schema_of_key(const std::string& type) {
  const std::string null = " or null";
  YamlTree schema = YamlTree::map();
  if (type == "anything") return schema;
  if (type.size() > null.size() && type.compare(type.size() - null.size(), null.size(), null) == 0) {
    return schema_of_any({schema_of_key(type.substr(0, type.size() - null.size())), schema_of_type("null")});
  }
  if (type.find(" | ") != std::string::npos) {
    schema = schema_of_type("string");
    YamlTree& names = schema.set("enum", YamlTree::sequence());
    for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 3) {
      end = type.find(" | ", begin);
      names.add(YamlTree::text(type.substr(begin, end - begin)));
    }
    return schema;
  }
  if (type == "numbers") return schema_of_list(schema_of_type("number"));
  if (type == "texts") return schema_of_list(schema_of_type("string"));
  return schema_of_type(type == "text" ? "string" : type.c_str());
}

// "a.b" is {a, b}; nothing remains of the last part.
std::pair<std::string, std::string> split_path(const std::string& path) {
  const std::size_t dot = path.find('.');
  return {path.substr(0, dot), dot == std::string::npos ? "" : path.substr(dot + 1)};
}

YamlTree schema_of_lines(const std::vector<KeyLine>& lines);

/// One key with what is said of it and below it, each line with what remains of its path.
struct KeyPart {
  std::string key;
  bool is_list = false, is_optional = false;
  std::vector<KeyLine> lines;
};

std::vector<KeyPart> parts_of(const std::vector<KeyLine>& lines) {
  std::vector<KeyPart> parts;
  for (const KeyLine& line : lines) {
    const auto [part, rest] = split_path(line.path);
    const std::string key = part.substr(0, part.find_first_of("[?"));
    const auto same = [&key](const KeyPart& other) { return other.key == key; };
    auto place = std::find_if(parts.begin(), parts.end(), same);
    if (place == parts.end()) place = parts.insert(parts.end(), KeyPart{key, false, false, {}});
    place->is_list = place->is_list || part.find("[]") != std::string::npos;
    place->is_optional = place->is_optional || part.find('?') != std::string::npos;
    place->lines.push_back({rest, line.type, line.description});
  }
  return parts;
}

YamlTree schema_of_part(const KeyPart& part) {
  const bool is_leaf = part.lines.size() == 1 && part.lines.front().path.empty();
  std::vector<KeyLine> inner;
  std::string description;
  for (const KeyLine& line : part.lines) {
    if (line.path.empty())
      description = line.description;
    else
      inner.push_back(line);
  }
  YamlTree schema = is_leaf ? schema_of_key(part.lines.front().type) : schema_of_lines(inner);
  if (part.is_list) schema = schema_of_list(std::move(schema));
  if (!description.empty()) schema.set("description", YamlTree::text(description));
  return schema;
}

YamlTree schema_of_lines(const std::vector<KeyLine>& lines) {
  YamlTree properties = YamlTree::map(), required = YamlTree::sequence();
  YamlTree others = YamlTree::boolean(false);
  for (const KeyPart& part : parts_of(lines)) {
    if (part.key == "NAME") {
      others = schema_of_part(part);
      continue;
    }
    properties.set(part.key, schema_of_part(part));
    if (!part.is_optional) required.add(YamlTree::text(part.key));
  }
  YamlTree schema = schema_of_type("object");
  schema.set("additionalProperties", std::move(others));
  schema.set("properties", std::move(properties));
  if (!required.items.empty()) schema.set("required", std::move(required));
  return schema;
}

YamlTree file_schema(const std::string& title, std::int64_t version, const YamlTree& block) {
  YamlTree schema = YamlTree::map();
  schema.set("$schema", YamlTree::text("http://json-schema.org/draft-07/schema#"));
  schema.set("title", YamlTree::text(title));
  schema.set("version", YamlTree::integer(version));
  for (const auto& [key, value] : block.entries) schema.set(key, value);
  return schema;
}

YamlTree* entry_of(YamlTree* tree, const std::string& key) {
  for (auto& [name, value] : tree->entries)
    if (name == key) return &value;
  return nullptr;
}

// ------------------------------------------------------------------------------------------------- a schema in words

std::string text_at(const YamlTree& schema, const std::string& key) {
  const YamlTree* found = schema.find(key);
  return found == nullptr ? "" : found->is_scalar() ? found->scalar : emit_yaml_line(*found);
}

// As keys end; the longer ending first.
std::string unit_of(const std::string& key) {
  static const std::vector<std::pair<std::string, const char*>> kUnits = {
      {"_deg_s", "deg/s"}, {"_rad_s", "rad/s"}, {"_m_s2", "m/s^2"}, {"_m_s", "m/s"}, {"_per_m2", "1/m^2"},
      {"_per_m", "1/m"},   {"_px2", "px^2"},    {"_px", "px"},      {"_deg", "deg"}, {"_rad", "rad"},
      {"_percent", "%"},   {"_bytes", "bytes"}, {"_hz", "Hz"},      {"_kg", "kg"},   {"_mm", "mm"},
      {"_cm", "cm"},       {"_ms", "ms"},       {"_m", "m"},        {"_s", "s"}};
  for (const auto& [ending, unit] : kUnits)
    if (key.size() > ending.size() && key.compare(key.size() - ending.size(), ending.size(), ending) == 0) return unit;
  return "";
}

NumberRange range_of(const YamlTree& schema) {
  NumberRange range;
  if (const YamlTree* min = schema.find("minimum")) range.min = parse_number(min->scalar).value_or(range.min);
  if (const YamlTree* max = schema.find("maximum")) range.max = parse_number(max->scalar).value_or(range.max);
  if (schema.find("exclusiveMinimum") != nullptr) range.min = std::numeric_limits<double>::min();
  return range;
}

std::string size_text(const YamlTree& schema) {
  const std::string min = text_at(schema, "minItems"), max = text_at(schema, "maxItems");
  if (min == max) return min.empty() ? "" : min + " ";
  if (max.empty()) return min + " or more ";
  return (min.empty() ? "up to " : min + " to ") + max + " ";
}

// Empty for none.
std::string default_of(const YamlTree& schema) {
  const std::string text = text_at(schema, "default");
  return text.empty() && schema.find("default") != nullptr ? "empty" : text;
}

// {type, range} of a leaf.
std::pair<std::string, std::string> type_of(const YamlTree& schema) {
  if (const YamlTree* kinds = schema.find("anyOf")) {
    if (kinds->items.size() == 4) return {"number or distribution", range_text(range_of(kinds->items.front()))};
    std::vector<std::string> types;
    for (const YamlTree& kind : kinds->items) types.push_back(type_of(kind).first);
    return {joined(types, " or "), ""};
  }
  if (const YamlTree* constant = schema.find("const")) return {constant->scalar, ""};
  if (const YamlTree* choices = schema.find("enum")) {
    std::vector<std::string> names;
    for (const YamlTree& name : choices->items) names.push_back(name.scalar);
    return {joined(names, " \\| "), ""};
  }
  const std::string type = text_at(schema, "type");
  if (type == "array") {
    const YamlTree* items = schema.find("items");
    if (items == nullptr) return {"list", ""};
    const auto [item, range] = type_of(*items);
    return {
        "list of " + size_text(schema) + item + (item.back() == 's' || item.find(' ') != std::string::npos ? "" : "s"),
        range};
  }
  if (type == "string") return {"text", ""};
  if (type == "boolean") return {"true \\| false", ""};
  if (type == "object") return {"block", ""};
  if (type.empty()) return {"anything", ""};
  return {type == "integer" ? "whole number" : type, range_text(range_of(schema))};
}

// The block among a schema's alternatives, or the schema itself.
const YamlTree& block_of(const YamlTree& schema) {
  if (const YamlTree* kinds = schema.find("anyOf"))
    for (const YamlTree& kind : kinds->items)
      if (kind.find("properties") != nullptr && kinds->items.size() == 2) return kind;
  return schema;
}

void summarise(const YamlTree& schema, const std::string& path, const std::string& key, bool lists,
               std::vector<FieldSummary>* fields) {
  const YamlTree& block = block_of(schema);
  const std::string inner = path.empty() ? "" : path + ".";
  const YamlTree* properties = block.find("properties");
  const YamlTree* items = block.find("items");
  const YamlTree* by_name = block.find("additionalProperties");
  const bool is_named = (properties == nullptr || properties->entries.empty()) && by_name != nullptr &&
                        block_of(*by_name).find("properties") != nullptr;
  const bool is_list = items != nullptr && block_of(*items).find("properties") != nullptr;
  const bool is_block = properties != nullptr || (lists && (is_list || is_named));
  const std::string description = text_at(schema, "description");
  if (!path.empty() && (!is_block || !description.empty())) {
    const auto [type, range] = type_of(schema);
    fields->push_back({path, type, unit_of(key), range, default_of(schema), description, is_block});
  }
  if (properties != nullptr && !properties->entries.empty())
    for (const auto& [name, property] : properties->entries) summarise(property, inner + name, name, lists, fields);
  else if (lists && is_list)
    summarise(block_of(*items), path + "[]", "", lists, fields);
  else if (lists && is_named)
    summarise(*by_name, inner + "NAME", "", lists, fields);
}

}  // namespace

YamlTree schema_of_block(const VisitFields& visit) {
  SchemaWriter writer;
  visit(writer);
  return writer.schema();
}

std::string schema_of_fields(const std::string& title, const VisitFields& visit, const SchemaOptions& options) {
  YamlTree schema = file_schema(title, options.version, schema_of_block(visit));
  YamlTree* properties = entry_of(&schema, "properties");
  if (properties == nullptr) return emit_json(schema, 2) + "\n";
  if (options.includes) properties->set("include", include_schema());
  properties->set("$schema", described("string", "Where this schema lies; for editors."));
  return emit_json(schema, 2) + "\n";
}

std::string schema_of_keys(const std::string& title, const std::vector<KeyLine>& keys, std::int64_t version) {
  const std::vector<KeyPart> parts = parts_of(keys);
  const bool is_list = parts.size() == 1 && parts.front().key.empty();
  return emit_json(file_schema(title, version, is_list ? schema_of_part(parts.front()) : schema_of_lines(keys)), 2) +
         "\n";
}

std::vector<FieldSummary> fields_of_schema(const YamlTree& schema, bool lists) {
  std::vector<FieldSummary> fields;
  summarise(schema, "", "", lists, &fields);
  return fields;
}

std::string field_table(const YamlTree& schema) {
  std::string table = "| key | type | unit | range | default | meaning |\n|---|---|---|---|---|---|\n";
  for (const FieldSummary& field : fields_of_schema(schema)) {
    if (field.path == "$schema" || field.path == "include") continue;
    const std::string usual = field.default_text.empty() || field.default_text == "empty"
                                  ? field.default_text
                                  : "`" + field.default_text + "`";
    table += "| `" + field.path + "` | " +
             joined({field.type, field.unit, field.range, usual, field.description}, " | ") + " |\n";
  }
  return table;
}

}  // namespace rigproof
