#include <algorithm>

#include "rigproof/calib/plan/accept.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/fields.h"

namespace rigproof {
namespace {

constexpr NumberRange kLimit{0.0, 1e6};

struct UncertaintyFields {
  double xy_mm = 0.0, z_mm = 0.0, angle_deg = 0.0;

  bool any() const { return xy_mm > 0.0 || z_mm > 0.0 || angle_deg > 0.0; }
  void visit(FieldVisitor& visitor) {
    visitor.field("xy_mm", xy_mm, kLimit, "Limit on one sigma along the robot's x and y, 0 = none");
    visitor.field("z_mm", z_mm, kLimit, "Limit on one sigma of the height, 0 = none");
    visitor.field("angle_deg", angle_deg, kLimit, "Limit on one sigma about each axis of the robot, 0 = none");
  }
};

struct BetweenFields {
  double distance_mm = 0.0, angle_deg = 0.0;

  void visit(FieldVisitor& visitor) {
    visitor.field("distance_mm", distance_mm, kLimit, "Limit on one sigma along each axis, 0 = none");
    visitor.field("angle_deg", angle_deg, kLimit, "Limit on one sigma about each axis, 0 = none");
  }
};

struct SplitHalfFields {
  double max_z = 0.0;

  void visit(FieldVisitor& visitor) {
    visitor.field("max_z", max_z, kLimit,
                  "Limit on |difference| of the two halves of the drive over its stated sigma, 0 = not checked");
  }
};

struct HeldOutFields {
  double max_ratio = 0.0;
  std::int64_t folds = 5;

  void visit(FieldVisitor& visitor) {
    visitor.field("max_ratio", max_ratio, kLimit,
                  "Limit on the whitened chi-square a dimension of images that were left out, 0 = not checked");
    visitor.field("folds", folds, {2.0, 100.0}, "Solutions, each of which leaves out the images of every n-th stop");
  }
};

struct AcceptFields {
  UncertaintyFields uncertainty;
  BetweenFields between_cameras;
  SplitHalfFields split_half;
  HeldOutFields held_out;

  void visit(FieldVisitor& visitor) {
    visitor.nested("uncertainty", uncertainty, "Limits on what the method states about each camera in the robot");
    visitor.nested("between_cameras", between_cameras,
                   "Limits on what it states about each camera in each earlier one");
    visitor.nested("split_half", split_half, "Repeatability: both halves of the drive solved by themselves");
    visitor.nested("held_out", held_out, "Prediction of images by the others");
    visitor.check(uncertainty.any() || between_cameras.distance_mm > 0.0 || between_cameras.angle_deg > 0.0 ||
                      split_half.max_z > 0.0 || held_out.max_ratio > 0.0,
                  "uncertainty", "at least one limit is needed: uncertainty, between_cameras, split_half or held_out");
  }
};

std::optional<double> limit(double value, double unit) {
  return value > 0.0 ? std::optional<double>(value * unit) : std::nullopt;
}

}  // namespace

AcceptCriteria load_accept_criteria(const std::filesystem::path& file) {
  AcceptFields fields;
  read_fields(file, [&fields](FieldVisitor& visitor) { fields.visit(visitor); });
  AcceptCriteria criteria;
  if (fields.uncertainty.any())
    criteria.uncertainty = AcceptLimits{fields.uncertainty.xy_mm / 1000.0, fields.uncertainty.z_mm / 1000.0,
                                        deg_to_rad(fields.uncertainty.angle_deg)};
  criteria.between_distance_m = limit(fields.between_cameras.distance_mm, 0.001);
  criteria.between_angle_rad = limit(fields.between_cameras.angle_deg, deg_to_rad(1.0));
  criteria.split_half_max_z = limit(fields.split_half.max_z, 1.0);
  criteria.held_out_max_ratio = limit(fields.held_out.max_ratio, 1.0);
  criteria.held_out_folds = static_cast<int>(fields.held_out.folds);
  criteria.name = file.filename().string();
  return criteria;
}

std::string accept_criteria_schema() { return schema_of<AcceptFields>("Rigproof acceptance"); }

bool AcceptReport::passed() const { return !checks.empty() && failures() == 0; }

std::size_t AcceptReport::failures() const {
  return static_cast<std::size_t>(
      std::count_if(checks.begin(), checks.end(), [](const AcceptCheck& check) { return !check.passed; }));
}

}  // namespace rigproof
