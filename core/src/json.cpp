// A tree as JSON.
#include <nlohmann/json.hpp>

#include "rigproof/core/yaml.h"

namespace rigproof {
namespace {

std::string json_text(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// What a person wrote may be a number that only YAML takes (.5, +1), or text without quotes.
std::string json_scalar(const YamlTree& tree) {
  if (tree.quoted) return json_text(tree.scalar);
  const std::optional<double> number = parse_number(tree.scalar);
  if ((number && number_text(*number) == tree.scalar) || nlohmann::json::accept(tree.scalar)) return tree.scalar;
  return number ? number_text(*number) : json_text(tree.scalar);
}

// Puts the parts between the brackets, on one line for an indent below 0.
std::string bracketed(const char* brackets, const std::vector<std::string>& parts, int indent, int depth) {
  if (parts.empty()) return brackets;
  const auto lead = [indent](int level) {
    return indent < 0 ? std::string() : "\n" + std::string(static_cast<std::size_t>(indent * level), ' ');
  };
  const std::string separator = indent < 0 ? ", " : "," + lead(depth + 1);
  return brackets[0] + lead(depth + 1) + joined(parts, separator) + lead(depth) + brackets[1];
}

std::string json_of(const YamlTree& tree, int indent, int depth) {
  if (tree.is_null()) return "null";
  if (tree.is_scalar()) return json_scalar(tree);
  const int inner = tree.flow ? -1 : indent;
  std::vector<std::string> parts;
  for (const YamlTree& item : tree.items) parts.push_back(json_of(item, inner, depth + 1));
  for (const auto& [key, value] : tree.entries)
    parts.push_back(json_text(key) + ": " + json_of(value, inner, depth + 1));
  return bracketed(tree.is_map() ? "{}" : "[]", parts, inner, depth);
}

}  // namespace

std::string emit_json(const YamlTree& tree, int indent) { return json_of(tree, indent, 0); }

}  // namespace rigproof
