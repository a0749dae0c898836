// What `validate` and `run` share.
#pragma once

#include <vector>

#include "rigproof/validate/report_files.h"

namespace rigproof {

bool all_passed(const std::vector<ValidationRecord>& records);

}  // namespace rigproof
