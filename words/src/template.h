// The words of the table of findings, filled with a finding's values. core/src/findings.def tells the syntax.
#pragma once

#include <string>

#include "rigproof/core/finding.h"

namespace rigproof::words {

struct Words {
  std::string head;    ///< what frames have in common
  std::string detail;  ///< what differs from frame to frame; may be empty
  bool names_cameras = false;
  std::string whole() const { return detail.empty() ? head : head + " " + detail; }
};

/// A code that the table lacks, of a newer program, is given as code and values.
Words words_of(const Finding& finding);

}  // namespace rigproof::words
