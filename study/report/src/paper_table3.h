// Table 3 of the paper, and what a camera that hardly moved does to it.
#pragma once

#include <string>
#include <vector>

#include "paper_samples.h"
#include "rigproof/study/report/paper.h"

namespace rigproof::paper {

/// A camera that saw the board at two stops in a row less often than this is shown apart: a mean over few pairs says
/// how it did, not how the method does. In the shipped sweep one has 7 such motions, all others 17 and more.
inline constexpr int kFewMotions = 10;
bool has_few_motions(const SweepRow& row);
/// "fewer than 10 motions".
std::string few_motions_in_words();

/// The rows of cameras (pairs) that are wanted, and those of the rig in tasks that have any.
SweepRows only(const SweepRows& rows, SweepSubject subject, bool few_motions);

std::vector<PaperTable> tables_of_table3(const SweepRows& rows);

}  // namespace rigproof::paper
