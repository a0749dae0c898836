// Every finding that there is, for the documentation.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/finding.h"

namespace rigproof::words {

struct FindingEntry {
  std::string code;
  Severity severity = Severity::kNote;
  std::string words;   ///< with {values}
  std::string remedy;  ///< what to do
};

const std::vector<FindingEntry>& all_findings();

/// docs/reference/findings.md.
std::string findings_page();

}  // namespace rigproof::words
