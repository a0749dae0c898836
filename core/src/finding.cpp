#include "rigproof/core/finding.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace rigproof {
namespace {

struct Row {
  const char* code;
  Severity severity;
  int precedence;  // among causes; 0 for all else
};

// Without the words: those are compiled into rigproof::words alone.
constexpr Row kRows[] = {
#define RIGPROOF_FINDING(code, severity, precedence, words, remedy) {code, Severity::severity, precedence},
#include "findings.def"
#undef RIGPROOF_FINDING
};

constexpr std::array<const char*, 6> kSeverityNames = {"note",    "suspect",       "left_out",
                                                       "refusal", "contradiction", "cause"};

const Row* row_of(const std::string& code) {
  const auto* found =
      std::find_if(std::begin(kRows), std::end(kRows), [&](const Row& row) { return code == row.code; });
  return found == std::end(kRows) ? nullptr : found;
}

// Causes first; a code that the table lacks comes from a newer program.
int precedence(const Finding& finding) {
  constexpr int kLastCause = 1000, kNoCause = 1001;
  if (finding.severity != Severity::kCause) return kNoCause;
  const Row* row = row_of(finding.code);
  return row == nullptr || row->precedence == 0 ? kLastCause : row->precedence;
}

}  // namespace

const char* severity_name(Severity severity) { return kSeverityNames[static_cast<std::size_t>(severity)]; }

Finding::Finding(std::string known_code, FindingValues with) : code(std::move(known_code)), values(std::move(with)) {
  const Row* row = row_of(code);
  if (row == nullptr) throw std::logic_error("core/src/findings.def has no finding " + code);
  severity = row->severity;
}

Finding Finding::of(std::string camera) const { return of(std::vector<std::string>{std::move(camera)}); }

Finding Finding::of(std::vector<std::string> names) const {
  Finding finding = *this;
  finding.cameras = std::move(names);
  return finding;
}

Finding Finding::along(std::vector<std::string> degrees) const {
  Finding finding = *this;
  finding.axes = std::move(degrees);
  return finding;
}

Finding Finding::at(std::vector<int> indices) const {
  Finding finding = *this;
  finding.stops = std::move(indices);
  return finding;
}

Finding Finding::with(const FindingValues& more) const {
  Finding finding = *this;
  finding.values.insert(finding.values.end(), more.begin(), more.end());
  return finding;
}

Finding Finding::by(std::vector<Finding> causes) const {
  Finding finding = *this;
  finding.because = std::move(causes);
  return finding;
}

const FindingValue* Finding::find(const std::string& name) const {
  const auto found = std::find_if(values.begin(), values.end(), [&](const FindingValue& v) { return v.name == name; });
  return found == values.end() ? nullptr : &*found;
}

bool Finding::operator==(const Finding& other) const {
  return code == other.code && severity == other.severity && cameras == other.cameras && axes == other.axes &&
         stops == other.stops && values == other.values && because == other.because;
}

Finding stated(const std::string& text, Severity severity) {
  Finding finding("stated", {{"text", text}});
  finding.severity = severity;
  return finding;
}

bool has_code(const std::vector<Finding>& findings, const char* code) {
  return std::any_of(findings.begin(), findings.end(), [code](const Finding& finding) { return finding.is(code); });
}

void add_once(Finding finding, std::vector<Finding>* findings) {
  if (std::find(findings->begin(), findings->end(), finding) == findings->end())
    findings->push_back(std::move(finding));
}

void causes_first(std::vector<Finding>* findings) {
  std::vector<std::pair<int, Finding>> ranked;
  for (Finding& finding : *findings) {
    const int rank =
        finding.find("joined_by") != nullptr && !ranked.empty() ? ranked.back().first : precedence(finding);
    ranked.emplace_back(rank, std::move(finding));
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < ranked.size(); ++i) (*findings)[i] = std::move(ranked[i].second);
}

}  // namespace rigproof
