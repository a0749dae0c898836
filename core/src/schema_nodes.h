// Nodes of a JSON Schema.
#pragma once

#include "rigproof/core/yaml.h"

namespace rigproof {

inline YamlTree schema_of_type(const char* type) {
  YamlTree schema = YamlTree::map();
  schema.set("type", YamlTree::text(type));
  return schema;
}

inline YamlTree schema_of_list(YamlTree items) {
  YamlTree schema = schema_of_type("array");
  schema.set("items", std::move(items));
  return schema;
}

/// One of several schemas.
inline YamlTree schema_of_any(std::vector<YamlTree> kinds) {
  YamlTree schema = YamlTree::map();
  schema.set("anyOf", YamlTree::sequence()).items = std::move(kinds);
  return schema;
}

}  // namespace rigproof
