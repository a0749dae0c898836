#include "rigproof/core/finding_tree.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "rigproof/core/fields.h"
#include "schema_nodes.h"

namespace rigproof {
namespace {

// Begins the reasons of exclusions of depth in files of before.
constexpr const char* kDepthReason = "depth: ";
constexpr std::size_t kMaxStops = 1000000, kMaxCode = 100;

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

FindingValues read_values(const YamlTree& tree, const std::string& path, Problems* problems) {
  FindingValues values;
  MapReader reader(tree, path, problems);
  for (const auto& [name, value] : tree.entries) {
    const std::optional<double> number = value.is_scalar() && !value.quoted ? parse_number(value.scalar) : std::nullopt;
    if (number)
      values.emplace_back(name, *number);
    else if (const std::optional<std::string> text = read_text(value, reader.path_of(name), {}, problems))
      values.emplace_back(name, *text);
  }
  return values;
}

FieldValue values_value(FindingValues& values) {
  return {[&values](const YamlTree& tree, const std::string& path, Problems* problems) {
            values = read_values(tree, path, problems);
          },
          [&values] { return values.empty() ? std::nullopt : std::make_optional(tree_of(values)); },
          [] { return schema_of_type("object"); }};
}

void visit_finding(FieldVisitor& visitor, Finding& finding, const Wording& wording);

std::vector<Finding> read_findings(const YamlTree& list, const std::string& path, Severity severity,
                                   Problems* problems) {
  std::vector<Finding> findings(list.items.size());
  if (!list.is_sequence() && !list.is_null())
    problems->add({list.file, list.line, path, list.shown(), "must be a list of findings, or of sentences"});
  for (std::size_t i = 0; i < findings.size(); ++i) {
    findings[i].severity = severity;
    read_fields_of_block(list.items[i], path + "[" + std::to_string(i) + "]", problems,
                         [&](FieldVisitor& visitor) { visit_finding(visitor, findings[i], {}); });
  }
  return findings;
}

YamlTree tree_of(const std::vector<Finding>& findings, const Wording& wording) {
  YamlTree tree = YamlTree::sequence();
  for (Finding finding : findings)
    tree.add(tree_of_fields([&](FieldVisitor& visitor) { visit_finding(visitor, finding, wording); }));
  return tree;
}

// On one line, and without what the finding says that it speaks for.
std::optional<YamlTree> tree_of_because(std::vector<Finding> because) {
  if (because.empty()) return std::nullopt;
  for (Finding& reason : because) reason = Finding(reason).of(std::vector<std::string>()).along({}).at({});
  YamlTree list = tree_of(because, {});
  list.flow = true;
  return list;
}

void visit_code(FieldVisitor& visitor, Finding& finding, const Wording& wording) {
  std::string sentence = wording ? wording(finding) : "";
  visitor.optional("sentence", sentence, "for people alone");
  const auto allowed = [](char c) { return c == '.' || c == '_' || std::isdigit(c) != 0 || std::islower(c) != 0; };
  std::string& code = finding.code;
  visitor.require("code", "the code of a finding");
  visitor.field("code", code, TextChoices{}, "what was found; docs/reference/findings.md lists all");
  visitor.check(code.size() <= kMaxCode && std::all_of(code.begin(), code.end(), allowed), "code",
                "must be the code of a finding: small letters, digits, points, underscores");
}

void visit_rest(FieldVisitor& visitor, Finding& finding) {
  visitor.value("values", values_value(finding.values), "numbers and texts by name");
  const FieldValue because = {[&finding](const YamlTree& tree, const std::string& path, Problems* problems) {
                                finding.because = read_findings(tree, path, finding.severity, problems);
                              },
                              [&finding] { return tree_of_because(finding.because); },
                              // Of findings again: a schema that describes them would not end.
                              [] { return schema_of_type("array"); }};
  visitor.value("because", because, "findings that speak for it");
}

void visit_texts(FieldVisitor& visitor, const char* key, std::vector<std::string>& texts, const char* description) {
  if (visitor.takes(key, !texts.empty())) visitor.field(key, texts, description);
}

void visit_stops(FieldVisitor& visitor, std::vector<int>& stops) {
  if (!visitor.takes("stops", !stops.empty())) return;
  std::vector<double> indices(stops.begin(), stops.end());
  visitor.field("stops", indices, {-1.0, 1e9}, 0, kMaxStops, "indices of stops that it concerns");
  stops.clear();
  for (const double index : indices) stops.push_back(static_cast<int>(index));
}

void visit_finding(FieldVisitor& visitor, Finding& finding, const Wording& wording) {
  const auto state = [&finding](const std::string& text) { finding = stated(text, finding.severity); };
  if (visitor.instead({{}, "a sentence, in files of before and of other programs", state})) return;
  visit_code(visitor, finding, wording);
  std::vector<std::pair<const char*, Severity>> severities;
  for (const Severity severity : {Severity::kNote, Severity::kSuspect, Severity::kLeftOut, Severity::kRefusal,
                                  Severity::kContradiction, Severity::kCause})
    severities.emplace_back(severity_name(severity), severity);
  visitor.choice("severity", finding.severity, severities, "what it means for the result");
  visit_texts(visitor, "cameras", finding.cameras, "which it concerns");
  visit_texts(visitor, "axes", finding.axes, "degrees of freedom that it concerns");
  visit_stops(visitor, finding.stops);
  visit_rest(visitor, finding);
  visitor.tolerate("x-");
}

}  // namespace

std::string findings_json(const std::vector<Finding>& findings, const Wording& wording) {
  return emit_json(tree_of(findings, wording), -1);
}

std::vector<Finding> findings_of_json(const std::string& json) {
  Problems problems;
  std::vector<Finding> findings = read_findings(parse_yaml(json, "findings"), "findings", Severity::kNote, &problems);
  problems.throw_if_any();
  return findings;
}

void visit_findings(FieldVisitor& visitor, const char* key, std::vector<Finding>& findings, Severity severity,
                    const Wording& wording, const char* description) {
  const auto schema = [] {
    Finding finding;
    return schema_of_list(schema_of_block([&](FieldVisitor& inner) { visit_finding(inner, finding, {}); }));
  };
  const FieldValue list = {[&findings, severity](const YamlTree& tree, const std::string& path, Problems* problems) {
                             findings = read_findings(tree, path, severity, problems);
                           },
                           [&] { return tree_of(findings, wording); }, schema};
  visitor.value(key, list, description);
}

void visit_why(FieldVisitor& visitor, Exclusion& exclusion, const Wording& wording) {
  std::string reason;
  visitor.optional("reason", reason, "why, in files of before");
  if (visitor.is_reading()) exclusion.why.severity = Severity::kLeftOut;
  if (visitor.is_reading() && !reason.empty()) {
    exclusion.depth = reason.rfind(kDepthReason, 0) == 0;
    exclusion.why =
        stated(exclusion.depth ? reason.substr(std::string(kDepthReason).size()) : reason, Severity::kLeftOut);
    return;
  }
  visit_code(visitor, exclusion.why, wording);
  if (visitor.takes("depth", exclusion.depth))
    visitor.field("depth", exclusion.depth, "whether only its depth is left out");
  visit_rest(visitor, exclusion.why);
}

}  // namespace rigproof
