// What `validate` and `run` share.
#pragma once

#include <filesystem>
#include <vector>

#include "rigproof/validate/budget.h"
#include "rigproof/validate/report_files.h"

namespace rigproof {

/// A budget by file or by the name of a shipped one ("ci"); the default one for an empty path.
Budget budget_of(const std::filesystem::path& file);

bool all_passed(const std::vector<ValidationRecord>& records);

}  // namespace rigproof
