// Is a run what its manifest says it is?
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rigproof/core/run_folder.h"

namespace rigproof {

struct IntegrityProblem {
  enum class Kind { kMissing, kAltered, kExtra, kUnreadable, kUnfinished };
  Kind kind = Kind::kMissing;
  std::string file;     ///< relative to the run; empty for kUnfinished
  std::string message;  ///< in words: "truncated: 1,200 bytes of 4,096"
  /// "recording/left/color/000003.png: missing".
  std::string text() const;
};

struct IntegrityReport {
  std::size_t files = 0;    ///< that the manifest lists
  std::uint64_t bytes = 0;  ///< that were read
  std::string gl_renderer;  ///< of the manifest
  std::string tool_version;
  std::vector<IntegrityProblem> problems;  ///< sorted by file
  bool intact() const { return problems.empty(); }
  /// "300 files, 412 MB: all as generated", or one line a kind and the first files of each.
  std::string text() const;
};

/// Compares every file of recording/ and truth/ with the size and SHA-256 that run.yaml lists. truth/proof.yaml, which
/// is made later, need not be listed. Throws Error if there is no readable manifest.
IntegrityReport verify_manifest(const RunFolder& run);

}  // namespace rigproof
