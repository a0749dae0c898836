#include "print_result.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "rigproof/calib/plan/main_sources.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/exclusions.h"
#include "rigproof/core/figures.h"
#include "rigproof/core/text.h"
#include "rigproof/validate/body_angles.h"
#include "rigproof/words/sentences.h"

namespace rigproof {
namespace {

// "30.12+-0.09": the sigma to two digits, the value to the same decimals; without sigma four decimals.
std::string value_with_sigma(double value, double sigma) {
  if (!(sigma > 0.0) || !std::isfinite(sigma)) return fixed_text(value, 4);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 6);
  return fixed_text(value, decimals) + "+-" + fixed_text(sigma, decimals);
}

std::vector<std::string> pose_cells(const EstimatedTransform& transform) {
  const Eigen::Vector3d angles = camera_roll_pitch_yaw(transform.T_parent_child.rotation);
  const Vector6d sigmas = pose_sigmas(transform);
  std::vector<std::string> cells = {" " + transform.child};
  for (int i = 0; i < 6; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    const double scale = i < 3 ? 100.0 : rad_to_deg(1.0);
    const double value = i < 3 ? transform.T_parent_child.translation(i) : angles(i - 3);
    cells.push_back(transform.observable[axis] ? value_with_sigma(scale * value, scale * sigmas(i)) : "-");
  }
  return cells;
}

// " (3, 17)", for a few frames that belong to stops.
std::string stop_list(const std::vector<int>& stops) {
  constexpr std::size_t kMost = 6;
  if (stops.size() > kMost || std::find(stops.begin(), stops.end(), -1) != stops.end()) return "";
  std::string text;
  for (const int stop : stops) text += (text.empty() ? "" : ", ") + std::to_string(stop);
  return " (" + text + ")";
}

// "18 no board, 1 residual 2.4 px (20)".
std::string reasons_text(const std::vector<Exclusion>& left_out) {
  constexpr std::size_t kShown = 3;
  const std::vector<words::ReasonGroup> groups = words::by_reason(left_out);
  std::string text;
  for (std::size_t i = 0; i < groups.size() && i < kShown; ++i) {
    text += text.empty() ? "" : ", ";
    if (groups.size() > 1) text += std::to_string(groups[i].stops.size()) + " ";
    text += groups[i].reason + stop_list(groups[i].stops);
  }
  return text + (groups.size() > kShown ? ", .." : "");
}

// "2 left out: board cut off (3, 17)  depth of 1 left out: truncated PNG (5)".
std::string left_out_text(const CameraUse& use) {
  if (use.left_out.empty()) return use.used == 0 ? "no image" : "";
  const std::vector<Exclusion> images = of_depth(use.left_out, false);
  const std::vector<Exclusion> depth = of_depth(use.left_out, true);
  std::string text;
  if (!images.empty()) text = std::to_string(images.size()) + " left out: " + reasons_text(images);
  if (depth.empty()) return text;
  return text + (text.empty() ? "" : "  ") + "depth of " + std::to_string(depth.size()) +
         " left out: " + reasons_text(depth);
}

std::vector<std::string> names_of(const Result& result) {
  std::vector<std::string> names;
  for (const CameraUse& use : result.use) names.push_back(use.camera);
  return names;
}

std::vector<std::string> pose_lines(const Result& result) {
  if (result.camera_to_robot.empty()) return {};
  const std::string& parent = result.camera_to_robot.front().parent;
  std::vector<std::vector<std::string>> rows = {with_axis_heads({"pose in " + parent})};
  for (const EstimatedTransform& transform : result.camera_to_robot) rows.push_back(pose_cells(transform));
  return aligned(rows);
}

// "between cameras: left-center, left-right": the pairs whose six degrees of freedom are known, in spite of a refusal.
std::string pairs_text(const Result& result) {
  std::string text;
  for (const EstimatedTransform& pair : result.camera_to_camera)
    if (pair.fully_observable()) text += (text.empty() ? "between cameras: " : ", ") + pair.parent + "-" + pair.child;
  return text;
}

// "focal_length_percent" as the head of a column: "focal length [percent]".
std::string head_of(const std::string& name) {
  const std::size_t unit = name.rfind('_');
  std::string head = name.substr(0, unit);
  std::replace(head.begin(), head.end(), '_', ' ');
  return unit == std::string::npos ? name : head + " [" + name.substr(unit + 1) + "]";
}

// Lenses and clocks: a line a camera, a column a quantity, of which a camera that is believed has none.
std::vector<std::string> also_estimated_lines(const Result& result) {
  if (result.also_estimated.empty()) return {};
  std::vector<std::string> head = {"also estimated"}, names = {""};
  for (const EstimatedQuantity& quantity : result.also_estimated) {
    if (quantity.camera.empty() || std::find(names.begin(), names.end(), quantity.name) != names.end()) continue;
    names.push_back(quantity.name);
    head.push_back(head_of(quantity.name));
  }
  std::vector<std::vector<std::string>> rows;
  for (const EstimatedQuantity& quantity : result.also_estimated) {
    if (quantity.camera.empty()) continue;
    if (rows.empty() || rows.back().front() != " " + quantity.camera) {
      rows.emplace_back(names.size(), "-");
      rows.back().front() = " " + quantity.camera;
    }
    const auto column = std::find(names.begin(), names.end(), quantity.name) - names.begin();
    rows.back()[static_cast<std::size_t>(column)] = value_with_sigma(quantity.value, quantity.sigma);
  }
  std::vector<std::string> lines;
  if (!rows.empty()) {
    rows.insert(rows.begin(), head);
    lines = aligned(rows);
  }
  for (const EstimatedQuantity& quantity : result.also_estimated)
    if (quantity.camera.empty())
      lines.push_back(" " + head_of(quantity.name) + "  " + value_with_sigma(quantity.value, quantity.sigma));
  return lines;
}

// "board no. 2 stands at (-1.204, 0.001, 0.318) m in the frame of the first, +- 2.1 mm, 0.11 deg".
std::vector<std::string> board_lines(const Result& result) {
  std::vector<std::string> lines;
  for (const EstimatedBoard& board : result.boards) {
    const Eigen::Vector3d& t = board.T_first_board.translation;
    const double sigma_m = *std::max_element(board.sigma.begin(), board.sigma.begin() + 3);
    const double sigma_rad = *std::max_element(board.sigma.begin() + 3, board.sigma.end());
    lines.push_back(fmt::format(
        "board no. {} stands at ({:.3f}, {:.3f}, {:.3f}) m in the frame of the first, +- {} mm, {} deg", board.number,
        t.x(), t.y(), t.z(), short_figure(1e3 * sigma_m), short_figure(rad_to_deg(sigma_rad))));
  }
  return lines;
}

// "22 used  2 left out: board cut off (3, 17)", a line a camera.
void print_use(const Terminal& terminal, const Result& result) {
  std::vector<std::vector<std::string>> rows;
  for (const CameraUse& use : result.use) rows.push_back({" " + use.camera, std::to_string(use.used) + " used"});
  // Reasons differ in length: only the first two columns are padded.
  const std::vector<std::string> lines = aligned(rows);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string left_out = left_out_text(result.use[i]);
    terminal.line(lines[i] + (left_out.empty() ? "" : "  " + left_out));
  }
}

bool has_any_figure(const EstimatedTransform& transform) {
  return std::any_of(transform.observable.begin(), transform.observable.end(), [](bool known) { return known; });
}

// The likely cause stands first, and it is one refusal for all of them.
void print_reasons(const Terminal& terminal, const Result& result) {
  std::string label = terminal.colored("REFUSED", Color::kBad) + "  ";
  for (const std::string& reason : words::sentences_of(result.reasons, names_of(result))) {
    terminal.line(label + reason);
    label.assign(9, ' ');
  }
}

// Those that throw doubt on the answer, or all others.
void print_notes(const Terminal& terminal, const Result& result, bool suspicions) {
  std::vector<Finding> notes;
  for (const Finding& note : result.notes)
    if ((note.severity == Severity::kSuspect) == suspicions) notes.push_back(note);
  const std::string label = suspicions ? terminal.colored("SUSPECT", Color::kWarning) + "  "
                                       : terminal.colored("NOTE", Color::kWarning) + "     ";
  for (const std::string& note : words::sentences_of(notes, names_of(result))) terminal.line(label + note);
}

// What a refusal leaves standing.
void print_usable(const Terminal& terminal, const Result& result) {
  std::vector<std::string> lines;
  if (std::any_of(result.camera_to_robot.begin(), result.camera_to_robot.end(), has_any_figure))
    lines = pose_lines(result);
  if (const std::string pairs = pairs_text(result); !pairs.empty()) lines.push_back(pairs);
  if (lines.empty()) lines.emplace_back("nothing");
  for (std::size_t i = 0; i < lines.size(); ++i)
    terminal.line((i == 0 ? terminal.colored("USABLE", Color::kGood) + "   " : std::string(9, ' ')) + lines[i]);
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

std::vector<std::string> with_axis_heads(std::vector<std::string> first) {
  for (std::size_t axis = 0; axis < kSpokenAxisNames.size(); ++axis)
    first.push_back(std::string(kSpokenAxisNames[axis]) + (axis == 0 ? " [cm]" : axis == 3 ? " [deg]" : ""));
  return first;
}

std::string use_in_short(const Result& result) {
  int used = 0;
  std::vector<Exclusion> left_out;
  for (const CameraUse& use : result.use) {
    used += use.used;
    const std::vector<Exclusion> images = of_depth(use.left_out, false);
    left_out.insert(left_out.end(), images.begin(), images.end());
  }
  std::string text = std::to_string(used) + " used, " + std::to_string(left_out.size()) + " left out";
  if (left_out.empty()) return text;
  const std::vector<words::ReasonGroup> groups = words::by_reason(left_out);
  return text + " (" + (groups.size() > 1 ? "mostly " : "") + groups.front().reason + ")";
}

void print_result(const Terminal& terminal, const Result& result) {
  print_use(terminal, result);
  print_reasons(terminal, result);
  print_suspicions(terminal, result);
  if (result.status == ResultStatus::kSolved)
    for (const std::string& line : pose_lines(result)) terminal.line(line);
  else
    print_usable(terminal, result);
  print_also_estimated(terminal, result);
  for (const std::string& line : board_lines(result)) terminal.line(line);
  print_main_sources(terminal, result);
  print_notes(terminal, result, false);
}

void print_suspicions(const Terminal& terminal, const Result& result) { print_notes(terminal, result, true); }

void print_also_estimated(const Terminal& terminal, const Result& result) {
  for (const std::string& line : also_estimated_lines(result)) terminal.line(line);
}

void print_main_sources(const Terminal& terminal, const Result& result) {
  std::string label = "uncertainty  ";
  for (const std::string& source : words::sentences_of(main_sources(result))) {
    terminal.line(label + source);
    label.assign(label.size(), ' ');
  }
}

// As in results/METHOD.yaml.
nlohmann::json board_as_json(const EstimatedBoard& board) {
  const Rigid3& T = board.T_first_board;
  const auto in = [&board](double units_per_si, std::size_t first) {
    return nlohmann::json::array({units_per_si * board.sigma[first], units_per_si * board.sigma[first + 1],
                                  units_per_si * board.sigma[first + 2]});
  };
  return {{"number", board.number},
          {"translation_m", {T.translation.x(), T.translation.y(), T.translation.z()}},
          {"quaternion_xyzw", {T.rotation.x(), T.rotation.y(), T.rotation.z(), T.rotation.w()}},
          {"sigmas_mm", in(1e3, 0)},
          {"sigmas_deg", in(rad_to_deg(1.0), 3)}};
}

nlohmann::json json_of(const std::vector<Finding>& findings) {
  return nlohmann::json::parse(findings_json(findings, words::sentence_of));
}

nlohmann::json json_of(const Result& result) {
  nlohmann::json json = {{"method", result.method}, {"status", result_status_name(result.status)}};
  json["reasons"] = json_of(result.reasons);
  json["notes"] = json_of(result.notes);
  json["camera_to_robot"] = nlohmann::json::array();
  json["camera_to_camera"] = nlohmann::json::array();
  for (const EstimatedTransform& transform : result.camera_to_robot)
    json["camera_to_robot"].push_back(transform_as_json(transform));
  for (const EstimatedTransform& transform : result.camera_to_camera)
    json["camera_to_camera"].push_back(transform_as_json(transform));
  for (const EstimatedQuantity& quantity : result.also_estimated)
    json["also_estimated"].push_back({{"camera", quantity.camera},
                                      {"name", quantity.name},
                                      {"value", quantity.value},
                                      {"sigma", quantity.sigma},
                                      {"prior_sigma", quantity.prior_sigma}});
  for (const EstimatedBoard& board : result.boards) json["boards"].push_back(board_as_json(board));
  json["use"] = nlohmann::json::array();
  for (const CameraUse& use : result.use) {
    nlohmann::json camera = {{"camera", use.camera}, {"used", use.used}, {"left_out", nlohmann::json::array()}};
    for (const Exclusion& exclusion : use.left_out)
      camera["left_out"].push_back({{"stop", exclusion.stop},
                                    {"file", exclusion.file},
                                    {"code", exclusion.why.code},
                                    {"depth", exclusion.depth},
                                    {"sentence", words::sentence_of(exclusion.why)}});
    json["use"].push_back(camera);
  }
  return json;
}

}  // namespace rigproof
