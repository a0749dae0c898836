#include <algorithm>
#include <array>
#include <cmath>

#include "rigproof/core/figures.h"
#include "rigproof/core/text.h"
#include "rigproof/validate/explanation.h"
#include "rigproof/validate/format.h"
#include "rigproof/validate/text_table.h"
#include "said.h"

namespace rigproof {
namespace {

constexpr int kMaxDecimals = 5;
constexpr int kMaxDigits = 6;  // before and after the point together

struct Column {
  std::vector<double> errors;
  std::vector<double> sigmas;
};

Column column_of(const std::vector<TransformError>& errors, int axis) {
  Column column;
  for (const TransformError& error : errors) {
    if (!error.observable[static_cast<std::size_t>(axis)]) continue;
    column.errors.push_back(std::abs(in_unit(error.error[axis], axis)));
    if (error.sigma) column.sigmas.push_back(in_unit((*error.sigma)[axis], axis));
  }
  return column;
}

// As many decimals as the smallest stated sigma deserves; without sigmas two digits of the median error.
int decimals_of(Column column) {
  if (column.errors.empty()) return 0;
  std::sort(column.errors.begin(), column.errors.end());
  int decimals = decimals_for(column.errors[column.errors.size() / 2], 2, kMaxDecimals);
  if (!column.sigmas.empty())
    decimals = decimals_for_sigma(*std::min_element(column.sigmas.begin(), column.sigmas.end()), kMaxDecimals);
  const double largest = column.errors.back();
  const int before_point = largest >= 1.0 ? static_cast<int>(std::floor(std::log10(largest))) + 1 : 0;
  return std::clamp(decimals, 0, std::max(0, kMaxDigits - before_point));
}

// Where the column's decimals would show zero and nothing says that zero is meant, one digit of its own.
std::string error_text(double error, int decimals, bool has_sigma) {
  const std::string text = signed_figure(error, decimals);
  return text == "0" && !has_sigma ? signed_figure(error, decimals_for(error, 1, kMaxDecimals)) : text;
}

std::string sigma_text(double sigma, int decimals) {
  const std::string text = figure(sigma, decimals);
  return text == "0" ? figure(sigma, decimals_for(sigma, 1, kMaxDecimals)) : text;
}

std::string failing_axes(const TransformError& error, const Gate& gate) {
  std::vector<std::string> axes;
  for (const Check& check : gate.checks) {
    if (check.passed || check.subject != error.name() || check.axis < 0) continue;
    const std::string axis = kDegreeOfFreedomNames[static_cast<std::size_t>(check.axis)];
    if (std::find(axes.begin(), axes.end(), axis) == axes.end()) axes.push_back(axis);
  }
  return axes.empty() ? "ok" : "FAIL " + joined(axes, " ");
}

bool any_sigma(const std::vector<TransformError>& errors) {
  return std::any_of(errors.begin(), errors.end(), [](const TransformError& error) { return error.sigma.has_value(); });
}

// Columns: camera, then error and "+-" sigma for each axis, then the gate's word.
std::vector<std::string> row_of(const TransformError& error, const std::array<int, 6>& decimals, bool sigmas) {
  std::vector<std::string> cells = {error.child};
  for (int axis = 0; axis < 6; ++axis) {
    const int digits = decimals[static_cast<std::size_t>(axis)];
    if (!error.observable[static_cast<std::size_t>(axis)]) {
      cells.push_back("refused");
      if (sigmas) cells.emplace_back();
      continue;
    }
    cells.push_back(error_text(in_unit(error.error[axis], axis), digits, error.sigma.has_value()));
    if (sigmas) cells.push_back(error.sigma ? "+-" + sigma_text(in_unit((*error.sigma)[axis], axis), digits) : "");
  }
  return cells;
}

std::string table_of_errors(const std::vector<TransformError>& errors, const Gate* gate) {
  std::array<int, 6> decimals{};
  for (int axis = 0; axis < 6; ++axis) decimals[static_cast<std::size_t>(axis)] = decimals_of(column_of(errors, axis));
  const bool sigmas = any_sigma(errors), shows_gate = gate != nullptr && !gate->checks.empty();
  std::vector<std::size_t> left = {0};
  std::vector<std::string> gaps = {" "};
  for (int axis = 0; axis < 6; ++axis) {
    gaps.push_back(axis == 3 ? "   " : "  ");
    if (!sigmas) continue;
    left.push_back(gaps.size());
    gaps.emplace_back();
  }
  left.push_back(gaps.size());
  gaps.push_back("   ");
  TextTable table(left);
  for (const TransformError& error : errors) {
    std::vector<std::string> cells = row_of(error, decimals, sigmas);
    if (shows_gate) cells.push_back(failing_axes(error, *gate));
    table.add(std::move(cells));
  }
  // The titles stand over the first column of their group, wherever the numbers put it.
  return table.text_below(sigmas ? "error +- stated sigma" : "error",
                          {{1, "tx ty tz [cm]"}, {sigmas ? 7 : 4, "rx ry rz [deg]"}}, gaps);
}

// The cameras share their error if between them a fifth of it is left, in what the error mainly is.
bool cameras_share_error(const Comparison& comparison) {
  constexpr double kFraction = 0.2;
  const bool metres_shared = comparison.worst_between_m() < kFraction * worst_error(comparison.camera_to_robot, false);
  const bool radians_shared =
      comparison.worst_between_rad() < kFraction * worst_error(comparison.camera_to_robot, true);
  return comparison.camera_to_robot.size() > 1 && metres_shared && radians_shared;
}

// Along z the cameras can only share what the ground says, otherwise what the odometry says.
Finding shared_error(const Comparison& comparison) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const TransformError& error : comparison.camera_to_robot) sum += error.error.head<3>();
  const bool is_vertical = std::abs(sum.z()) > sum.head<2>().norm();
  return Finding("errors.shared",
                 source_of_shared(comparison, is_vertical ? std::vector<int>{2} : std::vector<int>{0, 1}));
}

const TransformError& worst_pair(const Comparison& comparison) {
  // Ten centimetres weigh as much as a tenth of a radian.
  return *std::max_element(comparison.camera_to_camera.begin(), comparison.camera_to_camera.end(),
                           [](const auto& a, const auto& b) { return a.error.norm() < b.error.norm(); });
}

std::string between_cameras(const Comparison& comparison, const Wording& wording) {
  if (comparison.camera_to_camera.empty()) return "";
  const std::string shared = cameras_share_error(comparison) ? said(shared_error(comparison), wording) + " " : "";
  const std::string which =
      comparison.camera_to_camera.size() > 1 && shared.empty() ? " (" + worst_pair(comparison).name() + ")" : "";
  return " " + shared + "Between cameras: worst " + short_figure(100.0 * comparison.worst_between_m()) + " cm, " +
         short_figure(rad_to_deg(comparison.worst_between_rad())) + " deg" + which + ".\n";
}

std::string reasons_of(const Comparison& comparison, const Wording& wording) {
  std::string text;
  for (const Finding& reason : comparison.reasons) text += " " + said(reason, wording) + "\n";
  return text;
}

}  // namespace

std::string format_errors(const Comparison& comparison, const Gate* gate, const Wording& wording) {
  std::string text;
  if (comparison.status == ResultStatus::kRefused) text += "REFUSED\n" + reasons_of(comparison, wording);
  if (comparison.status == ResultStatus::kPartial) text += "PARTIAL\n" + reasons_of(comparison, wording);
  if (!comparison.camera_to_robot.empty()) text += table_of_errors(comparison.camera_to_robot, gate);
  if (!comparison.missing_cameras.empty()) text += " No pose of " + joined(comparison.missing_cameras) + ".\n";
  return text + between_cameras(comparison, wording);
}

}  // namespace rigproof
