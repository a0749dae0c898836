#include "rigproof/calib/diagnose/observability.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/exclusions.h"

namespace rigproof {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Suspension, board bow and lens errors add to what the corners' covariances say: never trust a view more than this.
constexpr double kPositionFloor_m = 3e-4;
constexpr double kAngleFloor_rad = 2e-4;
// A robot that turns about a point this near to its origin turns in place.
constexpr double kInPlace_m = 0.05;
// A sigma beyond this, or beyond half a turn, says no more than that nothing is known.
constexpr double kLargestSigma_m = 100.0;

// The planar motion of the robot between two views, as the camera saw it.
struct PlanarMotion {
  double turn_rad;
  Vector2d translation_m;  // in the robot's frame at the start
  Matrix3d covariance;     // of (x, y, turn)
  Vector3d driven;         // the same by odometry: x, y, turn
};

Rigid3 odometry_motion(const Observations& observations, int from, int to) {
  const Stop& a = observations.stops[static_cast<std::size_t>(from)];
  const Stop& b = observations.stops[static_cast<std::size_t>(to)];
  return planar_pose(a.x_m, a.y_m, a.yaw_rad).inverse() * planar_pose(b.x_m, b.y_m, b.yaw_rad);
}

PlanarMotion planar_motion(const Observations& observations, const ViewPair& pair, const Rigid3& X) {
  const Rigid3 B = pair.from->T_camera_board * pair.to->T_camera_board.inverse();
  const Rigid3 A = X * B * X.inverse();
  // t_A = t_X + R_X t_B - R_A t_X
  const Matrix3d R_X = X.rotation_matrix();
  Eigen::Matrix<double, 3, 6> J = Eigen::Matrix<double, 3, 6>::Zero();
  J.topLeftCorner<2, 3>() = R_X.topRows<2>();
  J.topRightCorner<2, 3>() = (skew(A.rotation * X.translation) * R_X).topRows<2>();
  J.bottomRightCorner<1, 3>() = R_X.row(2);
  PlanarMotion motion;
  motion.turn_rad = yaw_of(A);
  motion.translation_m = A.translation.head<2>();
  motion.covariance = J * relative_covariance(*pair.from, *pair.to) * J.transpose();
  const double position = 2.0 * kPositionFloor_m * kPositionFloor_m, angle = 2.0 * kAngleFloor_rad * kAngleFloor_rad;
  motion.covariance.diagonal() += Vector3d(position, position, angle);
  const Rigid3 driven = odometry_motion(observations, pair.from->stop, pair.to->stop);
  motion.driven = Vector3d(driven.translation.x(), driven.translation.y(), yaw_of(driven));
  return motion;
}

// M = [R(turn) - I, S b]: its null vectors are the ways to shift and turn the camera that no motion tells apart.
Eigen::Matrix<double, 2, 3> gauge_rows(const PlanarMotion& motion) {
  const double c = std::cos(motion.turn_rad), s = std::sin(motion.turn_rad);
  Eigen::Matrix<double, 2, 3> M;
  M << c - 1.0, -s, -motion.translation_m.y(), s, c - 1.0, motion.translation_m.x();
  return M;
}

// Expectation of dM^T dM under the motion's covariance.
Matrix3d gauge_noise(const PlanarMotion& motion) {
  // dM = [R S dturn, S db] with S a quarter turn; R S and S are orthogonal.
  const double c = std::cos(motion.turn_rad), s = std::sin(motion.turn_rad);
  Matrix2d R;
  R << c, -s, s, c;
  Matrix3d N = Matrix3d::Zero();
  N.topLeftCorner<2, 2>() = motion.covariance(2, 2) * Matrix2d::Identity();
  N(2, 2) = motion.covariance(0, 0) + motion.covariance(1, 1);
  N.topRightCorner<2, 1>() = R.transpose() * motion.covariance.topRightCorner<2, 1>();
  N.bottomLeftCorner<1, 2>() = N.topRightCorner<2, 1>().transpose();
  return N;
}

struct GaugeMatrices {
  Matrix3d signal = Matrix3d::Zero();  // M^T M
  Matrix3d noise = Matrix3d::Zero();
  double turn_ratio() const { return signal(0, 0) / noise(0, 0); }
  double displacement_ratio() const { return signal(2, 2) / noise(2, 2); }
};

GaugeMatrices gauge_matrices(const std::vector<PlanarMotion>& motions) {
  GaugeMatrices gauge;
  for (const PlanarMotion& motion : motions) {
    const Eigen::Matrix<double, 2, 3> M = gauge_rows(motion);
    gauge.signal += M.transpose() * M;
    gauge.noise += gauge_noise(motion);
  }
  return gauge;
}

double smallest_generalised_eigenvalue(const GaugeMatrices& gauge) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix3d> eigen(gauge.signal, gauge.noise, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()(0);
}

// Centre c with a = (I - R(turn)) c for all motions of the odometry, by least squares.
Vector2d common_centre(const std::vector<PlanarMotion>& motions) {
  Matrix2d H = 1e-9 * Matrix2d::Identity();
  Vector2d g = Vector2d::Zero();
  for (const PlanarMotion& motion : motions) {
    const double c = std::cos(motion.driven.z()), s = std::sin(motion.driven.z());
    Matrix2d J;
    J << 1.0 - c, s, -s, 1.0 - c;
    H += J.transpose() * J;
    g += J.transpose() * motion.driven.head<2>();
  }
  return H.ldlt().solve(g);
}

// "-0.00" is no number that people write.
double tidy(double value) { return std::abs(value) < 0.005 ? 0.0 : value; }

std::optional<Finding> finding_for(const MotionVerdict& verdict) {
  const std::vector<std::string> all = {"x", "y", "yaw"};
  const auto about_centre = [&](const char* code) {
    return Finding(code, {{"x_m", tidy(verdict.centre_m->x())}, {"y_m", tidy(verdict.centre_m->y())}}).along(all);
  };
  switch (verdict.kind) {
    case MotionKind::kTooFewPoses:
      return Finding("motion.too_few_poses", {{"poses", verdict.usable_poses}}).along(all);
    case MotionKind::kStandstill:
      return Finding("motion.standstill").along(all);
    case MotionKind::kNoTurning:
      return Finding("motion.straight").along(verdict.yaw ? std::vector<std::string>{"x", "y"} : all);
    case MotionKind::kTurnInPlace:
      return about_centre("motion.in_place");
    case MotionKind::kOneCentre:
      return about_centre("motion.one_centre");
    case MotionKind::kSufficient:
      break;
  }
  return std::nullopt;
}

MotionKind classify(const GaugeMatrices& gauge, const MotionVerdict& verdict, const Vector2d& centre) {
  if (verdict.usable_poses < 3) return MotionKind::kTooFewPoses;
  if (verdict.gate >= kMotionGate) return MotionKind::kSufficient;
  const bool turned = gauge.turn_ratio() >= kMotionGate, moved = gauge.displacement_ratio() >= kMotionGate;
  if (!turned) return moved ? MotionKind::kNoTurning : MotionKind::kStandstill;
  return centre.norm() < kInPlace_m ? MotionKind::kTurnInPlace : MotionKind::kOneCentre;
}

bool contains(const std::vector<int>& values, int value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

// The views of these cameras that agree with the planar motion.
std::vector<ViewPose> trusted_views(const std::vector<ViewPose>& views, const TrajectoryAlignment& alignment,
                                    const std::vector<int>& cameras) {
  std::vector<ViewPose> trusted;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (contains(cameras, views[i].camera) && alignment.view_weights[i] >= kLeastPlanarWeight)
      trusted.push_back(views[i]);
  return trusted;
}

int distinct_stops(const std::vector<ViewPose>& views) {
  int count = 0, previous = -1;
  for (const ViewPose& view : views) {
    if (view.stop != previous) ++count;
    previous = view.stop;
  }
  return count;
}

bool has_view(const std::vector<ViewPose>& views, int camera) {
  return std::any_of(views.begin(), views.end(), [camera](const ViewPose& view) { return view.camera == camera; });
}

}  // namespace

MotionVerdict assess_motion(const Observations& observations, const std::vector<ViewPose>& views,
                            const TrajectoryAlignment& alignment, const InitialGuess& guess,
                            const std::vector<int>& cameras) {
  const std::vector<ViewPose> trusted = trusted_views(views, alignment, cameras);
  std::vector<PlanarMotion> motions;
  for (const int camera : cameras) {
    const std::optional<Rigid3>& X = guess.T_robot_camera[static_cast<std::size_t>(camera)];
    if (!X) continue;
    for (const ViewPair& pair : consecutive_pairs(trusted, camera))
      motions.push_back(planar_motion(observations, pair, *X));
  }
  MotionVerdict verdict;
  // A single motion has one centre whatever it is: two stops, however many others no camera saw twice.
  verdict.usable_poses = motions.size() == 1 ? 2 : distinct_stops(trusted);
  GaugeMatrices gauge;
  Vector2d centre = Vector2d::Zero();
  if (!motions.empty()) {
    gauge = gauge_matrices(motions);
    verdict.gate = smallest_generalised_eigenvalue(gauge);
    centre = common_centre(motions);
  } else {
    verdict.usable_poses = std::min(verdict.usable_poses, 1);
  }
  verdict.kind = classify(gauge, verdict, centre);
  verdict.xy = verdict.kind == MotionKind::kSufficient;
  verdict.yaw = verdict.xy || verdict.kind == MotionKind::kNoTurning;
  // Without a known vertical there is no heading, and no direction of driving seen from the camera.
  if (alignment.source == VerticalSource::kNone) verdict.yaw = verdict.xy = false;
  if (verdict.kind == MotionKind::kTurnInPlace || verdict.kind == MotionKind::kOneCentre) verdict.centre_m = centre;
  verdict.finding = finding_for(verdict);
  return verdict;
}

bool CameraObservability::all() const {
  return std::all_of(observable.begin(), observable.end(), [](bool flag) { return flag; });
}

bool CameraObservability::any() const {
  return std::any_of(observable.begin(), observable.end(), [](bool flag) { return flag; });
}

CameraObservability assess_camera(const Observations& observations, int camera, const std::vector<ViewPose>& views,
                                  const TrajectoryAlignment& alignment, const MotionVerdict& motion,
                                  int ground_planes) {
  CameraObservability result;
  const std::string& name = observations.cameras[static_cast<std::size_t>(camera)].name;
  const bool sees_board = has_view(views, camera);
  const bool vertical = alignment.up_camera[static_cast<std::size_t>(camera)].has_value();
  result.observable = {sees_board && motion.xy, sees_board && motion.xy, ground_planes > 0, vertical, vertical,
                       sees_board && motion.yaw};
  std::vector<Finding>& findings = result.findings;
  if (!sees_board)
    findings.push_back(
        with_lack_of_views(Finding("camera.no_view"), observations.exclusions, camera).along({"x", "y", "yaw"}));
  if (sees_board && motion.finding) findings.push_back(*motion.finding);
  if (ground_planes == 0)
    findings.push_back(with_lack_of_depth(Finding("ground.unseen"), observations.exclusions, camera).along({"z"}));
  if (!vertical) findings.push_back(Finding("vertical.unknown").along({"roll", "pitch"}));
  for (Finding& finding : findings) finding.cameras = {name};
  return result;
}

void apply_posterior_gate(const Matrix6d& covariance, const std::string& camera, CameraObservability* observability,
                          const PosteriorLimits& limits) {
  const std::array<double, 6> limit = limits.each();
  const std::array<const char*, 6> names = {"x", "y", "z", "tilt_x", "tilt_y", "yaw"};
  Finding too_uncertain = Finding("pose.too_uncertain").of(camera);
  for (std::size_t i = 0; i < 6; ++i) {
    const Eigen::Index axis = static_cast<Eigen::Index>(i);
    const double sigma = std::sqrt(covariance(axis, axis));
    if (!observability->observable[i] || sigma <= limit[i]) continue;
    observability->observable[i] = false;
    const bool length = i < 3;
    const double unit = length ? 100.0 : rad_to_deg(1.0);
    const std::string name = names[i], unit_name = length ? "cm" : "deg";
    too_uncertain.axes.push_back(name);
    if (sigma <= (length ? kLargestSigma_m : kPi))
      too_uncertain.values.emplace_back(name + "_" + unit_name, unit * sigma);
    too_uncertain.values.emplace_back(name + "_limit_" + unit_name, unit * limit[i]);
  }
  if (!too_uncertain.axes.empty()) observability->findings.push_back(too_uncertain);
}

}  // namespace rigproof
