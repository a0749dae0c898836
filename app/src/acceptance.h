// What `calibrate` and `run` share: gates that need no truth.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "rigproof/calib/plan/accept.h"
#include "rigproof/formats/format.h"
#include "rigproof/validate/report_files.h"
#include "terminal.h"

namespace rigproof {

/// Criteria by file or by the name of shipped ones ("default"). Throws Error.
AcceptCriteria accept_criteria_of(const std::string& file_or_name);

/// What results have to meet.
struct Gates {
  AcceptCriteria criteria;
  bool asked_for = false;  ///< by --accept, not by the rig alone
};

/// The criteria that the user named (empty: none), and the limits of the rig's `accept` key, which take the place of
/// theirs on uncertainty. Absent: there are neither. Throws Error.
std::optional<Gates> gates_for(const std::string& file_or_name, const std::optional<AcceptLimits>& of_rig);

/// The limits of the rig that the input is of.
std::optional<AcceptLimits> accepted_by_rig(const Input& input);

/// Applies the gates and prints them. Absent where only the rig limits the uncertainty and the method states none,
/// which is said.
std::optional<AcceptReport> judge_acceptance(const Terminal& terminal, const Method& method, const Result& result,
                                             const Observations& observations, const Gates& gates);

/// The gates, as they stand under `acceptance` of a result.
nlohmann::json json_of(const AcceptReport& report, const AcceptCriteria& criteria);

/// The gates as the JUnit writer takes them.
ValidationRecord acceptance_record(const Result& result, const AcceptReport& report, const AcceptCriteria& criteria);

}  // namespace rigproof
