// What `report` and `run` share: writing the report with a line of progress.
#pragma once

#include <filesystem>

#include "rigproof/study/report/page.h"
#include "terminal.h"

namespace rigproof {

inline constexpr const char* kReportName = "report.html";

/// Writes the file and says where it is.
void write_report(const InspectInput& scene, const std::filesystem::path& file, PageOptions options,
                  const Terminal& terminal);

}  // namespace rigproof
