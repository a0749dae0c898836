#include "answer.h"

#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

using nlohmann::json;

constexpr const char* kFormat = "rigproof-sweep-answer 2";
constexpr const char* kFormatBefore = "rigproof-sweep-answer 1";  // reasons in words, in each row

json json_of(const std::optional<double>& value) { return value ? json(*value) : json(nullptr); }

template <std::size_t N>
json json_of(const std::array<std::optional<double>, N>& values) {
  json list = json::array();
  for (const std::optional<double>& value : values) list.push_back(json_of(value));
  return list;
}

std::optional<double> optional_of(const json& value) {
  return value.is_null() ? std::nullopt : std::optional<double>(value.get<double>());
}

template <std::size_t N>
void read(const json& list, std::array<std::optional<double>, N>* values) {
  for (std::size_t i = 0; i < N; ++i) (*values)[i] = optional_of(list.at(i));
}

json json_of(const SweepRow& row) {
  return {{"subject", static_cast<int>(row.subject)},
          {"camera", row.camera},
          {"status", static_cast<int>(row.status)},
          {"error", json_of(row.error)},
          {"sigma", json_of(row.sigma)},
          {"bound", json_of(row.bound)},
          {"rpy", json_of(row.roll_pitch_yaw)},
          {"nees", json_of(row.nees)},
          {"nees_dof", row.nees_degrees_of_freedom},
          {"motions", row.motions ? json(*row.motions) : json(nullptr)}};
}

SweepRow row_of(const json& object) {
  SweepRow row;
  const int subject = object.at("subject").get<int>();
  if (subject < 0 || subject > static_cast<int>(SweepSubject::kPair)) throw std::out_of_range("subject");
  row.subject = static_cast<SweepSubject>(subject);
  row.status = sweep_status_of(object.at("status").get<int>());
  row.camera = object.at("camera").get<std::string>();
  read(object.at("error"), &row.error);
  read(object.at("sigma"), &row.sigma);
  read(object.at("bound"), &row.bound);
  read(object.at("rpy"), &row.roll_pitch_yaw);
  row.nees = optional_of(object.at("nees"));
  row.nees_degrees_of_freedom = object.at("nees_dof").get<int>();
  // Answers of version 0.1 have none.
  if (object.contains("motions") && !object["motions"].is_null()) row.motions = object["motions"].get<int>();
  return row;
}

// Those of all rows that are not solved.
std::vector<Finding> shared_reasons(const SweepAnswer& answer) {
  for (const SweepRow& row : answer.rows)
    if (!row.reasons.empty()) return row.reasons;
  return {};
}

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

// As Linux names it on most machines; empty elsewhere.
std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  const std::string key = "model name";
  for (std::string line; std::getline(in, line);)
    if (line.rfind(key, 0) == 0) return line.substr(line.find(':') + 2);
  return "";
}

}  // namespace

SweepStatus sweep_status_of(int number) {
  if (number < 0 || number > static_cast<int>(SweepStatus::kFailed)) throw std::out_of_range("status");
  return static_cast<SweepStatus>(number);
}

json json_of(const SweepMachine& machine) { return {machine.host, machine.cpu, machine.gl_renderer}; }

SweepMachine machine_of(const json& list) {
  return {list.at(0).get<std::string>(), list.at(1).get<std::string>(), list.at(2).get<std::string>()};
}

json reasons_json(const std::vector<Finding>& reasons) { return json::parse(findings_json(reasons)); }

std::vector<Finding> reasons_of(const json& list) {
  return list.empty() ? std::vector<Finding>() : findings_of_json(list.dump());
}

std::vector<Finding> reasons_of_before(const std::string& code, const std::string& sentences) {
  if (sentences.empty()) return {};
  const Finding told = stated(sentences, Severity::kRefusal);
  return {code.empty() ? told : told.with({{"code", code}})};
}

const SweepMachine& this_machine() {
  static const SweepMachine machine = {host_name(), processor_name(), {}};
  return machine;
}

std::string text_of(const SweepAnswer& answer) {
  json rows = json::array();
  for (const SweepRow& row : answer.rows) rows.push_back(json_of(row));
  const json object = {
      {"format", kFormat},
      {"method_hash", answer.method_hash},
      {"reasons", reasons_json(shared_reasons(answer))},
      {"rows", rows},
      {"times",
       {{"solve_s", answer.times.solve_s}, {"cpu_s", answer.times.cpu_s}, {"observe_s", answer.times.observe_s}}},
      {"machine", json_of(answer.machine)}};
  // What a program printed may be no UTF-8.
  return object.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
}

std::optional<SweepAnswer> read_answer(const std::string& text) {
  try {
    const json object = json::parse(text);
    const bool is_before = object.at("format") == kFormatBefore;
    if (!is_before && object.at("format") != kFormat) return std::nullopt;
    SweepAnswer answer;
    answer.method_hash = object.at("method_hash").get<std::string>();
    const std::vector<Finding> reasons = is_before ? std::vector<Finding>() : reasons_of(object.at("reasons"));
    for (const json& row : object.at("rows")) {
      answer.rows.push_back(row_of(row));
      if (is_before)
        answer.rows.back().reasons = reasons_of_before(row.value("code", ""), row.at("reason"));
      else if (answer.rows.back().status != SweepStatus::kSolved)
        answer.rows.back().reasons = reasons;
    }
    if (answer.rows.empty() || answer.rows.front().subject != SweepSubject::kRig) return std::nullopt;
    const json& times = object.at("times");
    answer.times = {times.at("solve_s").get<double>(), times.at("cpu_s").get<double>(),
                    times.at("observe_s").get<double>()};
    if (object.contains("machine")) answer.machine = machine_of(object["machine"]);
    return answer;
  } catch (const json::exception&) {
    return std::nullopt;
  } catch (const std::out_of_range&) {
    return std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace rigproof
