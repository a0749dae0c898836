// Wrong conventions are undone one by one (and the few that occur together, in twos) and the truth tells which fits.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "rigproof/core/conventions.h"
#include "rigproof/validate/body_angles.h"
#include "rigproof/validate/validate.h"

namespace rigproof {
namespace {

using Poses = std::vector<Rigid3>;

constexpr double kGrossMetres = 0.02, kGrossRadians = deg_to_rad(2.0);
constexpr double kPlausibleMetres = 0.15, kPlausibleRadians = deg_to_rad(8.0);
constexpr double kTimesBetter = 10.0;

struct Misfit {
  double metres = 0.0;   // worst camera
  double radians = 0.0;  // worst camera
  // One number for ranking: ten centimetres weigh as much as a tenth of a radian.
  double score() const { return std::hypot(metres, radians); }
};

Misfit misfit_of(const Poses& estimates, const Poses& truths) {
  Misfit misfit;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const Vector6d error = transform_error(estimates[i], truths[i]);
    misfit.metres = std::max(misfit.metres, error.head<3>().norm());
    misfit.radians = std::max(misfit.radians, error.tail<3>().norm());
  }
  return misfit;
}

// How one convention is undone.
struct Correction {
  Finding convention;
  std::function<Rigid3(const Rigid3&)> undo;
  bool combines = false;  // is also tried together with the others that combine
};

Correction scaled(double factor, const Finding& convention) {
  return {convention, [factor](const Rigid3& T) { return Rigid3(T.rotation, factor * T.translation); }, true};
}

Correction turned_child(const Eigen::Quaterniond& rotation, const Finding& convention) {
  return {convention, [rotation](const Rigid3& T) { return Rigid3(T.rotation * rotation, T.translation); }, true};
}

Correction turned_parent(const Eigen::Quaterniond& rotation, const Finding& convention) {
  return {convention, [rotation](const Rigid3& T) { return Rigid3(rotation, Eigen::Vector3d::Zero()) * T; }};
}

void add_inversions(std::vector<Correction>* list) {
  list->push_back({Finding("convention.inverted"), [](const Rigid3& T) { return T.inverse(); }, true});
  list->push_back({Finding("convention.rotations_inverted"),
                   [](const Rigid3& T) { return Rigid3(T.rotation.conjugate(), T.translation); }});
  list->push_back({Finding("convention.translations_in_camera"),
                   [](const Rigid3& T) { return Rigid3(T.rotation, T.inverse().translation); }});
}

void add_units(std::vector<Correction>* list) {
  const auto in = [](const char* unit) { return Finding("convention.unit", {{"unit", unit}}); };
  list->push_back(scaled(1e-3, in("millimetres")));
  list->push_back(scaled(1e-2, in("centimetres")));
  for (const double by : {1e3, 1e2}) list->push_back(scaled(by, Finding("convention.divided", {{"by", by}})));
  list->push_back(scaled(0.0254, in("inches")));
  const auto angles = [](const char* which) { return Finding("convention.radians_as_degrees", {{"angles", which}}); };
  // A small angle leaves no trace of its axis order, so the rotation vector stands for roll, pitch and yaw as well.
  list->push_back({angles("rotation_vector"), [](const Rigid3& T) {
                     return Rigid3(so3_exp(rad_to_deg(1.0) * so3_log(T.rotation)), T.translation);
                   }});
  list->push_back({angles("roll_pitch_yaw"), [](const Rigid3& T) {
                     return Rigid3(from_roll_pitch_yaw(rad_to_deg(1.0) * roll_pitch_yaw(T.rotation)), T.translation);
                   }});
}

void add_axes(std::vector<Correction>* list) {
  const Eigen::Quaterniond optical_body = optical_from_body();
  const Eigen::Quaterniond quarter = rotation_z(0.5 * kPi);
  const Eigen::Quaterniond half_x(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()));
  const auto camera = [](const char* frame) { return Finding("convention.camera_axes", {{"frame", frame}}); };
  list->push_back(turned_child(optical_body.conjugate(), camera("body")));
  list->push_back(turned_child(optical_body, Finding("convention.optical_twice")));
  list->push_back(turned_child(half_x, camera("opengl")));
  list->push_back(turned_child(rotation_z(kPi), camera("upside_down")));
  const auto robot = [](const char* frame) { return Finding("convention.robot_axes", {{"frame", frame}}); };
  list->push_back(turned_parent(optical_body.conjugate(), robot("optical")));
  list->push_back(turned_parent(quarter, robot("x_right")));
  list->push_back(turned_parent(quarter.conjugate(), robot("x_left")));
  list->push_back(turned_parent(rotation_z(kPi), robot("x_backward")));
  list->push_back(turned_parent(half_x, robot("z_down")));
}

void add_mirrors(std::vector<Correction>* list) {
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d sign = Eigen::Vector3d::Ones();
    sign[axis] = -1.0;
    const std::string name(1, static_cast<char>('x' + axis));
    list->push_back({Finding("convention.translations_mirrored", {{"axis", name}}),
                     [sign](const Rigid3& T) { return Rigid3(T.rotation, T.translation.cwiseProduct(sign)); }});
    for (int camera_axis = 0; camera_axis < 3; ++camera_axis) {
      Eigen::Vector3d camera_sign = Eigen::Vector3d::Ones();
      camera_sign[camera_axis] = -1.0;
      const std::string camera_name(1, static_cast<char>('x' + camera_axis));
      list->push_back({Finding("convention.left_handed", {{"robot_axis", name}, {"camera_axis", camera_name}}),
                       [sign, camera_sign](const Rigid3& T) {
                         const Eigen::Matrix3d R = sign.asDiagonal() * T.rotation_matrix() * camera_sign.asDiagonal();
                         return Rigid3(Eigen::Quaterniond(R), T.translation.cwiseProduct(sign));
                       }});
    }
  }
}

void add_quaternion_orders(std::vector<Correction>* list) {
  list->push_back({Finding("convention.quaternion_order"),
                   [](const Rigid3& T) {
                     const Eigen::Vector4d q = T.rotation.coeffs();  // x y z w as read
                     return Rigid3(Eigen::Quaterniond(q[0], q[1], q[2], q[3]), T.translation);
                   },
                   true});
  list->push_back({Finding("convention.quaternions_reordered"), [](const Rigid3& T) {
                     const Eigen::Vector4d q = T.rotation.coeffs();
                     return Rigid3(Eigen::Quaterniond(q[2], q[3], q[0], q[1]), T.translation);
                   }});
}

const std::vector<Correction>& corrections() {
  static const std::vector<Correction> list = [] {
    std::vector<Correction> built;
    add_inversions(&built);
    add_units(&built);
    add_axes(&built);
    add_mirrors(&built);
    add_quaternion_orders(&built);
    return built;
  }();
  return list;
}

struct Candidate {
  Finding convention;
  Misfit misfit;
};

Poses apply(const std::function<Rigid3(const Rigid3&)>& undo, const Poses& poses) {
  Poses corrected;
  for (const Rigid3& T : poses) corrected.push_back(undo(T));
  return corrected;
}

bool convincing(const Misfit& corrected, const Misfit& now) {
  return corrected.metres <= kPlausibleMetres && corrected.radians <= kPlausibleRadians &&
         kTimesBetter * corrected.score() <= now.score();
}

void keep_better(const Candidate& candidate, std::optional<Candidate>* best) {
  if (!*best || candidate.misfit.score() < (*best)->misfit.score()) *best = candidate;
}

std::optional<Candidate> best_single(const Poses& estimates, const Poses& truths) {
  std::optional<Candidate> best;
  for (const Correction& correction : corrections())
    keep_better({correction.convention, misfit_of(apply(correction.undo, estimates), truths)}, &best);
  return best;
}

std::optional<Candidate> best_pair(const Poses& estimates, const Poses& truths) {
  std::optional<Candidate> best;
  for (const Correction& first : corrections()) {
    if (!first.combines) continue;
    const Poses once = apply(first.undo, estimates);
    for (const Correction& second : corrections())
      if (second.combines && &second != &first)
        keep_better({first.convention.by({second.convention}), misfit_of(apply(second.undo, once), truths)}, &best);
  }
  return best;
}

// Angles in degrees that were read as radians wrap around many times and cannot be undone; but the truth spoilt in the
// same way must come near, its error grown by 57.3.
std::optional<Candidate> degrees_read_as_radians(const Poses& estimates, const Poses& truths) {
  const double factor = rad_to_deg(1.0);
  const std::array<std::function<Eigen::Quaterniond(const Eigen::Quaterniond&)>, 3> spoil = {
      [&](const Eigen::Quaterniond& q) { return so3_exp(factor * so3_log(q)); },
      [&](const Eigen::Quaterniond& q) { return from_roll_pitch_yaw(factor * roll_pitch_yaw(q)); },
      [&](const Eigen::Quaterniond& q) {
        const Eigen::Quaterniond body = optical_from_body();
        return from_roll_pitch_yaw(factor * roll_pitch_yaw(q * body)) * body.conjugate();
      }};
  std::optional<Candidate> best;
  for (const auto& rule : spoil) {
    Poses spoilt;
    for (const Rigid3& T : truths) spoilt.push_back(Rigid3(rule(T.rotation), T.translation));
    Misfit misfit = misfit_of(estimates, spoilt);
    // Beyond half a radian of the spoilt rotation agreement may be chance (one in 150 for a single camera).
    if (misfit.radians > 0.5) continue;
    misfit.radians /= factor;
    keep_better({Finding("convention.degrees_as_radians"), misfit}, &best);
  }
  return best;
}

// The nearest true camera to each pose, if that is a permutation.
std::optional<Candidate> permuted_names(const std::vector<TransformError>& errors, const Poses& estimates,
                                        const Poses& truths) {
  Poses matched;
  std::set<std::size_t> taken;
  std::vector<Finding> swaps;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    std::size_t nearest = 0;
    for (std::size_t j = 1; j < truths.size(); ++j)
      if (misfit_of({estimates[i]}, {truths[j]}).score() < misfit_of({estimates[i]}, {truths[nearest]}).score())
        nearest = j;
    if (!taken.insert(nearest).second) return std::nullopt;
    matched.push_back(truths[nearest]);
    if (nearest != i)
      swaps.push_back(Finding("convention.name", {{"called", errors[i].child}, {"is", errors[nearest].child}}));
  }
  if (swaps.empty()) return std::nullopt;
  return Candidate{Finding("convention.names_exchanged").by(swaps), misfit_of(estimates, matched)};
}

}  // namespace

std::optional<ConventionSuspicion> find_convention_suspicion(const std::vector<TransformError>& camera_to_robot) {
  Poses estimates, truths;
  for (const TransformError& error : camera_to_robot) {
    if (!error.fully_observable()) continue;
    estimates.push_back(error.T_estimate);
    truths.push_back(error.T_true);
  }
  if (estimates.empty()) return std::nullopt;
  const Misfit now = misfit_of(estimates, truths);
  if (now.metres < kGrossMetres && now.radians < kGrossRadians) return std::nullopt;
  std::optional<Candidate> best = best_single(estimates, truths);
  if (const auto candidate = degrees_read_as_radians(estimates, truths)) keep_better(*candidate, &best);
  if (estimates.size() == camera_to_robot.size())
    if (const auto candidate = permuted_names(camera_to_robot, estimates, truths)) keep_better(*candidate, &best);
  if (!best || !convincing(best->misfit, now)) best = best_pair(estimates, truths);
  if (!best || !convincing(best->misfit, now)) return std::nullopt;
  return ConventionSuspicion{best->convention, now.metres, now.radians, best->misfit.metres, best->misfit.radians};
}

}  // namespace rigproof
