#include "rigproof/core/result.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "finding_tree.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/file_schemas.h"
#include "rigproof/core/files.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/yaml.h"

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

// Columns: the optical axes (x right, y down, z forward) in body axes (x forward, y left, z up).
Eigen::Matrix3d body_from_optical() {
  Eigen::Matrix3d R;
  R << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return R;
}

// Attitude of the child camera's body axes; `parent_is_camera`: in the body axes of the parent camera.
Eigen::Matrix3d body_attitude(const Rigid3& T, bool parent_is_camera) {
  const Eigen::Matrix3d B = body_from_optical();
  const Eigen::Matrix3d R = T.rotation_matrix() * B.transpose();
  return parent_is_camera ? Eigen::Matrix3d(B * R) : R;
}

Eigen::Quaterniond optical_rotation(const Eigen::Matrix3d& attitude, bool parent_is_camera) {
  const Eigen::Matrix3d B = body_from_optical();
  const Eigen::Matrix3d R = attitude * B;
  return Eigen::Quaterniond(parent_is_camera ? Eigen::Matrix3d(B.transpose() * R) : R);
}

// (roll, pitch, yaw) of R = Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Vector3d roll_pitch_yaw(const Eigen::Matrix3d& R) {
  return {std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))),
          std::atan2(R(1, 0), R(0, 0))};
}

Eigen::Matrix3d attitude_of(const Eigen::Vector3d& rpy) {
  return (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
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

// Row by row from the diagonal on, only the rows and columns given.
YamlTree upper_triangle(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& rows) {
  YamlTree tree = YamlTree::sequence();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<double> row;
    for (std::size_t j = i; j < rows.size(); ++j) row.push_back(matrix(rows[i], rows[j]));
    tree.add(YamlTree::numbers(row));
  }
  return tree;
}

// Rows that are absent are unknown: infinite variance, no correlation.
std::optional<Eigen::MatrixXd> read_upper_triangle(MapReader& map, const std::string& key, Eigen::Index size,
                                                   const std::vector<Eigen::Index>& rows) {
  const YamlTree* tree = map.find(key);
  if (tree == nullptr) return std::nullopt;
  if (!tree->is_sequence() || tree->items.size() != rows.size()) {
    map.problem(key, "must be an upper triangle of " + std::to_string(rows.size()) + " rows");
    return std::nullopt;
  }
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  matrix.diagonal().setConstant(std::numeric_limits<double>::infinity());
  bool positive = true;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string path = map.path_of(key) + "[" + std::to_string(i) + "]";
    const std::size_t length = rows.size() - i;
    const auto row = read_numbers(tree->items[i], path, length, length, {}, &map.problems());
    if (!row) return std::nullopt;
    for (std::size_t j = i; j < rows.size(); ++j) matrix(rows[i], rows[j]) = matrix(rows[j], rows[i]) = (*row)[j - i];
    positive = positive && (*row)[0] >= 0.0;
  }
  for (const Eigen::Index i : rows)
    for (const Eigen::Index j : rows)
      positive = positive && std::abs(matrix(i, j)) <= std::sqrt(matrix(i, i) * matrix(j, j)) * (1.0 + 1e-6);
  if (!positive) map.problem(key, "is no covariance: variances must not be negative, correlations at most 1");
  return matrix;
}

// ---------------------------------------------------------------------------------------------------------- writing

// Angles pass through a rotation when they are read; at a resolution of 1e-12 rad they come back as they were.
double rounded_angle(double angle_rad) { return parse_number(fixed_text(angle_rad, 12)).value_or(angle_rad); }

void add_partial_pose(const EstimatedTransform& transform, const Eigen::Vector3d& rpy, YamlTree* tree) {
  YamlTree unobservable = YamlTree::sequence();
  unobservable.flow = true;
  for (std::size_t i = 0; i < 6; ++i)
    if (!transform.observable[i]) unobservable.add(YamlTree::text(kDegreeOfFreedomNames[i]));
  for (std::size_t i = 0; i < 3; ++i)
    if (transform.observable[i])
      tree->set(kTranslationKeys[i],
                YamlTree::number(transform.T_parent_child.translation[static_cast<Eigen::Index>(i)]));
  for (std::size_t i = 0; i < 3; ++i)
    if (transform.observable[3 + i])
      tree->set(kAngleKeys[i], YamlTree::number(rounded_angle(rpy[static_cast<Eigen::Index>(i)])));
  tree->set("unobservable", std::move(unobservable));
}

void add_covariance(const Matrix6d& covariance, const Observable& observable, YamlTree* tree) {
  YamlTree& stddev = tree->set("stddev", YamlTree::inline_map());
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < 6; ++i) {
    if (!observable[i]) continue;
    const auto row = static_cast<Eigen::Index>(i);
    rows.push_back(row);
    // For people: four digits. The covariance below has them all.
    const double unit = i < 3 ? kCmPerM : kDegPerRad;
    const double sigma = unit * std::sqrt(std::max(0.0, covariance(row, row)));
    stddev.set(kStddevKeys[i], YamlTree::number(parse_number(short_text(sigma, 4)).value_or(sigma)));
  }
  tree->set("covariance_m_rad", upper_triangle(covariance, rows));
}

YamlTree tree_of(const EstimatedTransform& transform, bool parent_is_camera) {
  YamlTree tree = YamlTree::map();
  tree.set("sentence", YamlTree::text(sentence_of(transform)));
  tree.set("parent", YamlTree::text(transform.parent));
  tree.set("child", YamlTree::text(transform.child));
  if (transform.fully_observable()) {
    Rigid3 T = transform.T_parent_child;
    for (const auto& [key, value] : tree_of(T).entries) tree.set(key, value);
    if (transform.covariance) add_covariance(*transform.covariance, transform.observable, &tree);
    return tree;
  }
  const EstimatedTransform partial = parent_is_camera ? transform : heading_free(transform);
  add_partial_pose(partial, roll_pitch_yaw(body_attitude(partial.T_parent_child, parent_is_camera)), &tree);
  const bool any = std::any_of(transform.observable.begin(), transform.observable.end(), [](bool o) { return o; });
  if (partial.covariance && any) add_covariance(*partial.covariance, transform.observable, &tree);
  return tree;
}

YamlTree tree_of(const CameraUse& use, const Wording& wording) {
  YamlTree tree = YamlTree::map();
  tree.set("camera", YamlTree::text(use.camera));
  tree.set("used", YamlTree::integer(use.used));
  tree.set("reprojection_rms_px", YamlTree::number(use.reprojection_rms_px));
  YamlTree& left_out = tree.set("left_out", YamlTree::sequence());
  for (const Exclusion& exclusion : use.left_out) {
    YamlTree& line = left_out.add(YamlTree::inline_map());
    line.set("stop", YamlTree::integer(exclusion.stop));
    line.set("file", YamlTree::text(exclusion.file));
    set_exclusion(exclusion, wording, &line);
  }
  return tree;
}

YamlTree tree_of(const ResidualSummary& residual) {
  YamlTree tree = YamlTree::inline_map();
  tree.set("name", YamlTree::text(residual.name));
  tree.set("unit", YamlTree::text(residual.unit));
  tree.set("count", YamlTree::integer(residual.count));
  tree.set("rms", YamlTree::number(residual.rms));
  return tree;
}

YamlTree tree_of(const EstimatedQuantity& quantity) {
  YamlTree tree = YamlTree::inline_map();
  tree.set("camera", YamlTree::text(quantity.camera));
  tree.set("name", YamlTree::text(quantity.name));
  tree.set("value", YamlTree::number(quantity.value));
  tree.set("sigma", YamlTree::number(quantity.sigma));
  tree.set("prior_sigma", YamlTree::number(quantity.prior_sigma));
  return tree;
}

template <typename Element, typename... Arguments>
YamlTree list_of(const std::vector<Element>& elements, const Arguments&... arguments) {
  YamlTree tree = YamlTree::sequence();
  for (const Element& element : elements) tree.add(tree_of(element, arguments...));
  return tree;
}

YamlTree tree_of(const Result& result, const Wording& wording) {
  YamlTree tree = YamlTree::map();
  tree.set("format", YamlTree::text(kFormat));
  tree.set("version", YamlTree::integer(kVersion));
  tree.set("method", YamlTree::text(result.method));
  tree.set("status", YamlTree::text(result_status_name(result.status)));
  tree.set("reasons", tree_of(result.reasons, wording));
  tree.set("notes", tree_of(result.notes, wording));
  tree.set("camera_to_robot", list_of(result.camera_to_robot, false));
  tree.set("camera_to_camera", list_of(result.camera_to_camera, true));
  const bool complete = std::all_of(result.camera_to_robot.begin(), result.camera_to_robot.end(),
                                    [](const EstimatedTransform& t) { return t.fully_observable(); });
  // With an unknown heading each camera's covariance is in axes of its own: there is no joint one then.
  if (result.joint_covariance && complete)
    tree.set("joint_covariance_m_rad",
             upper_triangle(*result.joint_covariance, observable_rows(result.camera_to_robot)));
  tree.set("use", list_of(result.use, wording));
  tree.set("residuals", list_of(result.residuals));
  if (!result.also_estimated.empty()) tree.set("also_estimated", list_of(result.also_estimated));
  return tree;
}

// ---------------------------------------------------------------------------------------------------------- reading

Observable read_observable(MapReader& map) {
  Observable observable = {true, true, true, true, true, true};
  for (const std::string& name : map.texts("unobservable").value_or(std::vector<std::string>())) {
    const auto* const found = std::find(kDegreeOfFreedomNames.begin(), kDegreeOfFreedomNames.end(), name);
    if (found == kDegreeOfFreedomNames.end())
      map.problem("unobservable", "must be a list of tx, ty, tz, rx, ry, rz");
    else
      observable[static_cast<std::size_t>(found - kDegreeOfFreedomNames.begin())] = false;
  }
  return observable;
}

Rigid3 read_partial_pose(MapReader& map, const Observable& observable, bool parent_is_camera) {
  Eigen::Vector3d t = Eigen::Vector3d::Zero(), rpy = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (observable[i]) map.require(kTranslationKeys[i], "a number, for this degree of freedom is observable");
    if (observable[3 + i]) map.require(kAngleKeys[i], "a number, for this degree of freedom is observable");
    if (observable[i]) t[row] = map.number(kTranslationKeys[i], {-1e6, 1e6}).value_or(0.0);
    if (observable[3 + i]) rpy[row] = map.number(kAngleKeys[i], {-7.0, 7.0}).value_or(0.0);
  }
  return Rigid3(optical_rotation(attitude_of(rpy), parent_is_camera), t);
}

void read_stddev(MapReader& map) {
  const YamlTree* stddev = map.find("stddev");
  if (stddev == nullptr) return;
  MapReader block(*stddev, map.path_of("stddev"), &map.problems());
  for (const char* key : kStddevKeys) block.number(key, {0.0});
  block.finish();
}

// What only a standard deviation tells, where a foreign result gives no covariance.
std::optional<Matrix6d> covariance_of_stddev(MapReader& map) {
  const YamlTree* stddev = map.find("stddev");
  if (stddev == nullptr) return std::nullopt;
  Problems ignored;
  MapReader block(*stddev, "", &ignored);
  Matrix6d covariance = Matrix6d::Zero();
  for (Eigen::Index i = 0; i < 6; ++i) {
    const auto sigma = block.number(kStddevKeys[i]);
    if (!sigma) return std::nullopt;
    const double si = *sigma / (i < 3 ? kCmPerM : kDegPerRad);
    covariance(i, i) = si * si;
  }
  return covariance;
}

// The two keys of a pose among others.
Rigid3 read_pose(MapReader& map) {
  YamlTree pose = YamlTree::map();
  pose.file = map.tree().file;
  pose.line = map.tree().line;
  for (const char* key : {"translation_m", "quaternion_xyzw"})
    if (const YamlTree* value = map.find(key)) pose.set(key, *value);
  Rigid3 T;
  read_fields_of_block(pose, map.path_of(""), &map.problems(), [&T](FieldVisitor& visitor) { visit_pose(visitor, T); });
  return T;
}

std::string read_frame(MapReader& map, const std::string& key, const std::string& otherwise) {
  const auto name = map.text(key);
  if (!name && otherwise.empty()) map.require(key, "a frame's name");
  if (name && (name->empty() || name->size() > 200)) map.problem(key, "must be a frame's name");
  return name.value_or(otherwise);
}

EstimatedTransform read_estimate(const YamlTree& tree, const std::string& path, const std::string& default_child,
                                 bool parent_is_camera, Problems* problems) {
  EstimatedTransform estimate;
  MapReader map(tree, path, problems);
  estimate.parent = read_frame(map, "parent", "");
  estimate.child = read_frame(map, "child", default_child);
  if (!estimate.parent.empty() && estimate.parent == estimate.child)
    map.problem("child", "is the parent, too; the pose of a frame in itself is no result");
  const auto sentence = map.text("sentence");
  if (sentence && *sentence != sentence_of(estimate))
    map.problem("sentence", "contradicts parent and child, which say \"" + sentence_of(estimate) + "\"");
  estimate.observable = read_observable(map);
  const bool full = estimate.fully_observable();
  estimate.T_parent_child = full ? read_pose(map) : read_partial_pose(map, estimate.observable, parent_is_camera);
  read_stddev(map);
  const auto covariance = read_upper_triangle(map, "covariance_m_rad", 6, observable_rows({estimate}));
  if (covariance) estimate.covariance = *covariance;
  if (!covariance && full) estimate.covariance = covariance_of_stddev(map);
  map.finish("x-");
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

CameraUse read_use(const YamlTree& tree, const std::string& path, int camera, Problems* problems) {
  CameraUse use;
  MapReader map(tree, path, problems);
  map.require("camera", "a camera's name");
  use.camera = map.text("camera").value_or("");
  use.used = static_cast<int>(map.integer("used", {0.0, 1e9}).value_or(0));
  use.reprojection_rms_px = map.number("reprojection_rms_px", {0.0}).value_or(0.0);
  if (const YamlTree* left_out = map.find("left_out"))
    for (std::size_t i = 0; i < left_out->items.size(); ++i) {
      MapReader line(left_out->items[i], map.path_of("left_out") + "[" + std::to_string(i) + "]", problems);
      Exclusion exclusion;
      exclusion.camera = camera;
      exclusion.stop = static_cast<int>(line.integer("stop", {-1.0, 1e9}).value_or(-1));
      exclusion.file = line.text("file").value_or("");
      read_exclusion(&line, &exclusion);
      line.finish();
      use.left_out.push_back(exclusion);
    }
  map.finish("x-");
  return use;
}

ResidualSummary read_residual(const YamlTree& tree, const std::string& path, Problems* problems) {
  ResidualSummary residual;
  MapReader map(tree, path, problems);
  residual.name = map.text("name").value_or("");
  residual.unit = map.text("unit").value_or("");
  residual.count = static_cast<int>(map.integer("count", {0.0, 2e9}).value_or(0));
  residual.rms = map.number("rms", {0.0}).value_or(0.0);
  map.finish("x-");
  return residual;
}

EstimatedQuantity read_quantity(const YamlTree& tree, const std::string& path, Problems* problems) {
  EstimatedQuantity quantity;
  MapReader map(tree, path, problems);
  map.require("camera", "a camera's name");
  map.require("name", "what was estimated, with its unit");
  quantity.camera = map.text("camera").value_or("");
  quantity.name = map.text("name").value_or("");
  quantity.value = map.number("value", {}).value_or(0.0);
  quantity.sigma = map.number("sigma", {0.0}).value_or(0.0);
  quantity.prior_sigma = map.number("prior_sigma", {0.0}).value_or(0.0);
  map.finish("x-");
  return quantity;
}

void read_lists(MapReader& map, Result* result) {
  Problems* problems = &map.problems();
  if (const YamlTree* use = map.find("use"))
    for (std::size_t i = 0; i < use->items.size(); ++i)
      result->use.push_back(read_use(use->items[i], "use[" + std::to_string(i) + "]", static_cast<int>(i), problems));
  if (const YamlTree* residuals = map.find("residuals"))
    for (std::size_t i = 0; i < residuals->items.size(); ++i)
      result->residuals.push_back(read_residual(residuals->items[i], "residuals[" + std::to_string(i) + "]", problems));
  if (const YamlTree* also = map.find("also_estimated"))
    for (std::size_t i = 0; i < also->items.size(); ++i)
      result->also_estimated.push_back(
          read_quantity(also->items[i], "also_estimated[" + std::to_string(i) + "]", problems));
}

Result read_own(const YamlTree& tree, Problems* problems) {
  Result result;
  MapReader map(tree, "", problems);
  // Another kind of file is one problem; every key that it has is no further one.
  if (!map.text("format", {kFormat})) return result;
  map.require("version", "1 to " + std::to_string(kVersion));
  map.integer("version", {1.0, static_cast<double>(kVersion)});
  result.method = map.text("method").value_or("");
  map.require("status", "solved, partial or refused");
  const auto status = map.text("status", {"solved", "partial", "refused"});
  for (const ResultStatus candidate : kStatuses)
    if (status && *status == result_status_name(candidate)) result.status = candidate;
  result.reasons = read_findings(&map, "reasons", Severity::kRefusal);
  result.notes = read_findings(&map, "notes", Severity::kNote);
  if (const YamlTree* list = map.find("camera_to_robot"))
    result.camera_to_robot = read_estimates(*list, "camera_to_robot", false, problems);
  if (const YamlTree* list = map.find("camera_to_camera"))
    result.camera_to_camera = read_estimates(*list, "camera_to_camera", true, problems);
  const auto size = static_cast<Eigen::Index>(6 * result.camera_to_robot.size());
  result.joint_covariance =
      read_upper_triangle(map, "joint_covariance_m_rad", size, observable_rows(result.camera_to_robot));
  read_lists(map, &result);
  map.finish("x-");
  return result;
}

Result read_result(const YamlTree& tree, Problems* problems) {
  if (tree.is_map() && tree.find("format") != nullptr) return read_own(tree, problems);
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

Result load_result(const std::filesystem::path& file) {
  Problems problems;
  const YamlTree tree = read_yaml_file(file, kMaxBytes);
  Result result = read_result(tree, &problems);
  check_repeats(result.camera_to_robot, file.string(), &problems);
  check_repeats(result.camera_to_camera, file.string(), &problems);
  problems.sort();
  problems.throw_if_any();
  return result;
}

std::string result_schema() {
  std::vector<KeyLine> keys = {{"format", "text", std::string("what kind of file this is: ") + kFormat},
                               {"version", "integer", "of this format"},
                               {"method", "text", "what estimated it"},
                               {"status", "solved | partial | refused", "whether everything was answered"},
                               {"reasons[]", "", "why it is partial or refused"},
                               {"notes[]", "", "what the user should know"}};
  for (const std::string list : {"reasons", "notes"})
    for (const KeyLine& line : finding_keys(list)) keys.push_back(line);
  for (const std::string list : {"camera_to_robot[]", "camera_to_camera[]"}) {
    for (const KeyLine& line : std::vector<KeyLine>{
             {"", "",
              list[10] == 'r' ? "poses of the cameras in the robot" : "poses of each camera in each earlier one"},
             {".sentence", "text", "what the transform is, in words"},
             {".parent", "text", "frame that the pose is given in"},
             {".child", "text", "frame whose pose it is"},
             {".translation_m?", "numbers", "x, y, z; where all six degrees of freedom are determined"},
             {".quaternion_xyzw?", "numbers", "the same"},
             {".tx_m?", "number", "where some degrees of freedom are not determined: those that are"},
             {".ty_m?", "number", "the same"},
             {".tz_m?", "number", "the same"},
             {".roll_rad?", "number", "the same, of the camera's body axes: R = Rz(yaw) Ry(pitch) Rx(roll)"},
             {".pitch_rad?", "number", "the same"},
             {".yaw_rad?", "number", "the same"},
             {".unobservable?", "texts", "degrees of freedom that the data do not determine: tx ty tz rx ry rz"},
             {".stddev?", "", "one sigma, for people"},
             {".stddev.NAME", "number", "tx_cm ty_cm tz_cm rx_deg ry_deg rz_deg"},
             {".covariance_m_rad[]?", "numbers", "upper triangle, row by row, of what is determined"}})
      keys.push_back({list + line.path, line.type, line.description});
  }
  for (const KeyLine& line : std::vector<KeyLine>{
           {"joint_covariance_m_rad[]?", "numbers", "upper triangle of all of camera_to_robot together"},
           {"use[].camera", "text", "its name"},
           {"use[].used", "integer", "images that were used"},
           {"use[].reprojection_rms_px", "number", "over those images"},
           {"use[].left_out[].stop", "integer", "index of the stop; -1 = none"},
           {"use[].left_out[].file", "text", "the image"},
           {"use[].left_out[].reason", "text", "for people"},
           {"residuals[].name", "text", "what was measured"},
           {"residuals[].unit", "text", "of the root mean square"},
           {"residuals[].count", "integer", "numbers that were fitted"},
           {"residuals[].rms", "number", "root mean square"},
           {"also_estimated[]?", "", "what else was estimated"},
           {"also_estimated[].camera", "text", "of which camera"},
           {"also_estimated[].name", "text", "what, with its unit"},
           {"also_estimated[].value", "number", "the estimate"},
           {"also_estimated[].sigma", "number", "its standard deviation"},
           {"also_estimated[].prior_sigma", "number", "what was believed before"}})
    keys.push_back(line);
  for (const KeyLine& line : exclusion_keys("use[].left_out")) keys.push_back(line);
  return schema_of_keys("Rigproof result: results/METHOD.yaml", keys, kVersion);
}

void save_result(const Result& result, const std::filesystem::path& file, const Wording& wording) {
  write_file_atomically(file, emit_yaml(tree_of(result, wording)));
}

std::string sentence_of(const EstimatedTransform& transform) {
  return "pose of " + transform.child + " in " + transform.parent;
}

}  // namespace rigproof
