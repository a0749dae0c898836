#include "rigproof/study/workflow/overrides.h"

#include <map>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

// A field that is either a value or a block of fields.
struct Block {
  std::string value;
  std::map<std::string, Block> fields;
};

void set_field(Block* block, const std::string& path, const std::string& value) {
  const std::size_t dot = path.find('.');
  Block& field = block->fields[path.substr(0, dot)];
  if (dot == std::string::npos) {
    field = {value, {}};
    return;
  }
  field.value.clear();
  set_field(&field, path.substr(dot + 1), value);
}

void write_block(const Block& block, const std::string& indent, std::string* text) {
  for (const auto& [key, field] : block.fields) {
    *text += indent + key + ":" + (field.fields.empty() ? " " + field.value : "") + "\n";
    write_block(field, indent + "  ", text);
  }
}

}  // namespace

std::string overrides_as_yaml(const std::vector<std::string>& overrides) {
  Block root;
  Problems problems;
  for (const std::string& text : overrides) {
    const std::size_t equals = text.find('=');
    const std::string field = text.substr(0, equals);
    if (equals == std::string::npos || field.empty() || field.front() == '.' || field.back() == '.' ||
        text.find('\n') != std::string::npos) {
      problems.add({"--set", 0, "", text, "must be FIELD=VALUE, e.g. odometry.lambda=5"});
      continue;
    }
    set_field(&root, field, text.substr(equals + 1));
  }
  problems.throw_if_any();
  std::string yaml;
  write_block(root, "", &yaml);
  return yaml;
}

}  // namespace rigproof
