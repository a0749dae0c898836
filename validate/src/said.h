#pragma once

#include "rigproof/core/finding.h"

namespace rigproof {

/// A finding's sentence; its code where nobody words it.
inline std::string said(const Finding& finding, const Wording& wording) {
  return wording ? wording(finding) : finding.code;
}

}  // namespace rigproof
