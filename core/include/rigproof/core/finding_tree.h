// How findings are written to files and read from them.
#pragma once

#include <vector>

#include "rigproof/core/fields.h"
#include "rigproof/core/finding.h"
#include "rigproof/core/observations.h"

namespace rigproof {

/// A list that may be absent. Plain text, as files of before and other programs write it, is a finding `stated`.
/// @param severity of those whose file does not say; @param wording a sentence of each, for people alone
void visit_findings(FieldVisitor& visitor, const char* key, std::vector<Finding>& findings, Severity severity,
                    const Wording& wording, const char* description);

/// Why a frame is left out: code, values, because, depth. Files of before have a `reason` in words instead.
void visit_why(FieldVisitor& visitor, Exclusion& exclusion, const Wording& wording);

}  // namespace rigproof
