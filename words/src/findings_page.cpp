#include "rigproof/words/findings_page.h"

#include <algorithm>
#include <utility>

namespace rigproof::words {
namespace {

constexpr const char* kHead =
    "# Findings\n"
    "\n"
    "What Rigproof finds in data or in a solution is data: `reasons` and `notes` of results, `left_out` frames,\n"
    "`exclusions` of `observations.json`, `problems` and `notes` of `truth/proof.yaml`, and the same in `--json` and\n"
    "JUnit. Each has a stable `code`, a `severity`, and, where they apply, `cameras`, `axes`, `stops`, named `values` "
    "(the\n"
    "unit is in the name) and what it rests on, or comes with (`because`). The `sentence` beside them is for people: "
    "it may\n"
    "be worded anew at any time, and nothing reads it. Gate on codes.\n"
    "\n"
    "This page is made of the table `core/src/findings.def`; a test compares them. In the words below `{name}` is a\n"
    "value, `[[..]]` is said only where its values are there, and what follows `||` differs from frame to frame.\n"
    "A new finding is the line that makes it, its line in the table, and a test.\n";

struct Section {
  Severity severity;
  const char* head;
};

constexpr Section kSections[] = {
    {Severity::kCause,
     "Causes: the likely reason why data contradict each other, the first in this order of precedence first.\n"
     "`undone_mm` and `undone_deg` say how well odometry and cameras agree without the fault; `joined_by: or` marks a\n"
     "cause that explains the data as well as the one before."},
    {Severity::kContradiction, "Contradictions: what they concern is not answered."},
    {Severity::kRefusal, "Refusals: something is not answered."},
    {Severity::kSuspect,
     "Suspicions: the answer stands, with its uncertainty, but what was stated beforehand is hardly right. They stand\n"
     "among the `notes`; where a gate was asked for, it fails. `convention` is what `validate` suspects of a result."},
    {Severity::kNote, "Notes: worth knowing."},
    {Severity::kLeftOut, "Frames that are left out; those of `depth: true` keep their image."},
};

std::string in_table(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) text.insert(at, "\\");
  return text;
}

}  // namespace

const std::vector<FindingEntry>& all_findings() {
  static const std::vector<FindingEntry> all = {
#define RIGPROOF_FINDING(code, severity, precedence, words, remedy) {code, Severity::severity, words, remedy},
#include "findings.def"
#undef RIGPROOF_FINDING
  };
  return all;
}

std::string findings_page() {
  std::string page = kHead;
  for (const Section& section : kSections) {
    page += std::string("\n## `") + severity_name(section.severity) + "`\n\n" + section.head +
            "\n\n| Code | In words | What to do |\n|---|---|---|\n";
    for (const FindingEntry& entry : all_findings())
      if (entry.severity == section.severity)
        page += "| `" + entry.code + "` | " + in_table(entry.words) + " | " + in_table(entry.remedy) + " |\n";
  }
  return page;
}

}  // namespace rigproof::words
