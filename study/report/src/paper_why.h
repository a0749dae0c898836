// Where MEMROC's error comes from: the authors' chain, then one link after the other replaced, down to `ml`.
#pragma once

#include <string>
#include <vector>

#include "rigproof/study/report/paper.h"

namespace rigproof::paper {

/// For camera to robot and camera to camera, a row for each method in the sweep's order: its mean |error|, and below it
/// what that changed against the one before, with half the 95 % interval of a paired bootstrap over tasks. Notes say
/// what each replaces.
std::vector<PaperTable> tables_of_why(const SweepRows& rows);

/// The same as lines of paper_csv(): figure waterfall, source mean | change | low | high (of the change), x the step,
/// x_title what it replaces.
std::string why_csv(const SweepRows& rows);

}  // namespace rigproof::paper
