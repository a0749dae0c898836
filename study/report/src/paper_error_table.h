// A table of mean errors by method beside the published rows, success first.
#pragma once

#include <string>
#include <vector>

#include "paper_samples.h"
#include "rigproof/study/report/paper.h"

namespace rigproof::paper {

/// ".061", "-" where there is none.
std::string cell(const std::optional<double>& value);
/// "9/10" tasks.
std::string success_cell(const Sample& sample);
/// Two words, and the axes with their units.
std::vector<std::string> head_of_axes(const std::string& what, const std::string& count);

/// What the column `success` counts and which answers the errors are of; below every table.
std::string success_note();
/// "far off: opencv_tsai 30 of 30 answers"; empty if no method's is.
std::string far_note(const std::vector<std::pair<std::string, Sample>>& samples);

/// Of one condition; `synthetic` chooses the published table. Methods that say nothing of the subject are named below.
PaperTable error_table(const SweepRows& rows, const Condition& condition, SweepSubject subject, bool synthetic,
                       const std::string& title);

}  // namespace rigproof::paper
