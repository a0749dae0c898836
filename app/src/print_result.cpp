#include "print_result.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "rigproof/core/conventions.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/validate/body_angles.h"

namespace rigproof {
namespace {

std::string fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

// Roll, pitch, yaw [rad] of a camera's body axes.
Eigen::Vector3d body_roll_pitch_yaw(const Eigen::Quaterniond& rotation_robot_camera) {
  return roll_pitch_yaw(rotation_robot_camera * optical_from_body());
}

// Six standard deviations: translation [m], then roll, pitch, yaw [rad], carried over from the rotation error along
// the parent's axes by central differences; 0 = none stated.
Vector6d stated_sigmas(const EstimatedTransform& transform) {
  Vector6d sigmas = Vector6d::Zero();
  if (!transform.covariance) return sigmas;
  const Matrix6d& covariance = *transform.covariance;
  Eigen::Matrix3d J;
  constexpr double kStep = 1e-6;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
    const Eigen::Vector3d up = body_roll_pitch_yaw(so3_exp(step) * transform.T_parent_child.rotation);
    const Eigen::Vector3d down = body_roll_pitch_yaw(so3_exp(-step) * transform.T_parent_child.rotation);
    for (int i = 0; i < 3; ++i) J(i, axis) = wrap_angle(up(i) - down(i)) / (2.0 * kStep);
  }
  const Eigen::Matrix3d angles = J * covariance.bottomRightCorner<3, 3>() * J.transpose();
  for (int i = 0; i < 3; ++i) {
    sigmas(i) = std::sqrt(std::max(0.0, covariance(i, i)));
    sigmas(i + 3) = std::sqrt(std::max(0.0, angles(i, i)));
  }
  return sigmas;
}

std::vector<std::string> pose_cells(const EstimatedTransform& transform) {
  const Eigen::Vector3d angles = body_roll_pitch_yaw(transform.T_parent_child.rotation);
  const Vector6d sigmas = stated_sigmas(transform);
  std::vector<std::string> cells = {" " + transform.child};
  for (int i = 0; i < 6; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    const double scale = i < 3 ? 100.0 : rad_to_deg(1.0);
    const double value = i < 3 ? transform.T_parent_child.translation(i) : angles(i - 3);
    cells.push_back(transform.observable[axis] ? value_with_sigma(scale * value, scale * sigmas(i)) : "-");
  }
  return cells;
}

std::string stop_list(const std::vector<int>& stops) {
  constexpr std::size_t kShown = 6;
  std::string text;
  for (std::size_t i = 0; i < stops.size() && i < kShown; ++i)
    text += (text.empty() ? "" : ", ") + std::to_string(stops[i]);
  if (stops.size() > kShown) text += ", ..";
  return text;
}

// "18 no board, 1 residual 2.4 px (20)": the most frequent reasons first.
std::string reasons_left_out(const std::vector<Exclusion>& left_out) {
  std::map<std::string, std::vector<int>> stops_by_reason;
  for (const Exclusion& exclusion : left_out) stops_by_reason[exclusion.reason].push_back(exclusion.stop);
  std::vector<std::pair<std::string, std::vector<int>>> groups(stops_by_reason.begin(), stops_by_reason.end());
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) { return a.second.size() > b.second.size(); });
  constexpr std::size_t kShown = 3;
  std::string text;
  for (std::size_t i = 0; i < groups.size() && i < kShown; ++i) {
    text += text.empty() ? "" : ", ";
    if (groups.size() > 1) text += std::to_string(groups[i].second.size()) + " ";
    text += groups[i].first;
    if (groups[i].second.size() <= 6) text += " (" + stop_list(groups[i].second) + ")";
  }
  if (groups.size() > kShown) text += ", ..";
  return text;
}

void print_poses(const Terminal& terminal, const Result& result) {
  if (result.camera_to_robot.empty()) return;
  const std::string& parent = result.camera_to_robot.front().parent;
  std::vector<std::vector<std::string>> rows = {
      {"pose in " + parent, "x [cm]", "y", "z", "roll [deg]", "pitch", "yaw"}};
  for (const EstimatedTransform& transform : result.camera_to_robot) rows.push_back(pose_cells(transform));
  for (const std::string& line : aligned(rows)) terminal.line(line);
}

nlohmann::json transform_as_json(const EstimatedTransform& transform) {
  const Eigen::Vector3d& t = transform.T_parent_child.translation;
  const Eigen::Quaterniond& q = transform.T_parent_child.rotation;
  nlohmann::json json = {{"parent", transform.parent}, {"child", transform.child}};
  if (transform.fully_observable()) {
    json["translation_m"] = {t.x(), t.y(), t.z()};
    json["quaternion_xyzw"] = {q.x(), q.y(), q.z(), q.w()};
  }
  for (std::size_t i = 0; i < 6; ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    if (!transform.observable[i]) {
      json["unobservable"].push_back(kDegreeOfFreedomNames[i]);
    } else if (transform.covariance) {
      const std::string unit = i < 3 ? "_m" : "_rad";
      json["sigma"][kDegreeOfFreedomNames[i] + unit] = std::sqrt((*transform.covariance)(index, index));
    }
  }
  return json;
}

}  // namespace

std::string value_with_sigma(double value, double sigma) {
  if (!(sigma > 0.0) || !std::isfinite(sigma)) return fixed(value, 4);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 6);
  return fixed(value, decimals) + "+-" + fixed(sigma, decimals);
}

std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::vector<std::string> lines;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string padding(widths[i] - row[i].size(), ' ');
      line += (i == 0 ? "" : "  ") + (i == 0 ? row[i] + padding : padding + row[i]);
    }
    lines.push_back(line.substr(0, line.find_last_not_of(' ') + 1));
  }
  return lines;
}

void print_use(const Terminal& terminal, const Result& result) {
  std::vector<std::vector<std::string>> rows;
  for (const CameraUse& use : result.use) {
    std::vector<std::string> cells = {" " + use.camera, std::to_string(use.used) + " used"};
    if (!use.left_out.empty())
      cells.push_back(std::to_string(use.left_out.size()) + " left out: " + reasons_left_out(use.left_out));
    rows.push_back(cells);
  }
  // Reasons differ in length: only the first two columns are padded.
  std::vector<std::vector<std::string>> heads;
  for (const auto& row : rows) heads.emplace_back(row.begin(), row.begin() + 2);
  const std::vector<std::string> lines = aligned(heads);
  for (std::size_t i = 0; i < lines.size(); ++i)
    terminal.line(lines[i] + (rows[i].size() > 2 ? "  " + rows[i][2] : ""));
}

void print_result(const Terminal& terminal, const Result& result) {
  print_use(terminal, result);
  print_poses(terminal, result);
  for (const std::string& reason : result.reasons)
    terminal.line(terminal.colored("REFUSED", Color::kBad) + "  " + reason);
  for (const std::string& note : result.notes) terminal.line(terminal.colored("NOTE", Color::kWarning) + "  " + note);
}

std::string result_as_json(const Result& result) {
  nlohmann::json json = {{"method", result.method}, {"status", result_status_name(result.status)}};
  json["reasons"] = result.reasons;
  json["notes"] = result.notes;
  json["camera_to_robot"] = nlohmann::json::array();
  json["camera_to_camera"] = nlohmann::json::array();
  for (const EstimatedTransform& transform : result.camera_to_robot)
    json["camera_to_robot"].push_back(transform_as_json(transform));
  for (const EstimatedTransform& transform : result.camera_to_camera)
    json["camera_to_camera"].push_back(transform_as_json(transform));
  json["use"] = nlohmann::json::array();
  for (const CameraUse& use : result.use) {
    nlohmann::json camera = {{"camera", use.camera}, {"used", use.used}, {"left_out", nlohmann::json::array()}};
    for (const Exclusion& exclusion : use.left_out)
      camera["left_out"].push_back({{"stop", exclusion.stop}, {"file", exclusion.file}, {"reason", exclusion.reason}});
    json["use"].push_back(camera);
  }
  return json.dump(2);
}

}  // namespace rigproof
