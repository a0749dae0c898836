#include "rigproof/validate/budget.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigproof/core/conventions.h"
#include "rigproof/core/fields.h"
#include "rigproof/core/figures.h"
#include "rigproof/core/text.h"
#include "said.h"

namespace rigproof {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

// A block of a budget file; 0 = not limited.
struct LimitFields {
  std::array<double, 3> axis_cm{};
  std::array<double, 3> axis_deg{};
  double distance_cm = 0.0;
  double angle_deg = 0.0;

  void visit(FieldVisitor& visitor) {
    const NumberRange range{0.0, 1e6};
    visitor.field("tx_cm", axis_cm[0], range, "Limit on |error| along the parent's x axis, 0 = none");
    visitor.field("ty_cm", axis_cm[1], range, "Limit on |error| along the parent's y axis, 0 = none");
    visitor.field("tz_cm", axis_cm[2], range, "Limit on |error| along the parent's z axis, 0 = none");
    visitor.field("rx_deg", axis_deg[0], range, "Limit on |error| about the parent's x axis, 0 = none");
    visitor.field("ry_deg", axis_deg[1], range, "Limit on |error| about the parent's y axis, 0 = none");
    visitor.field("rz_deg", axis_deg[2], range, "Limit on |error| about the parent's z axis, 0 = none");
    visitor.field("distance_cm", distance_cm, range, "Limit of every translation that has none of its own, 0 = none");
    visitor.field("angle_deg", angle_deg, range, "Limit of every rotation that has none of its own, 0 = none");
  }

  std::optional<Vector6d> limits() const {
    const auto first_given = [](double own, double shared) {
      return own > 0.0 ? own : shared > 0.0 ? shared : kUnlimited;
    };
    Vector6d limits;
    for (std::size_t i = 0; i < 3; ++i) {
      limits[static_cast<Eigen::Index>(i)] = 0.01 * first_given(axis_cm[i], distance_cm);
      limits[static_cast<Eigen::Index>(i + 3)] = deg_to_rad(first_given(axis_deg[i], angle_deg));
    }
    if (!(limits.minCoeff() < kUnlimited)) return std::nullopt;
    return limits;
  }
};

struct BudgetFields {
  LimitFields camera_to_robot;
  LimitFields camera_to_camera;
  double max_z = 0.0;

  void visit(FieldVisitor& visitor) {
    visitor.nested("camera_to_robot", camera_to_robot, "Limits on the pose of each camera in the robot frame");
    visitor.nested("camera_to_camera", camera_to_camera, "Limits on the pose of each camera in each earlier camera");
    visitor.field("max_z", max_z, {0.0, 1e6}, "Limit on |error / stated sigma| of every axis, 0 = none");
    visitor.check(camera_to_robot.limits() || camera_to_camera.limits() || max_z > 0.0, "max_z",
                  "a budget needs at least one limit: max_z, or one in camera_to_robot or camera_to_camera");
  }
};

const char* unit_of(int axis) { return axis < 3 ? "cm" : "deg"; }

Check missing_pose(const std::string& camera) {
  Check check;
  check.subject = camera + " in robot";
  check.name = check.subject + ": pose";
  check.reason = Finding("gate.no_pose");
  return check;
}

Check check_of(const TransformError& error, int axis, const std::string& unit, double value, double limit) {
  Check check;
  check.subject = error.name();
  check.name = check.subject + ": " + kDegreeOfFreedomNames[static_cast<std::size_t>(axis)];
  check.axis = axis;
  check.between_cameras = error.between_cameras;
  check.unit = unit;
  check.value = value;
  check.limit = limit;
  return check;
}

Check absolute_check(const TransformError& error, int axis, double limit) {
  const double size = std::abs(error.error[axis]);
  Check check = check_of(error, axis, unit_of(axis), in_unit(size, axis), in_unit(limit, axis));
  check.passed = size <= limit;
  if (!error.observable[static_cast<std::size_t>(axis)]) {
    check.passed = false;
    check.reason = Finding("gate.unanswered");
  }
  return check;
}

void add_checks(const TransformError& error, const std::optional<Vector6d>& limits, const std::optional<double>& max_z,
                Gate* gate) {
  for (int axis = 0; axis < 6; ++axis) {
    if (limits && std::isfinite((*limits)[axis])) gate->checks.push_back(absolute_check(error, axis, (*limits)[axis]));
    const std::optional<double> z = max_z ? error.z(axis) : std::nullopt;
    if (!z) continue;
    gate->checks.push_back(check_of(error, axis, "sigma", std::abs(*z), *max_z));
    gate->checks.back().passed = std::abs(*z) <= *max_z;
  }
  if (max_z && !error.sigma) gate->notes.push_back(Finding("gate.no_sigma", {{"subject", error.name()}}));
}

std::string describe_limits(const Vector6d& limits) {
  const bool same_distance = limits.head<3>().isConstant(limits[0]),
             same_angle = limits.tail<3>().isConstant(limits[3]);
  std::string text;
  for (int axis = 0; axis < 6; ++axis) {
    if (!std::isfinite(limits[axis])) continue;
    if ((axis == 1 || axis == 2) && same_distance) continue;
    if (axis > 3 && same_angle) continue;
    text += (text.empty() ? "" : ", ") + plain_figure(in_unit(limits[axis], axis)) + " " + unit_of(axis);
  }
  return text;
}

}  // namespace

Budget load_budget(const std::filesystem::path& file) {
  BudgetFields fields;
  read_fields(file, [&fields](FieldVisitor& visitor) { fields.visit(visitor); });
  Budget budget;
  budget.camera_to_robot = fields.camera_to_robot.limits();
  budget.camera_to_camera = fields.camera_to_camera.limits();
  if (fields.max_z > 0.0) budget.max_z = fields.max_z;
  budget.nothing_suspected = true;
  budget.name = file.filename().string();
  return budget;
}

Budget default_budget() {
  Budget budget;
  budget.max_z = 4.0;
  return budget;
}

std::string describe(const Budget& budget) {
  std::string text;
  const auto append = [&text](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  if (budget.camera_to_robot) append(describe_limits(*budget.camera_to_robot));
  if (budget.camera_to_camera) append("between cameras " + describe_limits(*budget.camera_to_camera));
  if (budget.max_z) append(plain_figure(*budget.max_z) + " sigma");
  return text;
}

std::string budget_schema() { return schema_of<BudgetFields>("Rigproof budget"); }

std::string Check::message(const Wording& wording) const {
  if (reason) return said(*reason, wording);
  return plain_figure(value) + " " + unit + ", allowed " + plain_figure(limit) + " " + unit;
}

bool Gate::passed() const { return !checks.empty() && failures() == 0; }

std::size_t Gate::failures() const {
  return static_cast<std::size_t>(
      std::count_if(checks.begin(), checks.end(), [](const Check& check) { return !check.passed; }));
}

Gate apply_budget(const Comparison& comparison, const Budget& budget) {
  Gate gate;
  // A method for camera to camera alone owes no pose in the robot, unless the budget limits those.
  const bool pairs_only = comparison.status == ResultStatus::kSolved && comparison.camera_to_robot.empty() &&
                          !comparison.camera_to_camera.empty() && !budget.camera_to_robot;
  if (pairs_only)
    gate.notes.emplace_back("gate.pairs_only");
  else
    for (const std::string& camera : comparison.missing_cameras) gate.checks.push_back(missing_pose(camera));
  for (const TransformError& error : comparison.camera_to_robot)
    add_checks(error, budget.camera_to_robot, budget.max_z, &gate);
  for (const TransformError& error : comparison.camera_to_camera)
    add_checks(error, budget.camera_to_camera, budget.max_z, &gate);
  return gate;
}

void add_suspicions(const std::vector<Finding>& notes, Gate* gate) {
  for (const Finding& note : notes) {
    if (note.severity != Severity::kSuspect) continue;
    Check& check = gate->checks.emplace_back();
    check.name = "nothing suspected";
    check.subject = note.cameras.empty() ? "result" : joined(note.cameras);
    check.reason = note;
  }
}

}  // namespace rigproof
