// Contradictions in a solution, and their likely cause.
#pragma once

#include <optional>
#include <vector>

#include "contradictions.h"
#include "diagnosis.h"
#include "rigproof/calib/diagnose/observability.h"
#include "rigproof/calib/estimate/fit.h"
#include "rigproof/calib/estimate/odometry_rows.h"

namespace rigproof::ml {

struct Examination {
  std::vector<MotionVerdict> motions;  ///< of each camera, by what those saw that boards tie to it
  std::optional<GroupSums> sums;       ///< with leverage; absent where the poses are not determined
  Contradictions contradictions;
  Symptoms symptoms;
  bool upside_down = false;
  std::optional<LensTest> lenses;
  std::optional<Cause> cause;
  std::vector<Finding> wrong_frames;
  std::vector<Finding> notes;
  /// If the motion does not determine the mounting, the solution is one of many: its residuals accuse no lens and no
  /// frame.
  bool motion_suffices() const { return motion().kind == MotionKind::kSufficient; }
  /// Of the rig: one that suffices, if that of any camera does.
  const MotionVerdict& motion() const;
  /// Whether data contradict each other, for whatever cause.
  bool contradicts() const;
  /// Nothing contradicts itself, and nothing is suspected but slight movements.
  bool is_in_order() const;
  bool lens_spoils() const { return cause && cause->spoils_all; }
};

Examination examine(const Preparation& prepared, const Fit& fit);

/// Of what could be excused, as images that shake or as depth of another shape: images that are mirrored or of another
/// camera, if these leave no shaking to excuse.
std::optional<Cause> cause_without_excuses(const Preparation& prepared, const Fit& fit);

}  // namespace rigproof::ml
