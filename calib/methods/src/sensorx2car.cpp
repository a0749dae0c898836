// SensorX2Car, camera to car (Yan et al. 2023): rotation from the forward direction and the vertical, which a network
// sees in single images or geometry finds between them.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "directions.h"
#include "horizon_directions.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/vision/image_pairs.h"
#include "rigproof/core/conventions.h"
#include "rival_result.h"
#include "turn_axes.h"
#include "vertical_lines.h"

namespace rigproof {
namespace {

using Eigen::Vector3d;

constexpr double kMatchSigma_px = 0.7;
// Weight of a step of a segment among steps that weigh the square of their length.
constexpr double kSegmentWeight_m2 = 0.1;
// Rotation that a straight step may show in the images; beyond it camera and robot move too differently.
const double kMaxDrift_rad = deg_to_rad(1.0);

// Where the camera went on a straight step, in its frame amid the step.
Vector3d went(const rivals::RelativePose& pose) {
  const Vector3d half = -0.5 * so3_log(pose.T_a_b.rotation);
  return so3_exp(half) * pose.T_a_b.translation;
}

// SensorX2Car (Yan et al. 2023), camera to car: rotation only, from the direction in which features stream on straight
// steps and the axis of the turns.
class SensorX2Car : public Method {
 public:
  MethodTraits traits() const override {
    return {
        "sensorx2car",
        "SensorX2Car (Yan et al. 2023): forward from straight steps, vertical from turns or plumb lines, by the images",
        "images, odometry, three straight steps; three turns, plumb lines or a network (--horizon)",
        "rotation only, camera to robot and camera to camera",
        MethodReads::kFeatures,
        2e-3};
  }

  std::optional<Finding> why_not(const MethodInput& input) const override {
    if (input.recording == nullptr) return Finding("method.needs_images");
    const Observations& observations = input.observations;
    std::size_t straight = rivals::straight_segment_steps(*input.recording);
    for (std::size_t i = 1; i < observations.stops.size(); ++i)
      straight += rivals::step_between(observations, static_cast<int>(i) - 1, static_cast<int>(i)).straight();
    if (straight >= rivals::kMinDirections) return {};
    return Finding("method.too_few_straight_steps", {{"steps", straight}});
  }

  Result solve(const Observations& observations) const override {
    Result result;
    result.method = traits().name;
    result.reasons = {*why_not({observations})};
    return result;
  }

  Result solve_recording(const MethodInput& input) const override {
    Result result;
    result.method = traits().name;
    if (input.recording == nullptr) return solve(input.observations);
    const Observations& observations = input.observations;
    rivals::HorizonDirections seen;
    seen.ahead.resize(observations.cameras.size());
    seen.up.resize(observations.cameras.size());
    if (input.horizon != nullptr) seen = rivals::directions_from_horizons(input, *input.horizon);
    follow_features(input, &seen.ahead, &seen.up);
    for (std::size_t k = 0; k < observations.cameras.size(); ++k)
      solve_camera(input, static_cast<int>(k), seen.ahead[k], seen.up[k], &result);
    add_pairs(&result);
    rivals::conclude_by_cameras(observations, &result);
    return result;
  }

 private:
  // What the network did not tell.
  static void follow_features(const MethodInput& input, std::vector<rivals::Directions>* forward,
                              std::vector<rivals::Directions>* up) {
    const Observations& observations = input.observations;
    const auto told = [](const rivals::Directions& directions) { return !directions.vectors.empty(); };
    const bool needs_forward = std::none_of(forward->begin(), forward->end(), told);
    const bool needs_up = std::none_of(up->begin(), up->end(), told);
    if (!needs_forward && !needs_up) return;
    const auto wanted = [&](int /*camera*/, int from, int to) {
      const rivals::Step step = rivals::step_between(observations, from, to);
      return step.straight() ? needs_forward : needs_up && step.turns();
    };
    const rivals::Features features(input);
    for (const rivals::ImagePair& pair : rivals::match_consecutive_images(input, features.source(), wanted))
      collect(input, pair, forward, up);
    if (!needs_forward) return;
    for (const rivals::ImagePair& pair : rivals::match_straight_segments(input, features.source()))
      collect_ahead(input, pair, forward);
  }

  static void collect(const MethodInput& input, const rivals::ImagePair& pair, std::vector<rivals::Directions>* forward,
                      std::vector<rivals::Directions>* up) {
    const auto k = static_cast<std::size_t>(pair.camera);
    const auto pose = rivals::relative_pose_of(input, pair, kMatchSigma_px);
    if (!pose) return;
    const rivals::Step step = rivals::step_between(input.observations, pair.from, pair.to);
    if (step.straight() && so3_log(pose->T_a_b.rotation).norm() < kMaxDrift_rad)
      (*forward)[k].add(step.forward_m > 0.0 ? went(*pose) : Vector3d(-went(*pose)), step.forward_m * step.forward_m);
    else if (const auto axis = rivals::turn_axis(step, *pose))
      (*up)[k].add(axis->up, axis->weight);
  }

  // A step of a straight segment; the robot drives ahead there. Their lengths are much the same.
  static void collect_ahead(const MethodInput& input, const rivals::ImagePair& pair,
                            std::vector<rivals::Directions>* forward) {
    const auto k = static_cast<std::size_t>(pair.camera);
    const auto pose = rivals::relative_pose_of(input, pair, kMatchSigma_px);
    if (!pose || so3_log(pose->T_a_b.rotation).norm() > kMaxDrift_rad) return;
    (*forward)[k].add(went(*pose), kSegmentWeight_m2);
  }

  static void solve_camera(const MethodInput& input, int k, const rivals::Directions& forward,
                           const rivals::Directions& up, Result* result) {
    const Observations& observations = input.observations;
    const std::string& name = observations.cameras[static_cast<std::size_t>(k)].name;
    const std::optional<Vector3d> x = forward.common();
    std::optional<Vector3d> z = up.common();
    std::string vertical = std::to_string(up.vectors.size()) + " turns or horizons";
    if (x && !z) {
      if (const auto plumb = rivals::plumb_direction(rivals::lines_of_camera(input, k), *x, k)) {
        z = plumb->up;
        vertical = std::to_string(plumb->lines) + " plumb lines in " + std::to_string(plumb->images) + " images";
      }
    }
    if (!x)
      result->reasons.push_back(Finding("camera.few_straight_steps", {{"steps", forward.vectors.size()}}).of(name));
    if (!z) result->reasons.push_back(Finding("camera.few_turns", {{"turns", up.vectors.size()}}).of(name));
    if (!x || !z) return;
    Eigen::Matrix3d R;
    R.row(2) = z->transpose();
    R.row(0) = (*x - z->dot(*x) * *z).normalized().transpose();
    R.row(1) = z->cross(R.row(0).transpose()).transpose();
    if (!R.allFinite()) return;
    EstimatedTransform transform =
        rivals::camera_in_robot(observations, k, Rigid3(Eigen::Quaterniond(R), Vector3d::Zero()));
    transform.observable = {false, false, false, true, true, true};
    result->camera_to_robot.push_back(transform);
    const double off_deg = std::abs(90.0 - rad_to_deg(std::acos(std::clamp(x->dot(*z), -1.0, 1.0))));
    result->notes.push_back(
        Finding("camera.axes_from", {{"steps", forward.vectors.size()}, {"vertical", vertical}, {"off_deg", off_deg}})
            .of(name));
  }

  static void add_pairs(Result* result) {
    for (std::size_t j = 0; j < result->camera_to_robot.size(); ++j) {
      for (std::size_t k = j + 1; k < result->camera_to_robot.size(); ++k) {
        const EstimatedTransform &first = result->camera_to_robot[j], &second = result->camera_to_robot[k];
        result->camera_to_camera.push_back({first.child, second.child,
                                            first.T_parent_child.inverse() * second.T_parent_child, std::nullopt,
                                            first.observable});
      }
    }
  }
};

}  // namespace

std::vector<const Method*> sensorx2car_methods() {
  static const SensorX2Car method;
  return {&method};
}

}  // namespace rigproof
