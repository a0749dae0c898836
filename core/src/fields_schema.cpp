// JSON Schema (draft 7) from the same declaration that reads and writes a configuration.
#include <cmath>
#include <nlohmann/json.hpp>

#include "rigproof/core/fields.h"

namespace rigproof {
namespace {

using Json = nlohmann::ordered_json;

void add_range(Json* schema, const NumberRange& range) {
  if (std::isfinite(range.min)) (*schema)["minimum"] = range.min;
  if (std::isfinite(range.max)) (*schema)["maximum"] = range.max;
}

Json number_schema(const NumberRange& range) {
  Json schema{{"type", "number"}};
  add_range(&schema, range);
  return schema;
}

Json object_schema(Json properties) {
  return {{"type", "object"}, {"additionalProperties", false}, {"properties", std::move(properties)}};
}

Json list_schema(Json items, std::size_t size_min, std::size_t size_max) {
  Json schema{{"type", "array"}, {"items", std::move(items)}, {"minItems", size_min}};
  if (size_max != std::numeric_limits<std::size_t>::max()) schema["maxItems"] = size_max;
  return schema;
}

Json only(const char* key, Json value) {
  Json schema = object_schema({{key, std::move(value)}});
  schema["required"] = {key};
  return schema;
}

Json distribution_schema(const NumberRange& range) {
  const Json number = number_schema(range);
  Json normal = object_schema({{"mean", number}, {"stddev", number_schema({0.0})}});
  normal["required"] = {"mean", "stddev"};
  const Json uniform = list_schema(number, 2, 2);
  const Json choice = list_schema(number, 1, std::numeric_limits<std::size_t>::max());
  return {{"anyOf", {number, only("uniform", uniform), only("normal", normal), only("choice", choice)}}};
}

Json default_of(const Distribution& distribution) {
  struct {
    Json operator()(double constant) const { return constant; }
    Json operator()(const Distribution::Uniform& u) const { return {{"uniform", {u.low, u.high}}}; }
    Json operator()(const Distribution::Normal& n) const {
      return {{"normal", {{"mean", n.mean}, {"stddev", n.standard_deviation}}}};
    }
    Json operator()(const Distribution::Choice& c) const { return {{"choice", c.values}}; }
  } to_json;
  return std::visit(to_json, distribution.kind());
}

class SchemaWriter : public FieldVisitor {
 public:
  void field(const char* key, double& value, const NumberRange& range, const char* description) override {
    add(key, number_schema(range), description, value);
  }
  void field(const char* key, std::int64_t& value, const NumberRange& range, const char* description) override {
    Json schema{{"type", "integer"}};
    add_range(&schema, range);
    add(key, schema, description, value);
  }
  void field(const char* key, bool& value, const char* description) override {
    add(key, {{"type", "boolean"}}, description, value);
  }
  void field(const char* key, std::string& value, const TextChoices& choices, const char* description) override {
    Json schema{{"type", "string"}};
    if (!choices.choices.empty()) schema["enum"] = choices.choices;
    add(key, schema, description, value);
  }
  void field(const char* key, Distribution& value, const NumberRange& range, const char* description) override {
    add(key, distribution_schema(range), description, default_of(value));
  }
  void field(const char* key, std::vector<double>& value, const NumberRange& range, std::size_t size_min,
             std::size_t size_max, const char* description) override {
    add(key, list_schema(number_schema(range), size_min, size_max), description, value);
  }
  void field(const char* key, std::vector<std::string>& value, const char* description) override {
    add(key, {{"type", "array"}, {"items", {{"type", "string"}}}}, description, value);
  }
  void section(const char* key, const std::function<void(FieldVisitor&)>& visit, const char* description) override {
    SchemaWriter inner;
    visit(inner);
    Json schema = object_schema(inner.properties());
    schema["description"] = description;
    properties_[key] = std::move(schema);
  }
  void list(const char* key, const std::function<std::size_t()>& size, const std::function<void(std::size_t)>& resize,
            const std::function<void(std::size_t, FieldVisitor&)>& visit, const char* description) override {
    const bool empty = size() == 0;
    if (empty) resize(1);
    SchemaWriter inner;
    visit(0, inner);
    if (empty) resize(0);
    properties_[key] = {{"type", "array"}, {"items", object_schema(inner.properties())}, {"description", description}};
  }
  void check(bool, const char*, const std::string&) override {}

  Json& properties() { return properties_; }

 private:
  void add(const char* key, Json schema, const char* description, Json default_value) {
    schema["description"] = description;
    schema["default"] = std::move(default_value);
    properties_[key] = std::move(schema);
  }

  Json properties_ = Json::object();
};

}  // namespace

std::string schema_of_fields(const std::string& title, const VisitFields& visit) {
  SchemaWriter writer;
  visit(writer);
  Json& properties = writer.properties();
  const Json name{{"type", "string"}};
  properties["include"] = {{"description", "File, or list of files, read first: relative to this one, or a preset."},
                           {"anyOf", {name, {{"type", "array"}, {"items", name}}}}};
  properties["$schema"] = {{"type", "string"}, {"description", "Where this schema lies; for editors."}};
  Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
  schema.update(object_schema(properties));
  return schema.dump(2) + "\n";
}

}  // namespace rigproof
