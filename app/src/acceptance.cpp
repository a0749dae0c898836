#include "acceptance.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "print_result.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/figures.h"
#include "rigproof/words/sentences.h"

namespace rigproof {
namespace {

// Lengths in centimetres, as in every table.
std::string with_unit(double value, const std::string& unit, std::string (*figure)(double)) {
  if (unit == "mm") return figure(0.1 * value) + " cm";
  return figure(value) + (unit.empty() ? "" : " " + unit);
}

// Empty where there is a value.
std::string reason_of(const AcceptCheck& check) { return check.reason ? words::sentence_of(*check.reason) : ""; }

void print_acceptance(const Terminal& terminal, const AcceptReport& report, const AcceptCriteria& criteria) {
  const std::string counts =
      std::to_string(report.checks.size() - report.failures()) + "/" + std::to_string(report.checks.size());
  terminal.line(report.passed() ? terminal.colored("ACCEPTED", Color::kGood) + "  " + counts + " gates"
                                : terminal.colored("REJECTED", Color::kBad) + "  " + counts + " gates");
  std::vector<std::vector<std::string>> rows = {{"accept " + criteria.name, "value", "limit", ""}};
  for (const AcceptCheck& check : report.checks)
    rows.push_back({" " + check.name, !check.reason ? with_unit(check.value, check.unit, short_figure) : "-",
                    with_unit(check.limit, check.unit, plain_figure), check.passed ? "ok" : "FAIL"});
  const std::vector<std::string> lines = aligned(rows);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string reason = i == 0 ? "" : reason_of(report.checks[i - 1]);
    terminal.line(lines[i] + (reason.empty() ? "" : "  " + reason));
  }
  for (const std::string& note : words::sentences_of(report.notes)) terminal.line(" " + note);
}

bool states_no_uncertainty(const Result& result) {
  const auto stated = [](const EstimatedTransform& transform) { return transform.covariance.has_value(); };
  return !result.camera_to_robot.empty() &&
         std::none_of(result.camera_to_robot.begin(), result.camera_to_robot.end(), stated);
}

}  // namespace

AcceptCriteria accept_criteria_of(const std::string& file_or_name) {
  return load_accept_criteria(find_config_file("accept", file_or_name));
}

std::optional<Gates> gates_for(const std::string& file_or_name, const std::optional<AcceptLimits>& of_rig) {
  Gates gates;
  gates.asked_for = !file_or_name.empty();
  if (!gates.asked_for && !of_rig) return std::nullopt;
  if (gates.asked_for) gates.criteria = accept_criteria_of(file_or_name);
  if (of_rig) {
    gates.criteria.name += gates.asked_for ? ", limits of the rig" : "limits of the rig";
    gates.criteria.uncertainty = of_rig;
  }
  return gates;
}

std::optional<AcceptLimits> accepted_by_rig(const Input& input) {
  return input.recording ? input.recording->rig.accept : input.observations->accept;
}

std::optional<AcceptReport> judge_acceptance(const Terminal& terminal, const Method& method, const Result& result,
                                             const Observations& observations, const Gates& gates) {
  if (!gates.asked_for && states_no_uncertainty(result)) {
    terminal.line(terminal.colored("NOTE", Color::kWarning) + "     " + result.method +
                  " states no uncertainty: the limits of the rig (accept) cannot be checked.");
    return std::nullopt;
  }
  AcceptReport report = check_acceptance(method, result, observations, gates.criteria);
  print_acceptance(terminal, report, gates.criteria);
  return report;
}

nlohmann::json json_of(const AcceptReport& report, const AcceptCriteria& criteria) {
  nlohmann::json acceptance = {{"criteria", criteria.name},
                               {"passed", report.passed()},
                               {"notes", json_of(report.notes)},
                               {"checks", nlohmann::json::array()}};
  for (const AcceptCheck& check : report.checks) {
    const bool has_value = !check.reason;
    acceptance["checks"].push_back({{"name", check.name},
                                    {"passed", check.passed},
                                    {"value", has_value ? nlohmann::json(check.value) : nlohmann::json(nullptr)},
                                    {"limit", check.limit},
                                    {"unit", check.unit},
                                    {"code", has_value ? "" : check.reason->code},
                                    {"reason", reason_of(check)}});
  }
  return acceptance;
}

ValidationRecord acceptance_record(const Result& result, const AcceptReport& report, const AcceptCriteria& criteria) {
  ValidationRecord record;
  record.subject = result.method + " accept";
  record.comparison.method = result.method;
  record.comparison.status = result.status;
  record.comparison.reasons = result.reasons;
  record.budget.name = criteria.name;
  for (const AcceptCheck& gate : report.checks) {
    Check check;
    check.name = check.subject = gate.name;
    check.passed = gate.passed;
    check.value = gate.value;
    check.limit = gate.limit;
    check.unit = gate.unit;
    check.reason = gate.reason;
    record.gate.checks.push_back(std::move(check));
  }
  return record;
}

}  // namespace rigproof
