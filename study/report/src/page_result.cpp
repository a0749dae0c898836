#include <algorithm>
#include <cmath>
#include <map>

#include "page_parts.h"
#include "rigproof/calib/plan/main_sources.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/exclusions.h"
#include "rigproof/core/figures.h"
#include "rigproof/validate/body_angles.h"
#include "rigproof/validate/statistics.h"
#include "rigproof/words/findings_page.h"
#include "rigproof/words/sentences.h"

namespace rigproof::page_detail {
namespace {

std::string remedy_of(const std::string& code) {
  for (const words::FindingEntry& entry : words::all_findings())
    if (entry.code == code) return entry.remedy;
  return "";
}

}  // namespace

Json findings_list(const std::vector<Finding>& findings) {
  Json list = Json::array();
  for (const Finding& finding : findings)
    list.push_back({{"code", finding.code},
                    {"severity", severity_name(finding.severity)},
                    {"sentence", words::sentence_of(finding)},
                    {"remedy", remedy_of(finding.code)}});
  return list;
}

namespace {

Json sigmas_of(const std::optional<Matrix6d>& covariance) {
  return covariance ? list_of(covariance->diagonal().cwiseMax(0.0).cwiseSqrt()) : Json();
}

Json bound_json(const std::vector<TransformBound>& bounds, const std::string& parent, const std::string& child) {
  for (const TransformBound& bound : bounds) {
    if (bound.parent != parent || bound.child != child) continue;
    Json list = Json::array();
    for (const std::optional<double>& sigma : bound.sigma) list.push_back(sigma ? figure_of(*sigma) : Json());
    return list;
  }
  return nullptr;
}

// Errors, with what the data allow at best; null without truth.
void add_errors(const std::vector<TransformError>& errors, const std::string& parent, const std::string& child,
                Json* json) {
  (*json)["error"] = nullptr;
  for (const TransformError& error : errors) {
    if (error.child != child || (error.between_cameras && error.parent != parent)) continue;
    (*json)["error"] = list_of(error.error);
    if (error.sigma) (*json)["sigma"] = list_of(*error.sigma);
    (*json)["observable"] = error.observable;
    (*json)["T_estimate"] = pose_of(error.T_estimate);
  }
}

Json budget_json(const EstimatedTransform& transform) {
  Json list = Json::array();
  for (const EstimatedTransform::Share& share : transform.budget)
    list.push_back({{"source", share.source}, {"share", Json::array()}});
  for (std::size_t i = 0; i < transform.budget.size(); ++i)
    for (const double value : transform.budget[i].share) list[i]["share"].push_back(rounded(value, 5));
  return list;
}

Json transform_json(const EstimatedTransform& stated) {
  const EstimatedTransform transform = heading_free(stated);
  Json json = {{"parent", transform.parent}, {"child", transform.child}};
  json["T"] = transform.fully_observable() ? pose_of(transform.T_parent_child) : Json();
  json["observable"] = transform.observable;
  json["sigma"] = sigmas_of(transform.covariance);
  json["budget"] = budget_json(transform);
  return json;
}

}  // namespace

Json pose_json(const EstimatedTransform& stated) {
  const EstimatedTransform transform = heading_free(stated);
  Json json = transform_json(stated);
  Vector6d values;
  values << transform.T_parent_child.translation, camera_roll_pitch_yaw(transform.T_parent_child.rotation);
  json["values"] = list_of(values);
  json["value_sigmas"] = transform.covariance ? list_of(pose_sigmas(transform)) : Json();
  json["place_covariance"] = nullptr;
  if (transform.covariance) {
    const Eigen::Matrix3d C = transform.covariance->topLeftCorner<3, 3>();
    json["place_covariance"] = list_of(Eigen::Map<const Eigen::Matrix<double, 9, 1>>(C.data()));
  }
  return json;
}

namespace {

Json left_out_json(const std::vector<Exclusion>& left_out) {
  Json list = Json::array();
  for (const bool depth : {false, true})
    for (const words::ReasonGroup& group : words::by_reason(of_depth(left_out, depth)))
      list.push_back({{"reason", group.reason}, {"stops", group.stops}, {"depth", depth}});
  return list;
}

Json use_json(const Result& result) {
  Json list = Json::array();
  for (const CameraUse& use : result.use)
    list.push_back({{"camera", use.camera},
                    {"used", use.used},
                    {"reprojection_rms_px", figure_of(use.reprojection_rms_px)},
                    {"left_out", left_out_json(use.left_out)}});
  return list;
}

Json also_json(const Result& result) {
  Json list = Json::array();
  for (const EstimatedQuantity& quantity : result.also_estimated)
    list.push_back({{"camera", quantity.camera},
                    {"name", quantity.name},
                    {"value", figure_of(quantity.value)},
                    {"sigma", figure_of(quantity.sigma)},
                    {"prior_sigma", figure_of(quantity.prior_sigma)}});
  return list;
}

Json nees_json(const Comparison& comparison) {
  if (!comparison.nees) return nullptr;
  const Interval interval = chi_square_interval(comparison.nees_degrees_of_freedom);
  const std::string within = figure(interval.low, 1) + "-" + figure(interval.high, 1);
  return {{"value", figure_of(*comparison.nees)},
          {"degrees_of_freedom", comparison.nees_degrees_of_freedom},
          {"low", figure_of(interval.low)},
          {"high", figure_of(interval.high)},
          {"as_in_verdict", {{"value", figure(*comparison.nees, 1)}, {"within", within}}}};
}

// Frames that this method leaves out besides those that observing did, by the frame's number.
Json left_out_frames(const Observations& observations, const Result& result, const std::vector<Frame>& frames) {
  std::map<std::pair<std::string, std::string>, const Exclusion*> known;
  for (const CameraUse& use : result.use)
    for (const Exclusion& exclusion : use.left_out)
      if (!exclusion.depth) known[{use.camera, exclusion.file + "#" + std::to_string(exclusion.stop)}] = &exclusion;
  Json json = Json::object();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::string& camera = observations.cameras[static_cast<std::size_t>(frames[i].camera)].name;
    const auto found = known.find({camera, frames[i].file + "#" + std::to_string(frames[i].stop)});
    if (frames[i].left_out || found == known.end()) continue;
    json[std::to_string(i)] = {{"code", found->second->why.code}, {"sentence", words::sentence_of(found->second->why)}};
  }
  return json;
}

Json corners_json(const Observations& observations, const CornerFit& fit, const std::vector<Frame>& frames) {
  Json differences = Json::array();
  for (const Frame& frame : frames) {
    const auto index = static_cast<std::size_t>(frame.view - observations.board_views.data());
    if (frame.view == nullptr || fit.differences[index].empty()) {
      differences.push_back(nullptr);
      continue;
    }
    Json list = Json::array();
    for (const Eigen::Vector2d& difference : fit.differences[index])
      for (const double value : {difference.x(), difference.y()}) list.push_back(rounded(value, 4));
    differences.push_back(std::move(list));
  }
  return {{"corners", fit.corners}, {"boards", fit.boards}, {"differences", std::move(differences)}};
}

Json verdict_json(const PageVerdict& verdict) {
  return {{"level", verdict.level}, {"word", verdict.word}, {"sentence", verdict.sentence}, {"why", verdict.why}};
}

}  // namespace

Json result_json(const InspectInput& input, const Result& result, const std::vector<Frame>& frames,
                 const std::vector<TransformBound>& bounds, const PageOptions& options) {
  std::optional<Comparison> comparison;
  if (input.truth) {
    comparison = compare(result, *input.truth);
    comparison->bound = largest_of(bounds);
  }
  const CornerFit fit = fit_corners(input.observations, result);
  Json json = {{"method", result.method}, {"status", result_status_name(result.status)}};
  json["verdict"] = verdict_json(verdict_of(result, comparison, options.budget, input.observations, fit));
  json["poses"] = Json::array();
  for (const EstimatedTransform& transform : result.camera_to_robot) {
    Json pose = pose_json(transform);
    add_errors(comparison ? comparison->camera_to_robot : std::vector<TransformError>(), transform.parent,
               transform.child, &pose);
    pose["bound"] = bound_json(bounds, "robot", transform.child);
    json["poses"].push_back(std::move(pose));
  }
  json["pairs"] = Json::array();
  for (const EstimatedTransform& transform : result.camera_to_camera) {
    Json pair = transform_json(transform);
    add_errors(comparison ? comparison->camera_to_camera : std::vector<TransformError>(), transform.parent,
               transform.child, &pair);
    pair["bound"] = bound_json(bounds, transform.parent, transform.child);
    json["pairs"].push_back(std::move(pair));
  }
  json["nees"] = comparison ? nees_json(*comparison) : Json();
  json["reasons"] = findings_list(result.reasons);
  json["notes"] = findings_list(result.notes);
  json["sources"] = words::sentences_of(main_sources(result));
  json["use"] = use_json(result);
  json["residuals"] = Json::array();
  for (const ResidualSummary& group : result.residuals)
    json["residuals"].push_back(
        {{"name", group.name}, {"unit", group.unit}, {"count", group.count}, {"rms", figure_of(group.rms)}});
  json["also_estimated"] = also_json(result);
  json["left_out_frames"] = left_out_frames(input.observations, result, frames);
  json["corner_fit"] = corners_json(input.observations, fit, frames);
  return json;
}

}  // namespace rigproof::page_detail
