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
  std::string explanation;
  std::function<Rigid3(const Rigid3&)> undo;
  bool combines = false;  // is also tried together with the others that combine
};

Correction scaled(double factor, const std::string& explanation) {
  return {explanation, [factor](const Rigid3& T) { return Rigid3(T.rotation, factor * T.translation); }, true};
}

Correction turned_child(const Eigen::Quaterniond& rotation, const std::string& explanation) {
  return {explanation, [rotation](const Rigid3& T) { return Rigid3(T.rotation * rotation, T.translation); }, true};
}

Correction turned_parent(const Eigen::Quaterniond& rotation, const std::string& explanation) {
  return {explanation, [rotation](const Rigid3& T) { return Rigid3(rotation, Eigen::Vector3d::Zero()) * T; }};
}

void add_inversions(std::vector<Correction>* list) {
  list->push_back(
      {"matches the truth only when inverted: it gives the robot in the camera, not the camera in the robot",
       [](const Rigid3& T) { return T.inverse(); }, true});
  list->push_back({"matches the truth only with the rotations inverted",
                   [](const Rigid3& T) { return Rigid3(T.rotation.conjugate(), T.translation); }});
  list->push_back({"matches the truth only with the translations replaced by -R^T t: they are in the camera's axes",
                   [](const Rigid3& T) { return Rigid3(T.rotation, T.inverse().translation); }});
}

void add_units(std::vector<Correction>* list) {
  list->push_back(scaled(1e-3, "the translations are in millimetres, not metres"));
  list->push_back(scaled(1e-2, "the translations are in centimetres, not metres"));
  list->push_back(scaled(1e3, "the translations were divided by 1000 once too often"));
  list->push_back(scaled(1e2, "the translations were divided by 100 once too often"));
  list->push_back(scaled(0.0254, "the translations are in inches, not metres"));
  // A small angle leaves no trace of its axis order, so the rotation vector stands for roll, pitch and yaw as well.
  list->push_back(
      {"the rotations were given in radians and read as degrees: all angles are 57.3 times too small",
       [](const Rigid3& T) { return Rigid3(so3_exp(rad_to_deg(1.0) * so3_log(T.rotation)), T.translation); }});
  list->push_back({"roll, pitch and yaw were given in radians and read as degrees: all angles are 57.3 times too small",
                   [](const Rigid3& T) {
                     return Rigid3(from_roll_pitch_yaw(rad_to_deg(1.0) * roll_pitch_yaw(T.rotation)), T.translation);
                   }});
}

void add_axes(std::vector<Correction>* list) {
  const Eigen::Quaterniond optical_body = optical_from_body();
  const Eigen::Quaterniond quarter = rotation_z(0.5 * kPi);
  const Eigen::Quaterniond half_x(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()));
  list->push_back(
      turned_child(optical_body.conjugate(),
                   "the camera's axes are body axes (x forward, z up), not optical axes (z forward, y down)"));
  list->push_back(turned_child(optical_body, "the turn from optical to body axes was applied once too often"));
  list->push_back(
      turned_child(half_x, "the camera's axes are OpenGL's (y up, z backward), not optical (y down, z forward)"));
  list->push_back(turned_child(rotation_z(kPi), "the camera's axes are turned by 180 degrees about the optical axis"));
  list->push_back(turned_parent(optical_body.conjugate(),
                                "the robot's axes are optical (x right, y down, z forward), not x forward, z up"));
  list->push_back(turned_parent(quarter, "the robot's axes are x right, y forward, not x forward, y left"));
  list->push_back(turned_parent(quarter.conjugate(), "the robot's axes are x left, y backward, not x forward, y left"));
  list->push_back(turned_parent(rotation_z(kPi), "the robot's x axis points backward"));
  list->push_back(turned_parent(half_x, "the robot's axes are x forward, y right, z down, not y left, z up"));
}

void add_mirrors(std::vector<Correction>* list) {
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d sign = Eigen::Vector3d::Ones();
    sign[axis] = -1.0;
    const std::string name(1, static_cast<char>('x' + axis));
    list->push_back({"the " + name + " axis of the translations is mirrored",
                     [sign](const Rigid3& T) { return Rigid3(T.rotation, T.translation.cwiseProduct(sign)); }});
    for (int camera_axis = 0; camera_axis < 3; ++camera_axis) {
      Eigen::Vector3d camera_sign = Eigen::Vector3d::Ones();
      camera_sign[camera_axis] = -1.0;
      const std::string camera_name(1, static_cast<char>('x' + camera_axis));
      list->push_back({"the " + name + " axis of the robot and the " + camera_name +
                           " axis of the camera are mirrored (a left-handed frame)",
                       [sign, camera_sign](const Rigid3& T) {
                         const Eigen::Matrix3d R = sign.asDiagonal() * T.rotation_matrix() * camera_sign.asDiagonal();
                         return Rigid3(Eigen::Quaterniond(R), T.translation.cwiseProduct(sign));
                       }});
    }
  }
}

void add_quaternion_orders(std::vector<Correction>* list) {
  list->push_back({"the quaternions are in the order w x y z, not x y z w",
                   [](const Rigid3& T) {
                     const Eigen::Vector4d q = T.rotation.coeffs();  // x y z w as read
                     return Rigid3(Eigen::Quaterniond(q[0], q[1], q[2], q[3]), T.translation);
                   },
                   true});
  list->push_back(
      {"the quaternions were turned from x y z w to y z w x: their order was already right", [](const Rigid3& T) {
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
  std::string explanation;
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
    keep_better({correction.explanation, misfit_of(apply(correction.undo, estimates), truths)}, &best);
  return best;
}

std::optional<Candidate> best_pair(const Poses& estimates, const Poses& truths) {
  std::optional<Candidate> best;
  for (const Correction& first : corrections()) {
    if (!first.combines) continue;
    const Poses once = apply(first.undo, estimates);
    for (const Correction& second : corrections())
      if (second.combines && &second != &first)
        keep_better(
            {first.explanation + "; moreover " + second.explanation, misfit_of(apply(second.undo, once), truths)},
            &best);
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
    keep_better({"the rotations were given in degrees and read as radians", misfit}, &best);
  }
  return best;
}

// The nearest true camera to each pose, if that is a permutation.
std::optional<Candidate> permuted_names(const std::vector<TransformError>& errors, const Poses& estimates,
                                        const Poses& truths) {
  Poses matched;
  std::set<std::size_t> taken;
  std::string swaps;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    std::size_t nearest = 0;
    for (std::size_t j = 1; j < truths.size(); ++j)
      if (misfit_of({estimates[i]}, {truths[j]}).score() < misfit_of({estimates[i]}, {truths[nearest]}).score())
        nearest = j;
    if (!taken.insert(nearest).second) return std::nullopt;
    matched.push_back(truths[nearest]);
    if (nearest != i)
      swaps += (swaps.empty() ? "" : ", ") + ("what it calls " + errors[i].child + " is " + errors[nearest].child);
  }
  if (swaps.empty()) return std::nullopt;
  return Candidate{"the camera names are exchanged: " + swaps, misfit_of(estimates, matched)};
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
  return ConventionSuspicion{best->explanation, now.metres, now.radians, best->misfit.metres, best->misfit.radians};
}

}  // namespace rigproof
