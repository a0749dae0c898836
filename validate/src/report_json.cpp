#include <algorithm>
#include <nlohmann/json.hpp>

#include "rigproof/core/conventions.h"
#include "rigproof/core/version.h"
#include "rigproof/validate/body_angles.h"
#include "rigproof/validate/report_files.h"
#include "rigproof/validate/statistics.h"
#include "said.h"

namespace rigproof {
namespace {

using Json = nlohmann::ordered_json;

Json list_of(const Vector6d& values) { return std::vector<double>(values.data(), values.data() + values.size()); }

template <typename T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json z_scores(const TransformError& error) {
  Json list = Json::array();
  for (int axis = 0; axis < 6; ++axis) list.push_back(or_null(error.z(axis)));
  return list;
}

Json json_of(const TransformError& error) {
  const Eigen::Vector3d angles = roll_pitch_yaw_error(error.T_estimate, error.T_true, error.between_cameras);
  Json json;
  json["parent"] = error.parent;
  json["child"] = error.child;
  json["error_m_rad"] = list_of(error.error);
  json["sigma_m_rad"] = error.sigma ? list_of(*error.sigma) : Json(nullptr);
  json["z"] = z_scores(error);
  json["observable"] = error.observable;
  json["roll_pitch_yaw_error_rad"] = {angles.x(), angles.y(), angles.z()};
  return json;
}

Json json_of(const Check& check, const Wording& wording) {
  Json json;
  json["name"] = check.name;
  json["passed"] = check.passed;
  json["value"] = check.unit.empty() ? Json(nullptr) : Json(check.value);
  json["limit"] = check.unit.empty() ? Json(nullptr) : Json(check.limit);
  json["unit"] = check.unit;
  json["code"] = check.reason ? check.reason->code : "";
  json["reason"] = check.reason ? check.message(wording) : "";
  return json;
}

template <typename T, typename... More>
Json json_of(const std::vector<T>& values, const More&... more) {
  Json list = Json::array();
  for (const T& value : values) list.push_back(json_of(value, more...));
  return list;
}

Json nees_of(const Comparison& comparison) {
  Json json;
  json["all"] = or_null(comparison.nees);
  json["degrees_of_freedom"] = comparison.nees_degrees_of_freedom;
  if (comparison.nees) {
    const Interval interval = chi_square_interval(comparison.nees_degrees_of_freedom);
    json["interval_95"] = {interval.low, interval.high};
  }
  json["cameras"] = Json::object();
  for (const CameraNees& camera : comparison.camera_nees) json["cameras"][camera.camera] = camera.nees;
  return json;
}

Json list_of(const std::vector<Finding>& findings, const Wording& wording) {
  return Json::parse(findings_json(findings, wording));
}

Json suspicion_of(const Comparison& comparison, const Wording& wording) {
  if (!comparison.suspicion) return nullptr;
  Json json;
  json["explanation"] = said(comparison.suspicion->convention, wording);
  json["conventions"] = list_of({comparison.suspicion->convention}, wording);
  json["error_m"] = comparison.suspicion->error_now_m;
  json["error_rad"] = comparison.suspicion->error_now_rad;
  json["error_if_corrected_m"] = comparison.suspicion->error_if_corrected_m;
  json["error_if_corrected_rad"] = comparison.suspicion->error_if_corrected_rad;
  return json;
}

Json json_of(const ValidationRecord& record, const Wording& wording) {
  const Comparison& comparison = record.comparison;
  const std::optional<Explanation> explanation = explain_failures(comparison, record.budget);
  Json json;
  json["subject"] = record.subject;
  json["method"] = comparison.method;
  json["status"] = result_status_name(comparison.status);
  json["reasons"] = list_of(comparison.reasons, wording);
  json["passed"] = record.gate.passed();
  json["budget"] = {{"name", record.budget.name}, {"limits", describe(record.budget)}};
  json["degrees_of_freedom"] = kDegreeOfFreedomNames;
  json["camera_to_robot"] = json_of(comparison.camera_to_robot);
  json["camera_to_camera"] = json_of(comparison.camera_to_camera);
  json["missing_cameras"] = comparison.missing_cameras;
  json["nees"] = nees_of(comparison);
  json["convention_suspicion"] = suspicion_of(comparison, wording);
  json["explanation"] = explanation ? Json(said(explanation->cause, wording)) : Json(nullptr);
  json["causes"] = explanation ? list_of({explanation->cause}, wording) : Json::array();
  json["checks"] = json_of(record.gate.checks, wording);
  json["notes"] = list_of(record.gate.notes, wording);
  return json;
}

}  // namespace

std::string to_json(const std::vector<ValidationRecord>& records, const Wording& wording) {
  Json json;
  json["tool"] = "rigproof";
  json["version"] = version();
  json["passed"] = std::all_of(records.begin(), records.end(), [](const auto& r) { return r.gate.passed(); });
  json["results"] = Json::array();
  for (const ValidationRecord& record : records) json["results"].push_back(json_of(record, wording));
  // Names come from files: bytes that are no UTF-8 are replaced, not thrown on.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace rigproof
