#include "json_text.h"

#include <nlohmann/json.hpp>

#include "rigproof/core/version.h"

namespace rigproof {

std::string json_text(nlohmann::json json, int indent) {
  if (json.is_object()) json["version"] = version();
  return json.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace rigproof
