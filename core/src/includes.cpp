#include "rigproof/core/includes.h"

#include <algorithm>

#include "rigproof/core/data_path.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxIncludeDepth = 16;

std::vector<std::string> included_names(const YamlTree& include, Problems* problems) {
  std::vector<std::string> names;
  const auto add = [&](const YamlTree& item) {
    if (const auto name = read_text(item, "include", {}, problems)) names.push_back(*name);
  };
  if (include.is_sequence())
    std::for_each(include.items.begin(), include.items.end(), add);
  else
    add(include);
  return names;
}

// Relative to the including file, else a preset of config/.
fs::path included_file(const std::string& name, const YamlTree& include) {
  const fs::path beside = fs::path(include.file).parent_path() / name;
  std::error_code ignored;
  if (fs::is_regular_file(beside, ignored)) return beside;
  try {
    return find_data_file("config", name);
  } catch (const Error& error) {
    throw Error(Problem{include.file, include.line, "include", for_message(name),
                        "there is no such file beside this one, and no preset: " + std::string(error.what())}
                    .text());
  }
}

YamlTree with_includes(YamlTree tree, int depth) {
  const YamlTree* include = tree.find("include");
  if (include == nullptr) return tree;
  if (depth >= kMaxIncludeDepth)
    throw Error(Problem{tree.file, include->line, "include", "", "files include each other without end"}.text());
  Problems problems;
  YamlTree merged = YamlTree::map();
  for (const std::string& name : included_names(*include, &problems))
    merge_into(&merged, with_includes(read_yaml_file(included_file(name, *include)), depth + 1));
  problems.throw_if_any();
  const auto is_include = [](const auto& entry) { return entry.first == "include"; };
  tree.entries.erase(std::remove_if(tree.entries.begin(), tree.entries.end(), is_include), tree.entries.end());
  merge_into(&merged, std::move(tree));
  return merged;
}

}  // namespace

bool is_distribution(const YamlTree& tree) {
  return tree.is_map() && tree.entries.size() == 1 &&
         (tree.find("uniform") != nullptr || tree.find("normal") != nullptr || tree.find("choice") != nullptr);
}

void merge_into(YamlTree* base, YamlTree over) {
  const bool replaced = !base->is_map() || !over.is_map() || is_distribution(*base) || is_distribution(over);
  if (replaced) {
    *base = std::move(over);
    return;
  }
  for (auto& [key, value] : over.entries) {
    const auto same = [&key = key](const auto& entry) { return entry.first == key; };
    const auto place = std::find_if(base->entries.begin(), base->entries.end(), same);
    if (place == base->entries.end())
      base->entries.emplace_back(key, std::move(value));
    else
      merge_into(&place->second, std::move(value));
  }
  base->file = over.file;
  base->line = over.line;
}

YamlTree resolve_includes(YamlTree tree) { return with_includes(std::move(tree), 0); }

}  // namespace rigproof
