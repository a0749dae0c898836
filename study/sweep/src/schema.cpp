#include <nlohmann/json.hpp>

#include "rigproof/calib/vision/ground_source.h"
#include "rigproof/core/fields.h"
#include "rigproof/generator/config.h"
#include "rigproof/study/sweep/config.h"

namespace rigproof {
namespace {

using nlohmann::ordered_json;

ordered_json block_of(const std::string& schema, const char* description) {
  ordered_json block = ordered_json::parse(schema);
  for (const char* key : {"$schema", "title", "version"}) block.erase(key);
  block["description"] = description;
  return block;
}

ordered_json typed(const char* type, const std::string& description) {
  return {{"type", type}, {"description", description}};
}

ordered_json axis_schema() {
  ordered_json range = typed("object", "both ends included; a step or a count");
  range["properties"] = {{"from", {{"type", "number"}}},
                         {"to", {{"type", "number"}}},
                         {"step", {{"type", "number"}}},
                         {"count", {{"type", "integer"}, {"minimum", 1}}},
                         {"spacing", {{"enum", {"linear", "log"}}}}};
  range["required"] = {"from", "to"};
  range["additionalProperties"] = false;
  ordered_json axis = typed("object", "one of values, range, link, points");
  axis["properties"] = {
      {"field", typed("string", "dotted path of a run's field, of geometric.*, or images")},
      {"values", typed("array", "any values that the field takes")},
      {"range", range},
      {"link", typed("object", "fields varied together: lists of one length")},
      {"points", typed("object", "named points, each with the fields that it sets")},
      {"labels", {{"type", "array"}, {"items", {{"type", "string"}}}, {"description", "of the levels"}}},
      {"title", typed("string", "of the axis, for people and figures")},
      {"pool", typed("boolean", "the summary takes the levels as repetitions")}};
  axis["additionalProperties"] = false;
  return axis;
}

ordered_json seeds_schema() {
  const ordered_json list = {{"type", "array"}, {"items", {{"type", "integer"}, {"minimum", 0}}}};
  const ordered_json name = {{"enum", {"seed", "sensing.seed", "odometry.seed"}}};
  ordered_json block = {{"type", "object"}};
  block["properties"] = {{"first", {{"type", "integer"}, {"minimum", 0}}},
                         {"count", {{"type", "integer"}, {"minimum", 1}}},
                         {"values", list},
                         {"field", {{"oneOf", {name, {{"type", "array"}, {"items", name}}}}}}};
  block["additionalProperties"] = false;
  return {{"description", "repetitions of every point, on the same seeds: a number, a list, or a block"},
          {"oneOf", {ordered_json{{"type", "integer"}, {"minimum", 1}}, list, block}}};
}

constexpr const char* kFeatures = "where methods that follow features get them: sift, or onnx:FILE";
constexpr const char* kHorizon = "network that sees horizon and way ahead: onnx:FILE";

ordered_json ground_schema() {
  ordered_json ground = typed("string", "where the ground planes come from");
  ground["enum"] = ground_source_names();
  ground["default"] = "depth";
  return ground;
}

ordered_json method_schema() {
  ordered_json method = {{"type", "object"}};
  method["properties"] = {{"method", typed("string", "as `rigproof methods` lists them, or external:FILE.yaml")},
                          {"name", typed("string", "in the tables; default the method's own")},
                          {"ground", ground_schema()},
                          {"features", typed("string", kFeatures)},
                          {"horizon", typed("string", kHorizon)}};
  method["required"] = {"method"};
  method["additionalProperties"] = false;
  return method;
}

}  // namespace

std::string sweep_config_schema() {
  GeometricSweepConfig geometric;
  ordered_json schema;
  schema["$schema"] = "http://json-schema.org/draft-07/schema#";
  schema["title"] = "Rigproof sweep";
  schema["version"] = 1;
  schema["type"] = "object";
  ordered_json axes = typed("object", "axes by their names; every combination of levels is a point");
  axes["additionalProperties"] = axis_schema();
  ordered_json mode = {{"enum", {"rendered", "geometric"}}, {"default", "rendered"}};
  schema["properties"] = {
      {"name", typed("string", "of the sweep; default the file's name")},
      {"mode", mode},
      {"run", block_of(generate_config_schema(), "the configuration that is varied")},
      {"geometric", block_of(schema_of_fields("geometric", [&](FieldVisitor& visitor) { geometric.visit(visitor); }),
                             "mode geometric: what observations are drawn from")},
      {"axes", axes},
      {"seeds", seeds_schema()},
      {"methods",
       {{"type", "array"},
        {"items", {{"oneOf", {ordered_json{{"type", "string"}}, method_schema()}}}},
        {"description",
         "as `rigproof methods` lists them, ml:KEY=VALUE,.. or ml:FILE.yaml (schema ml), or external:FILE.yaml; or a "
         "block "
         "with what is special"}}},
      {"ground", ground_schema()},
      {"features", typed("string", kFeatures)},
      {"horizon", typed("string", kHorizon)},
      {"reference", typed("string", "method that the others are tested against")}};
  schema["additionalProperties"] = false;
  return schema.dump(2) + "\n";
}

}  // namespace rigproof
