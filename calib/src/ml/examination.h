// What in a solution contradicts itself, and the likely cause of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ml/contradictions.h"
#include "ml/diagnosis.h"
#include "ml/fit.h"
#include "ml/odometry_rows.h"

namespace rigproof::ml {

struct Examination {
  std::optional<GroupSums> sums;  ///< with leverage; absent where the poses are not determined
  Contradictions contradictions;
  Symptoms symptoms;
  std::vector<WildRow> wild_rows;
  bool upside_down = false;
  std::optional<LensTest> lenses;
  std::optional<Cause> cause;
  std::vector<std::string> wrong_frames;  ///< sentences
  std::vector<std::string> notes;
  bool lens_spoils() const { return cause && cause->spoils_all; }
};

Examination examine(const Preparation& prepared, const Fit& fit);

}  // namespace rigproof::ml
