// RobotAutocalib as published: motions and points of the ground from image features.
#include <algorithm>
#include <cmath>

#include "directions.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/vision/image_pairs.h"
#include "rigproof/core/conventions.h"
#include "rival_result.h"
#include "robot_autocalib.h"
#include "turn_axes.h"

namespace rigproof {
namespace {

using rivals::AutocalibSensor;

constexpr double kMatchSigma_px = 0.7;
constexpr std::size_t kMinGroundPoints = 20;
// Points of one level differ in height by the noise of triangulation.
constexpr double kLevelTolerance = 0.04;

/// A step of a camera in units of its own length, with the points that both images show.
struct FeatureMotion {
  int from = 0, to = 0;
  rivals::RelativePose pose;
  std::vector<Eigen::Vector3d> points;
};

std::size_t points_at_depth(const std::vector<double>& depths, double depth) {
  return static_cast<std::size_t>(std::count_if(
      depths.begin(), depths.end(), [depth](double d) { return std::abs(d - depth) < kLevelTolerance * depth; }));
}

// How far below the camera the ground lies, in lengths of the step: the lowest level that half as many points share as
// the fullest one.
std::optional<double> ground_depth(const FeatureMotion& motion, const Eigen::Vector3d& up) {
  std::vector<double> depths;
  for (const Eigen::Vector3d& point : motion.points)
    if (-up.dot(point) > 0.0) depths.push_back(-up.dot(point));
  std::size_t fullest = 0;
  for (const double depth : depths) fullest = std::max(fullest, points_at_depth(depths, depth));
  if (fullest < kMinGroundPoints) return std::nullopt;
  std::sort(depths.begin(), depths.end());
  double lowest = 0.0;
  for (const double depth : depths)
    if (2 * points_at_depth(depths, depth) >= fullest) lowest = depth;
  // The fullest place near there, then the mean around it.
  double best = lowest;
  for (const double depth : depths)
    if (std::abs(depth - lowest) < 2.0 * kLevelTolerance * lowest &&
        points_at_depth(depths, depth) > points_at_depth(depths, best))
      best = depth;
  double sum = 0.0;
  for (const double depth : depths) sum += std::abs(depth - best) < kLevelTolerance * best ? depth : 0.0;
  return sum / static_cast<double>(points_at_depth(depths, best));
}

std::vector<FeatureMotion> motions_of(const MethodInput& input, const std::vector<rivals::ImagePair>& pairs,
                                      int camera) {
  std::vector<FeatureMotion> motions;
  for (const rivals::ImagePair& pair : pairs) {
    if (pair.camera != camera) continue;
    const auto pose = rivals::relative_pose_of(input, pair, kMatchSigma_px);
    if (!pose) continue;
    FeatureMotion motion{pair.from, pair.to, *pose, {}};
    for (const rivals::RayMatch& match : pose->inliers)
      if (const auto point = rivals::triangulate(pose->T_a_b, match)) motion.points.push_back(*point);
    motions.push_back(std::move(motion));
  }
  return motions;
}

// The axis of the turns; its sense is the odometry's.
std::optional<Eigen::Vector3d> vertical_of(const Observations& observations,
                                           const std::vector<FeatureMotion>& motions) {
  rivals::Directions up;
  for (const FeatureMotion& motion : motions) {
    if (const auto axis = rivals::turn_axis(rivals::step_between(observations, motion.from, motion.to), motion.pose))
      up.add(axis->up, axis->weight);
  }
  return up.common();
}

// The ground gives all steps of a camera one unit: its height.
AutocalibSensor sensor_from_images(const MethodInput& input, const std::vector<rivals::ImagePair>& pairs, int camera) {
  AutocalibSensor sensor;
  sensor.name = input.observations.cameras[static_cast<std::size_t>(camera)].name;
  const std::vector<FeatureMotion> motions = motions_of(input, pairs, camera);
  const std::optional<Eigen::Vector3d> up = vertical_of(input.observations, motions);
  if (!up) return sensor;
  const std::vector<Rigid3> odometry = odometry_poses(input.observations);
  for (const FeatureMotion& motion : motions) {
    const std::optional<double> depth = ground_depth(motion, *up);
    if (!depth) continue;
    Rigid3 B = motion.pose.T_a_b;
    B.translation /= *depth;
    sensor.motions.push_back(
        {motion.from, motion.to,
         odometry[static_cast<std::size_t>(motion.from)].inverse() * odometry[static_cast<std::size_t>(motion.to)], B});
    for (const Eigen::Vector3d& point : motion.points)
      if (std::abs(-up->dot(point) - *depth) < kLevelTolerance * *depth) sensor.ground_points.push_back(point / *depth);
  }
  return sensor;
}

// RobotAutocalib (Zuniga-Noel et al. 2019) as published: motions and points of the ground from features in the images,
// with a free scale.
class RobotAutocalib : public Method {
 public:
  MethodTraits traits() const override {
    return {"robot_autocalib",
            "RobotAutocalib (Zuniga-Noel et al. 2019) as published: motions and ground from image features, free scale",
            "images, odometry with three turns; no board",
            "camera to robot (6), camera to camera",
            MethodReads::kFeatures,
            4e-3};
  }

  std::optional<Finding> why_not(const MethodInput& input) const override {
    if (input.recording != nullptr) return rivals::why_no_vertical(input.observations, *input.recording);
    return Finding("method.needs_images", {{"instead", "robot_autocalib_board"}});
  }

  Result solve(const Observations& observations) const override {
    Result result;
    result.method = traits().name;
    result.reasons = {*why_not({observations})};
    return result;
  }

  Result solve_recording(const MethodInput& input) const override {
    if (input.recording == nullptr) return solve(input.observations);
    const rivals::Features features(input);
    const auto pairs = rivals::match_consecutive_images(input, features.source(), [](int, int, int) { return true; });
    std::vector<AutocalibSensor> sensors;
    for (std::size_t k = 0; k < input.observations.cameras.size(); ++k)
      sensors.push_back(sensor_from_images(input, pairs, static_cast<int>(k)));
    Result result = rivals::result_of(input.observations, sensors, rivals::robot_autocalib(sensors));
    result.method = traits().name;
    return result;
  }
};

}  // namespace

std::vector<const Method*> robot_autocalib_methods() {
  static const RobotAutocalib method;
  return {&method};
}

}  // namespace rigproof
