#include "finding_tree.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "rigproof/core/fields.h"

namespace rigproof {
namespace {

// Begins the reasons of exclusions of depth in files of before.
constexpr const char* kDepthReason = "depth: ";
constexpr std::size_t kMaxStops = 1000000, kMaxCode = 100;

template <typename Value, typename Node>
void set_list(const char* key, const std::vector<Value>& values, const Node& node, YamlTree* tree) {
  if (values.empty()) return;
  YamlTree& list = tree->set(key, YamlTree::sequence());
  list.flow = true;
  for (const Value& value : values) list.add(node(value));
}

YamlTree tree_of(const FindingValues& values) {
  YamlTree tree = YamlTree::inline_map();
  for (const FindingValue& value : values) {
    const auto* number = std::get_if<double>(&value.value);
    // What is infinite has no number on disk.
    tree.set(value.name, number == nullptr        ? YamlTree::text(std::get<std::string>(value.value))
                         : std::isfinite(*number) ? YamlTree::number(*number)
                                                  : YamlTree::text(number_text(*number)));
  }
  return tree;
}

void set_rest(const Finding& finding, YamlTree* tree) {
  if (!finding.values.empty()) tree->set("values", tree_of(finding.values));
  if (finding.because.empty()) return;
  YamlTree& list = tree->set("because", YamlTree::sequence());
  list.flow = true;
  for (const Finding& reason : finding.because) {
    YamlTree& entry = list.add(YamlTree::inline_map());
    entry.set("code", YamlTree::text(reason.code));
    entry.set("severity", YamlTree::text(severity_name(reason.severity)));
    set_rest(reason, &entry);
  }
}

YamlTree tree_of(const Finding& finding, const Wording& wording) {
  YamlTree tree = YamlTree::map();
  if (wording) tree.set("sentence", YamlTree::text(wording(finding)));
  tree.set("code", YamlTree::text(finding.code));
  tree.set("severity", YamlTree::text(severity_name(finding.severity)));
  const auto text = [](const std::string& value) { return YamlTree::text(value); };
  set_list("cameras", finding.cameras, text, &tree);
  set_list("axes", finding.axes, text, &tree);
  set_list(
      "stops", finding.stops, [](int stop) { return YamlTree::integer(stop); }, &tree);
  set_rest(finding, &tree);
  return tree;
}

std::string read_code(MapReader* map) {
  const std::optional<std::string> code = map->text("code");
  const auto allowed = [](char c) { return c == '.' || c == '_' || std::isdigit(c) != 0 || std::islower(c) != 0; };
  if (code && code->size() <= kMaxCode && std::all_of(code->begin(), code->end(), allowed)) return *code;
  map->require("code", "the code of a finding");
  if (code) map->problem("code", "must be the code of a finding: small letters, digits, points, underscores");
  return "";
}

FindingValues read_values(MapReader* map) {
  FindingValues values;
  const YamlTree* tree = map->find("values");
  if (tree == nullptr) return values;
  MapReader reader(*tree, map->path_of("values"), &map->problems());
  for (const auto& [name, value] : tree->entries) {
    const std::optional<double> number = value.is_scalar() && !value.quoted ? parse_number(value.scalar) : std::nullopt;
    if (number)
      values.emplace_back(name, *number);
    else if (const std::optional<std::string> text = read_text(value, reader.path_of(name), {}, &map->problems()))
      values.emplace_back(name, *text);
  }
  return values;
}

Finding read_finding(const YamlTree& tree, const std::string& path, Severity severity, Problems* problems);

void read_rest(MapReader* map, Finding* finding) {
  finding->values = read_values(map);
  if (const YamlTree* because = map->find("because"))
    for (std::size_t i = 0; i < because->items.size(); ++i)
      finding->because.push_back(read_finding(because->items[i],
                                              map->path_of("because") + "[" + std::to_string(i) + "]",
                                              finding->severity, &map->problems()));
}

Finding read_finding(const YamlTree& tree, const std::string& path, Severity severity, Problems* problems) {
  if (tree.is_scalar()) return stated(tree.scalar, severity);
  Finding finding;
  MapReader map(tree, path, problems);
  map.find("sentence");  // for people
  finding.code = read_code(&map);
  const auto name = map.text("severity", {"note", "left_out", "refusal", "contradiction", "cause"});
  finding.severity = severity_named(name.value_or("")).value_or(severity);
  finding.cameras = map.texts("cameras").value_or(std::vector<std::string>());
  finding.axes = map.texts("axes").value_or(std::vector<std::string>());
  for (const double stop : map.numbers("stops", 0, kMaxStops, {-1.0, 1e9}).value_or(std::vector<double>()))
    finding.stops.push_back(static_cast<int>(stop));
  read_rest(&map, &finding);
  map.finish("x-");
  return finding;
}

}  // namespace

std::string findings_json(const std::vector<Finding>& findings, const Wording& wording) {
  return emit_json(tree_of(findings, wording), -1);
}

YamlTree tree_of(const std::vector<Finding>& findings, const Wording& wording) {
  YamlTree tree = YamlTree::sequence();
  for (const Finding& finding : findings) tree.add(tree_of(finding, wording));
  return tree;
}

std::vector<Finding> read_findings(MapReader* map, const std::string& key, Severity severity) {
  std::vector<Finding> findings;
  const YamlTree* list = map->find(key);
  if (list == nullptr || list->is_null()) return findings;
  if (!list->is_sequence()) map->problem(key, "must be a list of findings, or of sentences");
  for (std::size_t i = 0; i < list->items.size(); ++i)
    findings.push_back(
        read_finding(list->items[i], map->path_of(key) + "[" + std::to_string(i) + "]", severity, &map->problems()));
  return findings;
}

void set_exclusion(const Exclusion& exclusion, const Wording& wording, YamlTree* tree) {
  if (wording) tree->set("sentence", YamlTree::text(wording(exclusion.why)));
  tree->set("code", YamlTree::text(exclusion.why.code));
  if (exclusion.depth) tree->set("depth", YamlTree::boolean(true));
  set_rest(exclusion.why, tree);
}

void read_exclusion(MapReader* map, Exclusion* exclusion) {
  exclusion->why.severity = Severity::kLeftOut;
  if (const std::optional<std::string> reason = map->text("reason")) {
    exclusion->depth = reason->rfind(kDepthReason, 0) == 0;
    exclusion->why =
        stated(exclusion->depth ? reason->substr(std::string(kDepthReason).size()) : *reason, Severity::kLeftOut);
    return;
  }
  map->find("sentence");  // for people
  exclusion->why.code = read_code(map);
  exclusion->depth = map->boolean("depth").value_or(false);
  read_rest(map, &exclusion->why);
}

std::vector<KeyLine> finding_keys(const std::string& list) {
  return {{list + "[].sentence?", "text", "for people alone"},
          {list + "[].code", "text", "what was found; docs/reference/findings.md lists all"},
          {list + "[].severity", "note | left_out | refusal | contradiction | cause", "what it means for the result"},
          {list + "[].cameras?", "texts", "which it concerns"},
          {list + "[].axes?", "texts", "degrees of freedom that it concerns"},
          {list + "[].stops?", "numbers", "indices of stops that it concerns"},
          {list + "[].values?", "anything", "numbers and texts by name"},
          {list + "[].because[]?", "anything", "findings that speak for it"}};
}

std::vector<KeyLine> exclusion_keys(const std::string& list) {
  return {{list + "[].stop", "integer", "index of the stop; -1 = none"},
          {list + "[].file", "text", "the image"},
          {list + "[].sentence?", "text", "for people alone"},
          {list + "[].code", "text", "why; docs/reference/findings.md lists all"},
          {list + "[].depth?", "boolean", "whether only its depth is left out"},
          {list + "[].values?", "anything", "numbers and texts by name"},
          {list + "[].because[]?", "anything", "findings that speak for it"}};
}

}  // namespace rigproof
