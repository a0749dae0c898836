// Checks a document against a JSON Schema, as far as the schemas of this project go.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace rigproof {

/// What is wrong, a line each; empty if nothing is.
inline std::string schema_violations(const nlohmann::json& value, const nlohmann::json& schema,
                                     const std::string& path = "$") {
  if (schema.contains("anyOf")) {
    std::string all;
    for (const nlohmann::json& kind : schema["anyOf"]) {
      const std::string found = schema_violations(value, kind, path);
      if (found.empty()) return "";
      all += found;
    }
    return all;
  }
  if (schema.contains("enum")) {
    for (const nlohmann::json& choice : schema["enum"])
      if (value == choice) return "";
    return path + ": " + value.dump() + " is none of " + schema["enum"].dump() + "\n";
  }
  const std::string type = schema.value("type", "");
  const bool fits = type.empty() || (type == "object" && value.is_object()) || (type == "array" && value.is_array()) ||
                    (type == "string" && value.is_string()) || (type == "boolean" && value.is_boolean()) ||
                    (type == "null" && value.is_null()) || (type == "number" && value.is_number()) ||
                    (type == "integer" && value.is_number_integer());
  if (!fits) return path + ": " + value.dump().substr(0, 60) + " is no " + type + "\n";
  std::string found;
  if (value.is_number() && value < schema.value("minimum", -1e308)) found += path + ": is too small\n";
  if (value.is_number() && value > schema.value("maximum", 1e308)) found += path + ": is too large\n";
  if (value.is_array() && schema.contains("items"))
    for (std::size_t i = 0; i < value.size(); ++i)
      found += schema_violations(value[i], schema["items"], path + "[" + std::to_string(i) + "]");
  if (!value.is_object()) return found;
  const nlohmann::json properties = schema.value("properties", nlohmann::json::object());
  for (const auto& [key, entry] : value.items()) {
    const std::string inner = path + "." + key;
    const bool tolerated = schema.contains("patternProperties") && key.rfind("x-", 0) == 0;
    const nlohmann::json rest = schema.value("additionalProperties", nlohmann::json(true));
    if (properties.contains(key))
      found += schema_violations(entry, properties[key], inner);
    else if (rest.is_object())
      found += schema_violations(entry, rest, inner);
    else if (rest == false && !tolerated)
      found += inner + ": unknown key\n";
  }
  for (const nlohmann::json& key : schema.value("required", nlohmann::json::array()))
    if (!value.contains(key.get<std::string>())) found += path + "." + key.get<std::string>() + ": is missing\n";
  return found;
}

}  // namespace rigproof
