// Findings as people read them, for tests of what is said.
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "rigproof/words/sentences.h"

namespace rigproof {

inline std::vector<std::string> worded(const std::vector<Finding>& findings) { return words::sentences_of(findings); }
inline std::string worded(const Finding& finding) { return words::sentence_of(finding); }
/// Empty where there is none.
inline std::string worded(const std::optional<Finding>& finding) { return finding ? worded(*finding) : ""; }

inline void PrintTo(const Finding& finding, std::ostream* out) { *out << finding.code << ": " << worded(finding); }

}  // namespace rigproof
