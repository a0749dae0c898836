// What `calibrate` and `run` share: gates that need no truth.
#pragma once

#include <string>
#include <vector>

#include "rigproof/calib/accept.h"
#include "rigproof/validate/report_files.h"
#include "terminal.h"

namespace rigproof {

/// Criteria by file or by the name of shipped ones ("default"). Throws Error.
AcceptCriteria accept_criteria_of(const std::string& file_or_name);

/// One row a gate and camera: value, limit, verdict; then the verdict of all.
void print_acceptance(const Terminal& terminal, const AcceptReport& report, const AcceptCriteria& criteria);

/// A result's JSON document with the gates under `acceptance`.
std::string with_acceptance(const std::string& result_json, const AcceptReport& report, const AcceptCriteria& criteria);

/// The gates as the JUnit writer takes them.
ValidationRecord acceptance_record(const Result& result, const AcceptReport& report, const AcceptCriteria& criteria);

}  // namespace rigproof
