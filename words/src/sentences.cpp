#include "rigproof/words/sentences.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "rigproof/core/text.h"
#include "template.h"

namespace rigproof::words {
namespace {

const double* number_of(const Finding& finding, const char* name) {
  const FindingValue* value = finding.find(name);
  return value == nullptr ? nullptr : std::get_if<double>(&value->value);
}

std::string cause_sentence(const Finding& finding, const std::string& what) {
  std::string text = "Most likely cause: " + what + ".";
  const double *off_mm = number_of(finding, "undone_mm"), *off_deg = number_of(finding, "undone_deg");
  if (off_mm != nullptr && off_deg != nullptr)
    text +=
        fmt::format(" Undone, the odometry agrees with the cameras to {:.1f} mm and {:.2f} deg.", *off_mm, *off_deg);
  return text;
}

// A sentence, and the cameras of which it is said.
struct Line {
  std::string what;
  bool of_cameras = false;
  std::vector<std::string> cameras;
};

Line line_of(const Finding& finding) {
  const Words words = words_of(finding);
  if (finding.severity == Severity::kCause) return {cause_sentence(finding, words.whole()), false, {}};
  const bool before = !finding.cameras.empty() && !words.names_cameras;
  return {words.whole(), before, before ? finding.cameras : std::vector<std::string>()};
}

std::string text_of(const Line& line, const std::vector<std::string>& all_cameras) {
  if (!line.of_cameras) return line.what;
  const std::set<std::string> named(line.cameras.begin(), line.cameras.end());
  const bool all = named.size() > 1 && named == std::set<std::string>(all_cameras.begin(), all_cameras.end());
  return (all ? "all cameras" : joined(line.cameras)) + ": " + line.what;
}

// A cause with the others that explain the data as well ("or") and what belongs to it ("and").
Line cause_line(const std::vector<Finding>& findings, std::size_t* i) {
  const Finding& first = findings[*i];
  std::string what = words_of(first).whole();
  while (*i + 1 < findings.size()) {
    const FindingValue* joined_by = findings[*i + 1].find("joined_by");
    if (joined_by == nullptr) break;
    ++*i;
    what += (*joined_by == FindingValue("joined_by", "or") ? "; or " : ", ") + words_of(findings[*i]).whole();
  }
  return {cause_sentence(first, what), false, {}};
}

void add(Line line, std::vector<Line>* lines) {
  const auto same = std::find_if(lines->begin(), lines->end(), [&](const Line& other) {
    return other.what == line.what && other.of_cameras == line.of_cameras;
  });
  if (same == lines->end()) return lines->push_back(std::move(line));
  for (std::string& camera : line.cameras)
    if (std::find(same->cameras.begin(), same->cameras.end(), camera) == same->cameras.end())
      same->cameras.push_back(std::move(camera));
}

}  // namespace

std::string sentence_of(const Finding& finding) { return text_of(line_of(finding), {}); }

std::string short_of(const Finding& finding) { return words_of(finding).head; }

std::vector<std::string> sentences_of(const std::vector<Finding>& findings,
                                      const std::vector<std::string>& all_cameras) {
  std::vector<Line> lines;
  for (std::size_t i = 0; i < findings.size(); ++i)
    add(findings[i].severity == Severity::kCause ? cause_line(findings, &i) : line_of(findings[i]), &lines);
  std::vector<std::string> texts;
  for (const Line& line : lines) texts.push_back(text_of(line, all_cameras));
  return texts;
}

std::string text_of(const std::vector<Finding>& findings) { return sentences_text(sentences_of(findings)); }

std::vector<ReasonGroup> by_reason(const std::vector<Exclusion>& left_out) {
  std::map<std::string, std::vector<const Exclusion*>> alike;
  for (const Exclusion& exclusion : left_out) alike[short_of(exclusion.why)].push_back(&exclusion);
  std::vector<ReasonGroup> groups;
  for (const auto& [reason, exclusions] : alike) {
    const std::string whole = words_of(exclusions.front()->why).whole();
    const bool same = std::all_of(exclusions.begin(), exclusions.end(), [&](const Exclusion* exclusion) {
      return words_of(exclusion->why).whole() == whole;
    });
    groups.push_back({same ? whole : reason, {}});
    for (const Exclusion* exclusion : exclusions) groups.back().stops.push_back(exclusion->stop);
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const ReasonGroup& a, const ReasonGroup& b) { return a.stops.size() > b.stops.size(); });
  return groups;
}

std::string message_of(const std::exception& error) {
  const auto* finding = dynamic_cast<const FindingError*>(&error);
  return finding == nullptr ? error.what() : finding->place() + ": " + sentence_of(finding->finding());
}

}  // namespace rigproof::words
