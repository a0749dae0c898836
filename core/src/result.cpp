#include "rigproof/core/result.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>

#include "covariance_triangle.h"
#include "lasting_errors.h"
#include "mcalib_result.h"
#include "rigproof/core/bag_name.h"
#include "rigproof/core/body_axes.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/file_schemas.h"
#include "rigproof/core/files.h"
#include "rigproof/core/finding_tree.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/yaml.h"
#include "schema_nodes.h"

namespace rigproof {
namespace {

using Observable = std::array<bool, 6>;

constexpr std::uintmax_t kMaxBytes = 16U << 20U;
constexpr int kVersion = 2;  // 1: findings were sentences
constexpr double kCmPerM = 100.0;
constexpr double kDegPerRad = 180.0 / kPi;
const char* const kFormat = "rigproof-result";
const char* const kTranslationKeys[] = {"tx_m", "ty_m", "tz_m"};
const char* const kAngleKeys[] = {"roll_rad", "pitch_rad", "yaw_rad"};
const char* const kStddevKeys[] = {"tx_cm", "ty_cm", "tz_cm", "rx_deg", "ry_deg", "rz_deg"};

constexpr std::array<ResultStatus, 3> kStatuses = {ResultStatus::kSolved, ResultStatus::kPartial,
                                                   ResultStatus::kRefused};

bool all_observable(const Observable& observable) {
  return std::all_of(observable.begin(), observable.end(), [](bool o) { return o; });
}

// ---------------------------------------------------------------------------------- attitude of body axes, covariance

// Attitude of the child camera's body axes; `parent_is_camera`: in the body axes of the parent camera.
Eigen::Quaterniond body_attitude(const Rigid3& T, bool parent_is_camera) {
  const Eigen::Quaterniond attitude = T.rotation * optical_from_body();
  return parent_is_camera ? optical_from_body().conjugate() * attitude : attitude;
}

Eigen::Quaterniond optical_rotation(const Eigen::Quaterniond& attitude, bool parent_is_camera) {
  const Eigen::Quaterniond rotation = attitude * optical_from_body().conjugate();
  return parent_is_camera ? optical_from_body() * rotation : rotation;
}

std::vector<Eigen::Index> observable_rows(const std::vector<EstimatedTransform>& transforms) {
  std::vector<Eigen::Index> rows;
  Eigen::Index row = 0;
  for (const EstimatedTransform& transform : transforms)
    for (const bool observable : transform.observable) {
      if (observable) rows.push_back(row);
      ++row;
    }
  return rows;
}

// Answers what is read. Rows that are absent are unknown: infinite variance, no correlation.
std::optional<Eigen::MatrixXd> visit_covariance(FieldVisitor& visitor, const char* key,
                                                const std::optional<Eigen::MatrixXd>& written, Eigen::Index size,
                                                const std::vector<Eigen::Index>& rows, const char* description) {
  if (!visitor.takes(key, written.has_value())) return std::nullopt;
  std::vector<std::vector<double>> lines;
  if (written) lines = upper_triangle(*written, rows);
  visitor.field(key, lines, {}, 0, description);
  if (!visitor.is_reading()) return std::nullopt;
  const bool fits = is_triangle(lines, rows.size());
  visitor.check(fits, key, "must be an upper triangle of " + std::to_string(rows.size()) + " rows");
  if (!fits) return std::nullopt;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  matrix.diagonal().setConstant(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = i; j < rows.size(); ++j) matrix(rows[i], rows[j]) = matrix(rows[j], rows[i]) = lines[i][j - i];
  visitor.check(is_covariance(matrix, rows), key,
                "is no covariance: variances must not be negative, correlations at most 1");
  return matrix;
}

// ------------------------------------------------------------------------------------------------------ a transform

// Angles pass through a rotation when they are read; at a resolution of 1e-12 rad they come back as they were.
double rounded_angle(double angle_rad) { return parse_number(fixed_text(angle_rad, 12)).value_or(angle_rad); }

void visit_frame(FieldVisitor& visitor, const char* key, std::string& name, const char* description) {
  if (name.empty()) visitor.require(key, "a frame's name");
  visitor.field(key, name, TextChoices{}, description);
  visitor.check(visitor.given(key) == nullptr || (!name.empty() && name.size() <= 200), key, "must be a frame's name");
}

void visit_frames(FieldVisitor& visitor, EstimatedTransform& estimate) {
  std::string sentence = estimate.parent.empty() || visitor.is_reading() ? "" : sentence_of(estimate);
  visitor.optional("sentence", sentence, "what the transform is, in words");
  visit_frame(visitor, "parent", estimate.parent, "frame that the pose is given in");
  visit_frame(visitor, "child", estimate.child, "frame whose pose it is");
  visitor.check(estimate.parent.empty() || estimate.parent != estimate.child, "child",
                "is the parent, too; the pose of a frame in itself is no result");
  visitor.check(sentence.empty() || sentence == sentence_of(estimate), "sentence",
                "contradicts parent and child, which say \"" + sentence_of(estimate) + "\"");
}

void visit_unobservable(FieldVisitor& visitor, Observable& observable) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < 6; ++i)
    if (!observable[i]) names.emplace_back(kDegreeOfFreedomNames[i]);
  if (!visitor.takes("unobservable", !names.empty())) return;
  visitor.field("unobservable", names, "degrees of freedom that the data do not determine: tx ty tz rx ry rz");
  for (const std::string& name : names) {
    const auto* const found = std::find(kDegreeOfFreedomNames.begin(), kDegreeOfFreedomNames.end(), name);
    if (found != kDegreeOfFreedomNames.end())
      observable[static_cast<std::size_t>(found - kDegreeOfFreedomNames.begin())] = false;
    else
      visitor.check(false, "unobservable", "must be a list of tx, ty, tz, rx, ry, rz");
  }
}

void visit_degree(FieldVisitor& visitor, bool observable, const char* key, double& value, double limit,
                  const char* description) {
  if (!observable && !visitor.describes()) return;
  if (!visitor.describes()) visitor.require(key, "a number, for this degree of freedom is observable");
  visitor.field(key, value, {-limit, limit}, description);
}

void visit_partial_pose(FieldVisitor& visitor, EstimatedTransform& estimate, bool parent_is_camera) {
  Eigen::Vector3d t = Eigen::Vector3d::Zero(), rpy = t;
  if (!visitor.is_reading() && !visitor.describes()) {
    t = estimate.T_parent_child.translation;
    rpy = roll_pitch_yaw(body_attitude(estimate.T_parent_child, parent_is_camera)).unaryExpr(&rounded_angle);
  }
  const Observable& observable = estimate.observable;
  for (std::size_t i = 0; i < 3; ++i)
    visit_degree(visitor, observable[i], kTranslationKeys[i], t[static_cast<Eigen::Index>(i)], 1e6,
                 "where some degrees of freedom are not determined: those that are");
  for (std::size_t i = 0; i < 3; ++i)
    visit_degree(visitor, observable[3 + i], kAngleKeys[i], rpy[static_cast<Eigen::Index>(i)], 7.0,
                 "the same, of the camera's body axes: R = Rz(yaw) Ry(pitch) Rx(roll)");
  if (visitor.is_reading())
    estimate.T_parent_child = Rigid3(optical_rotation(from_roll_pitch_yaw(rpy), parent_is_camera), t);
}

using Sigmas = std::array<std::optional<double>, 6>;

// For people: four digits. The covariance has them all.
Sigmas rounded_sigmas(const EstimatedTransform& estimate) {
  Sigmas sigmas;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (!estimate.covariance || !estimate.observable[at]) continue;
    const double sigma = (i < 3 ? kCmPerM : kDegPerRad) * std::sqrt(std::max(0.0, (*estimate.covariance)(i, i)));
    sigmas[at] = parse_number(short_text(sigma, 4)).value_or(sigma);
  }
  return sigmas;
}

Sigmas visit_stddev(FieldVisitor& visitor, const EstimatedTransform& estimate, bool has_any) {
  Sigmas sigmas;
  if (has_any) sigmas = rounded_sigmas(estimate);
  const auto visit = [&sigmas](FieldVisitor& block) {
    block.on_one_line();
    for (std::size_t i = 0; i < 6; ++i) block.field(kStddevKeys[i], sigmas[i], {0.0}, "one sigma");
  };
  if (visitor.takes("stddev", has_any)) visitor.section("stddev", visit, "one sigma, for people");
  return sigmas;
}

// What only standard deviations tell, where a foreign result gives no covariance.
std::optional<Matrix6d> covariance_of(const Sigmas& sigmas) {
  Matrix6d covariance = Matrix6d::Zero();
  for (Eigen::Index i = 0; i < 6; ++i) {
    const std::optional<double>& sigma = sigmas[static_cast<std::size_t>(i)];
    if (!sigma) return std::nullopt;
    const double si = *sigma / (i < 3 ? kCmPerM : kDegPerRad);
    covariance(i, i) = si * si;
  }
  return covariance;
}

void visit_share(FieldVisitor& visitor, EstimatedTransform::Share& share) {
  visitor.on_one_line();
  visitor.field("source", share.source, TextChoices{}, "what it comes from");
  std::vector<double> values(share.share.begin(), share.share.end());
  visitor.field("share", values, {0.0, 1.0}, 6, 6, "of the variances of tx ty tz rx ry rz");
  if (visitor.is_reading() && values.size() == 6) std::copy(values.begin(), values.end(), share.share.begin());
}

void visit_estimate(FieldVisitor& visitor, EstimatedTransform& estimate, bool parent_is_camera) {
  visit_frames(visitor, estimate);
  if (visitor.is_reading()) visit_unobservable(visitor, estimate.observable);
  const bool full = estimate.fully_observable();
  if (!visitor.is_reading() && !full && !parent_is_camera) estimate = heading_free(estimate);
  if (full) visit_pose(visitor, estimate.T_parent_child, !visitor.describes());
  if (!full || visitor.describes()) visit_partial_pose(visitor, estimate, parent_is_camera);
  if (!visitor.is_reading()) visit_unobservable(visitor, estimate.observable);
  const std::vector<Eigen::Index> rows = observable_rows({estimate});
  std::optional<Eigen::MatrixXd> written;
  if (estimate.covariance && !rows.empty()) written = *estimate.covariance;
  const Sigmas sigmas = visit_stddev(visitor, estimate, written.has_value());
  const auto covariance = visit_covariance(visitor, "covariance_m_rad", written, 6, rows,
                                           "upper triangle, row by row, of what is determined");
  if (covariance) estimate.covariance = *covariance;
  if (visitor.is_reading() && !covariance && full) estimate.covariance = covariance_of(sigmas);
  if (visitor.takes("budget", !estimate.budget.empty()))
    visitor.nested_list("budget", estimate.budget, "what the variances are made of", visit_share);
  visitor.tolerate("x-");
}

EstimatedTransform read_estimate(const YamlTree& tree, const std::string& path, const std::string& default_child,
                                 bool parent_is_camera, Problems* problems) {
  EstimatedTransform estimate;
  estimate.child = default_child;
  read_fields_of_block(tree, path, problems,
                       [&](FieldVisitor& visitor) { visit_estimate(visitor, estimate, parent_is_camera); });
  return estimate;
}

std::vector<EstimatedTransform> read_estimates(const YamlTree& tree, const std::string& path, bool parent_is_camera,
                                               Problems* problems) {
  std::vector<EstimatedTransform> estimates;
  const std::string prefix = path.empty() ? "[" : path + "[";
  for (std::size_t i = 0; i < tree.items.size(); ++i)
    estimates.push_back(read_estimate(tree.items[i], prefix + std::to_string(i) + "]", "", parent_is_camera, problems));
  for (const auto& [name, value] : tree.entries)
    if (name.rfind("x-", 0) != 0)
      estimates.push_back(
          read_estimate(value, path.empty() ? name : path + "." + name, name, parent_is_camera, problems));
  if (!tree.is_sequence() && !tree.is_map() && !tree.is_null())
    problems->add({tree.file, tree.line, path, tree.shown(), "must be a list or a map of transforms"});
  return estimates;
}

void visit_estimates(FieldVisitor& visitor, const char* key, std::vector<EstimatedTransform>& estimates,
                     bool parent_is_camera, const char* description) {
  const auto tree_of = [parent_is_camera](EstimatedTransform estimate) {
    return tree_of_fields([&](FieldVisitor& inner) { visit_estimate(inner, estimate, parent_is_camera); });
  };
  const auto read = [&](const YamlTree& tree, const std::string& path, Problems* problems) {
    estimates = read_estimates(tree, path, parent_is_camera, problems);
  };
  const auto write = [&] {
    YamlTree list = YamlTree::sequence();
    for (const EstimatedTransform& estimate : estimates) list.add(tree_of(estimate));
    return list;
  };
  const auto schema = [parent_is_camera] {
    EstimatedTransform estimate;
    return schema_of_list(
        schema_of_block([&](FieldVisitor& inner) { visit_estimate(inner, estimate, parent_is_camera); }));
  };
  visitor.value(key, {read, write, schema}, description);
}

// --------------------------------------------------------------------------------------------------------- a result

void visit_left_out(FieldVisitor& visitor, Exclusion& exclusion, const Wording& wording) {
  visitor.on_one_line();
  visitor.field("stop", exclusion.stop, {-1.0, 1e9}, "index of the stop; -1 = none");
  visitor.field("file", exclusion.file, TextChoices{}, "the image");
  visit_why(visitor, exclusion, wording);
}

void visit_use(FieldVisitor& visitor, CameraUse& use, const Wording& wording) {
  visitor.require("camera", "a camera's name");
  visitor.field("camera", use.camera, TextChoices{}, "its name");
  visitor.field("used", use.used, {0.0, 1e9}, "images that were used");
  visitor.field("reprojection_rms_px", use.reprojection_rms_px, {0.0}, "over those images");
  visitor.nested_list("left_out", use.left_out, "those that were not",
                      [&](FieldVisitor& line, Exclusion& exclusion) { visit_left_out(line, exclusion, wording); });
  visitor.tolerate("x-");
}

void visit_residual(FieldVisitor& visitor, ResidualSummary& residual) {
  visitor.on_one_line();
  visitor.field("name", residual.name, TextChoices{}, "what was measured");
  visitor.field("unit", residual.unit, TextChoices{}, "of the root mean square");
  visitor.field("count", residual.count, {0.0, 2e9}, "numbers that were fitted");
  visitor.field("rms", residual.rms, {0.0}, "root mean square");
  visitor.tolerate("x-");
}

void visit_lens(FieldVisitor& visitor, EstimatedLens& lens) {
  visitor.require("camera", "a camera's name");
  visitor.field("camera", lens.camera, TextChoices{}, "of which camera");
  visitor.require("intrinsics", "a block of intrinsics");
  visitor.nested("intrinsics", lens.intrinsics, "with them the camera's pose is to be used");
  visitor.tolerate("x-");
}

void visit_estimated_board(FieldVisitor& visitor, EstimatedBoard& board) {
  visitor.on_one_line();
  visitor.require("number", "a whole number, 2 of the first of more_boards");
  visitor.field("number", board.number, {2.0, 1e3}, "which board: 2 is the first of more_boards");
  visit_pose(visitor, board.T_first_board);
  const auto visit_sigma = [&](const char* key, std::size_t first, double units_per_si, const char* description) {
    std::vector<double> values;
    for (std::size_t i = first; i < first + 3; ++i) values.push_back(units_per_si * board.sigma[i]);
    visitor.require(key, "three numbers");
    visitor.field(key, values, {0.0, 1e9}, 3, 3, description);
    for (std::size_t i = 0; visitor.is_reading() && i < 3; ++i) board.sigma[first + i] = values[i] / units_per_si;
  };
  visit_sigma("sigmas_mm", 0, 1e3, "one sigma along each axis of the first board");
  visit_sigma("sigmas_deg", 3, 180.0 / kPi, "one sigma about each axis of this board");
  visitor.tolerate("x-");
}

void visit_quantity(FieldVisitor& visitor, EstimatedQuantity& quantity) {
  visitor.on_one_line();
  visitor.require("name", "what was estimated, with its unit");
  visitor.optional(
      "camera", quantity.camera,
      "of which camera; of what cameras of one sensor share, of the first; absent: of the whole rig, or of the board");
  visitor.field("name", quantity.name, TextChoices{}, "what, with its unit");
  visitor.field("value", quantity.value, {}, "the estimate");
  visitor.field("sigma", quantity.sigma, {0.0}, "its standard deviation");
  visitor.field("prior_sigma", quantity.prior_sigma, {0.0}, "what was believed before");
  visitor.tolerate("x-");
}

// With an unknown heading each camera's covariance is in axes of its own: there is no joint one then.
std::optional<Eigen::MatrixXd> joint_covariance_of(const Result& result) {
  const bool complete = std::all_of(result.camera_to_robot.begin(), result.camera_to_robot.end(),
                                    [](const EstimatedTransform& t) { return t.fully_observable(); });
  return complete ? result.joint_covariance : std::nullopt;
}

void visit_lists(FieldVisitor& visitor, Result& result, const Wording& wording) {
  visitor.nested_list("use", result.use, "what was used of each camera",
                      [&](FieldVisitor& inner, CameraUse& use) { visit_use(inner, use, wording); });
  visitor.nested_list("residuals", result.residuals, "how well everything fits", visit_residual);
  if (visitor.takes("also_estimated", !result.also_estimated.empty()))
    visitor.nested_list("also_estimated", result.also_estimated, "what else was estimated", visit_quantity);
  if (visitor.takes("lenses", !result.lenses.empty()))
    visitor.nested_list("lenses", result.lenses, "intrinsics that the poses go with, where they were estimated",
                        visit_lens);
  if (visitor.takes("boards", !result.boards.empty()))
    visitor.nested_list("boards", result.boards, "poses of more_boards in the frame of the first board",
                        visit_estimated_board);
  visit_rotation_centre(visitor, result.rotation_centre_m,
                        "[x, y] of the point about which the robot was said to turn");
  visitor.scaled("rotation_centre_sigma_mm", result.rotation_centre_sigma_m, 1000.0, {0.0, 1000.0},
                 "how well that was said to be known, along x and along y, one sigma");
}

void visit_result(FieldVisitor& visitor, Result& result, const Wording& wording) {
  visitor.format(kFormat, kVersion);
  visitor.field("method", result.method, TextChoices{}, "what estimated it");
  visitor.require("status", "solved, partial or refused");
  std::vector<std::pair<const char*, ResultStatus>> statuses;
  for (const ResultStatus status : kStatuses) statuses.emplace_back(result_status_name(status), status);
  visitor.choice("status", result.status, statuses, "whether everything was answered");
  visit_findings(visitor, "reasons", result.reasons, Severity::kRefusal, wording, "why it is partial or refused");
  visit_findings(visitor, "notes", result.notes, Severity::kNote, wording, "what the user should know");
  visit_estimates(visitor, "camera_to_robot", result.camera_to_robot, false, "poses of the cameras in the robot");
  visit_estimates(visitor, "camera_to_camera", result.camera_to_camera, true,
                  "poses of each camera in each earlier one");
  const auto size = static_cast<Eigen::Index>(6 * result.camera_to_robot.size());
  const auto joint =
      visit_covariance(visitor, "joint_covariance_m_rad", joint_covariance_of(result), size,
                       observable_rows(result.camera_to_robot), "upper triangle of all of camera_to_robot together");
  if (visitor.is_reading()) result.joint_covariance = joint;
  visit_lists(visitor, result, wording);
  visit_lasting(visitor, result.lasting, joint_covariance_of(result));
  visitor.tolerate("x-");
}

// ---------------------------------------------------------------------------------------------------------- reading

void check_repeats(const std::vector<EstimatedTransform>& estimates, const std::string& file, Problems* problems) {
  std::set<std::pair<std::string, std::string>> seen;
  for (const EstimatedTransform& estimate : estimates)
    if (!seen.emplace(estimate.parent, estimate.child).second)
      problems->add({file, 0, "", "", "the " + sentence_of(estimate) + " is given twice"});
}

// The smallest result that somebody else writes. A parent that is some other transform's child is a camera.
Result read_foreign(const YamlTree& tree, const std::string& path, Problems* problems) {
  Result result;
  result.method = "foreign";
  result.status = ResultStatus::kSolved;
  const std::vector<EstimatedTransform> estimates = read_estimates(tree, path, false, problems);
  if (estimates.empty())
    problems->add({tree.file, tree.line, path, tree.shown(),
                   "holds no transform; a list of {parent, child, translation_m, quaternion_xyzw} is expected"});
  std::set<std::string> children;
  for (const EstimatedTransform& estimate : estimates) children.insert(estimate.child);
  for (const EstimatedTransform& estimate : estimates)
    (children.count(estimate.parent) > 0 ? result.camera_to_camera : result.camera_to_robot).push_back(estimate);
  return result;
}

Result read_own(const YamlTree& tree, Problems* problems) {
  Result result;
  // Another kind of file is one problem; every key that it has is no further one.
  if (!MapReader(tree, "", problems).text("format", {kFormat})) return result;
  read_fields_of_block(tree, "", problems, [&result](FieldVisitor& visitor) { visit_result(visitor, result, {}); });
  for (std::size_t i = 0; i < result.use.size(); ++i)
    for (Exclusion& exclusion : result.use[i].left_out) exclusion.camera = static_cast<int>(i);
  return result;
}

Result read_result(const YamlTree& tree, Problems* problems) {
  if (tree.is_map() && tree.find("format") != nullptr) return read_own(tree, problems);
  if (is_mcalib_result(tree)) return read_mcalib_result(tree, problems);
  const YamlTree* transforms = tree.find("transforms");
  if (transforms == nullptr) return read_foreign(tree, "", problems);
  MapReader map(tree, "", problems);
  map.find("transforms");
  const auto method = map.text("method");
  map.finish("x-");
  Result result = read_foreign(*transforms, "transforms", problems);
  if (method) result.method = *method;
  return result;
}

}  // namespace

bool EstimatedTransform::fully_observable() const { return all_observable(observable); }

EstimatedTransform heading_free(EstimatedTransform estimate) {
  if (estimate.observable[5]) return estimate;
  const double yaw_rad = roll_pitch_yaw(body_attitude(estimate.T_parent_child, false)).z();
  const Eigen::Quaterniond turn = rotation_z(-yaw_rad);
  estimate.T_parent_child.rotation = turn * estimate.T_parent_child.rotation;
  if (!estimate.covariance) return estimate;
  // A turn of the axes must not carry what is unknown into what is known.
  Matrix6d known = *estimate.covariance, J = Matrix6d::Identity();
  for (Eigen::Index i = 0; i < 6; ++i)
    if (!estimate.observable[static_cast<std::size_t>(i)]) known.row(i).setZero(), known.col(i).setZero();
  J.bottomRightCorner<3, 3>() = turn.toRotationMatrix();
  estimate.covariance = J * known * J.transpose();
  return estimate;
}

const char* result_status_name(ResultStatus status) {
  switch (status) {
    case ResultStatus::kSolved:
      return "solved";
    case ResultStatus::kPartial:
      return "partial";
    case ResultStatus::kRefused:
      break;
  }
  return "refused";
}

const EstimatedTransform* Result::find(const std::string& parent, const std::string& child) const {
  for (const auto* list : {&camera_to_robot, &camera_to_camera})
    for (const EstimatedTransform& transform : *list)
      if (transform.parent == parent && transform.child == child) return &transform;
  return nullptr;
}

namespace {

// Each of its keys would be a problem of its own.
void refuse_rig(const YamlTree& tree, const std::filesystem::path& file) {
  if (tree.find("format") == nullptr && tree.find("method") == nullptr && tree.find("cameras") != nullptr &&
      tree.find("board") != nullptr)
    throw Error(file.string() +
                ": is a rig, not a result; `rigproof calibrate` writes results, as results/ml.yaml beside it");
}

}  // namespace

Result load_result(const std::filesystem::path& file) {
  Problems problems;
  refuse_bag(file);
  const YamlTree tree = read_yaml_file(file, kMaxBytes);
  refuse_rig(tree, file);
  Result result = read_result(tree, &problems);
  check_repeats(result.camera_to_robot, file.string(), &problems);
  check_repeats(result.camera_to_camera, file.string(), &problems);
  problems.sort();
  problems.throw_if_any();
  return result;
}

std::string result_schema() {
  Result result;
  const auto visit = [&result](FieldVisitor& visitor) { visit_result(visitor, result, {}); };
  return schema_of_fields("Rigproof result: results/METHOD.yaml", visit, {kVersion, false});
}

std::string result_text(const Result& result, const Wording& wording) {
  Result written = result;
  return write_fields([&](FieldVisitor& visitor) { visit_result(visitor, written, wording); });
}

void save_result(const Result& result, const std::filesystem::path& file, const Wording& wording) {
  write_file_atomically(file, result_text(result, wording));
}

std::string name_with_settings(const std::string& method,
                               const std::vector<std::pair<std::string, std::string>>& settings) {
  constexpr std::size_t kLongest = 80, kHashed = 8;
  constexpr std::string_view kSigns = "_-+.";
  if (settings.empty()) return method;
  std::string name = method;
  for (const auto& [key, value] : settings) {
    name += "-" + key + "_";
    for (const char c : value)
      name += std::isalnum(static_cast<unsigned char>(c)) != 0 || kSigns.find(c) != std::string_view::npos ? c : '_';
  }
  if (name.size() <= kLongest) return name;
  return name.substr(0, kLongest - kHashed - 1) + "-" + sha256_hex(name).substr(0, kHashed);
}

std::string sentence_of(const EstimatedTransform& transform) {
  return "pose of " + transform.child + " in " + transform.parent;
}

}  // namespace rigproof
