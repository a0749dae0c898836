// What the command line of `export` says of single cameras.
#pragma once

#include "export_command.h"
#include "rigproof/core/result.h"
#include "rigproof/study/export/export.h"

namespace rigproof {

/// The options with [CAMERA=]VALUE taken apart. Throws Error with every problem.
ExportOptions export_options(const ExportArguments& arguments, const Result& result);

}  // namespace rigproof
