// Validation for machines: JSON, and JUnit XML for continuous integration.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/validate/budget.h"
#include "rigproof/validate/explanation.h"
#include "rigproof/validate/validate.h"

namespace rigproof {

/// One judged result, or one that could not be judged.
struct ValidationRecord {
  std::string subject;  ///< what the user named: "theirs.yaml", "ml"
  Comparison comparison;
  Budget budget;
  Gate gate;
  std::string unreadable = {};  ///< why its file cannot be judged; empty for every other result
};

/// {tool, version, passed, results: [{subject, method, status, errors in m and rad with sigma and z, checks, ..}]}.
/// Numbers read back to the same doubles; what is absent is null.
std::string to_json(const std::vector<ValidationRecord>& records, const Wording& wording = {});
/// One testsuite a result, one testcase a check, failures with messages, facts as properties. A gate that checked
/// nothing is one failing testcase, a file that cannot be judged one with an error. Reasons are the codes of the
/// findings, and their words where somebody words them; the `type` of a failure is the code of its reason, "budget"
/// where a value exceeds its limit.
/// Any text is escaped, and characters that XML forbids are replaced.
std::string to_junit(const std::vector<ValidationRecord>& records, const Wording& wording = {});

/// Written whole or not at all. Throws Error.
void save_junit(const std::vector<ValidationRecord>& records, const std::filesystem::path& file,
                const Wording& wording = {});

}  // namespace rigproof
