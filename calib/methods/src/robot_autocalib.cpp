#include "robot_autocalib.h"

#include <ceres/ceres.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "quiet_solve.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"

namespace rigproof::rivals {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kGroundLoss = 0.01;
constexpr double kMotionLoss = 0.1;
constexpr double kInlier_m = 0.2;
constexpr double kMinInlierRatio = 0.25;
constexpr double kConfidence = 0.9999;
// Two motions are solved exactly whatever they say: a third one must agree.
constexpr double kMinMotions = 3.0;
constexpr int kMinTrials = 100, kMaxTrials = 1000;
constexpr int kMinCommonMotions = 6;
// Turns smaller than this tell no place from another.
const double kMinTurn_rad = deg_to_rad(1.0);

// n = (-sin p, cos p sin r, cos p cos r), the level frame's z axis in the sensor.
Vector3d normal_of(double roll, double pitch) {
  return {-std::sin(pitch), std::cos(pitch) * std::sin(roll), std::cos(pitch) * std::cos(roll)};
}

// A motion in the level frame, as 2D.
struct PlanarMotion {
  int from, to;
  Vector2d a;
  double alpha;
  Vector2d b;
  double beta;
};

Matrix2d rotation2(double angle) { return Eigen::Rotation2Dd(angle).toRotationMatrix(); }

std::vector<PlanarMotion> planarise(const AutocalibSensor& sensor, const Eigen::Quaterniond& level) {
  std::vector<PlanarMotion> motions;
  for (const SensorMotion& motion : sensor.motions) {
    const Eigen::Quaterniond turn = level * motion.B.rotation * level.conjugate();
    const Vector3d step = level * motion.B.translation;
    motions.push_back({motion.from, motion.to, motion.A.translation.head<2>(), yaw_of(motion.A), step.head<2>(),
                       yaw_of(Rigid3(turn, Vector3d::Zero()))});
  }
  return motions;
}

/// Metric x = scale * t, heading, and scale.
struct Planar {
  double scale = 1.0;
  Vector2d t = Vector2d::Zero();
  double heading = 0.0;
};

double residual_m(const Planar& x, const PlanarMotion& m) {
  const Vector2d moved = (Matrix2d::Identity() - rotation2(m.beta)) * x.t + rotation2(x.heading) * m.b;
  return (m.a - x.scale * moved).norm();
}

// Null vector of [-a, I - R(alpha), b-block] with cos^2 + sin^2 = 1: the first three unknowns are eliminated.
std::optional<Planar> closed_form(const std::vector<const PlanarMotion*>& motions) {
  Eigen::Matrix<double, 5, 5> M = Eigen::Matrix<double, 5, 5>::Zero();
  for (const PlanarMotion* m : motions) {
    const double c = std::cos(m->alpha), q = std::sin(m->alpha);
    Eigen::Matrix<double, 2, 5> rows;
    rows << -m->a.x(), 1.0 - c, q, m->b.x(), -m->b.y(), -m->a.y(), -q, 1.0 - c, m->b.y(), m->b.x();
    M += rows.transpose() * rows;
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> eliminate(M.topLeftCorner<3, 3>());
  if (!eliminate.isInvertible() || !(eliminate.rcond() > 1e-12)) return std::nullopt;
  const Eigen::Matrix<double, 3, 2> back = -eliminate.solve(M.topRightCorner<3, 2>());
  const Matrix2d S = M.bottomRightCorner<2, 2>() + M.bottomLeftCorner<2, 3>() * back;
  const Eigen::SelfAdjointEigenSolver<Matrix2d> eigen(S);
  Vector2d heading = eigen.eigenvectors().col(0);
  Vector3d rest = back * heading;
  if (rest(0) < 0.0) heading = -heading, rest = -rest;
  if (!(rest(0) > 1e-9) || !rest.allFinite()) return std::nullopt;
  return Planar{1.0 / rest(0), rest.tail<2>(), std::atan2(heading.y(), heading.x())};
}

std::vector<const PlanarMotion*> inliers_of(const Planar& x, const std::vector<PlanarMotion>& motions) {
  std::vector<const PlanarMotion*> inliers;
  for (const PlanarMotion& motion : motions)
    if (residual_m(x, motion) < kInlier_m) inliers.push_back(&motion);
  return inliers;
}

struct Consensus {
  Planar x;
  std::vector<const PlanarMotion*> inliers;
};

// The closed form over a consensus, and over its consensus, as long as it grows.
void optimise_locally(const std::vector<PlanarMotion>& motions, Consensus* best) {
  for (int round = 0; round < 10; ++round) {
    const std::optional<Planar> x = closed_form(best->inliers);
    if (!x) return;
    std::vector<const PlanarMotion*> inliers = inliers_of(*x, motions);
    if (inliers.size() < best->inliers.size()) return;
    const bool settled = inliers == best->inliers;
    *best = {*x, std::move(inliers)};
    if (settled) return;
  }
}

std::optional<Consensus> lo_ransac(const std::vector<PlanarMotion>& motions, std::int32_t sensor) {
  const auto size = static_cast<std::uint32_t>(motions.size());
  if (size < 2) return std::nullopt;
  RandomStream random(0, "robot_autocalib", -1, sensor);
  Consensus best;
  double wanted = kMaxTrials;
  for (int trial = 0; trial < kMaxTrials && (trial < kMinTrials || trial < wanted); ++trial) {
    const std::uint32_t first = random.below(size), other = random.below(size - 1);
    const std::optional<Planar> x = closed_form({&motions[first], &motions[other < first ? other : other + 1]});
    if (!x) continue;
    Consensus found{*x, inliers_of(*x, motions)};
    if (found.inliers.size() <= best.inliers.size()) continue;
    optimise_locally(motions, &found);
    best = std::move(found);
    const double ratio = static_cast<double>(best.inliers.size()) / size;
    wanted = std::log(1.0 - kConfidence) / std::log1p(-std::min(0.999999, ratio * ratio));
  }
  if (static_cast<double>(best.inliers.size()) < std::max(kMinMotions, kMinInlierRatio * size)) return std::nullopt;
  return best;
}

// Joint refinement ---------------------------------------------------------------------------------------------------

/// scale, t_x, t_y, heading
using Parameters = std::array<double, 4>;

template <typename T>
Eigen::Matrix<T, 2, 1> turned(const T& angle, const Eigen::Matrix<T, 2, 1>& v) {
  using std::cos;
  using std::sin;
  return {cos(angle) * v.x() - sin(angle) * v.y(), sin(angle) * v.x() + cos(angle) * v.y()};
}

struct MotionCost {
  PlanarMotion m;

  template <typename T>
  bool operator()(const T* x, T* residual) const {
    const Eigen::Matrix<T, 2, 1> t(x[1], x[2]);
    const Eigen::Matrix<T, 2, 1> moved = t - turned<T>(T(m.beta), t) + turned<T>(x[3], m.b.template cast<T>());
    residual[0] = T(m.a.x()) - x[0] * moved.x();
    residual[1] = T(m.a.y()) - x[0] * moved.y();
    return true;
  }
};

/// The motion of sensor i as sensor j tells it, through X_i^-1 X_j.
struct PairCost {
  PlanarMotion i, j;

  template <typename T>
  bool operator()(const T* x_i, const T* x_j, T* residual) const {
    using Vector = Eigen::Matrix<T, 2, 1>;
    const Vector t_i = x_i[0] * Vector(x_i[1], x_i[2]), t_j = x_j[0] * Vector(x_j[1], x_j[2]);
    const Vector t_ij = turned<T>(-x_i[3], t_j - t_i);
    const Vector moved =
        t_ij - turned<T>(T(j.beta), t_ij) + turned<T>(x_j[3] - x_i[3], x_j[0] * j.b.template cast<T>());
    residual[0] = x_i[0] * T(i.b.x()) - moved.x();
    residual[1] = x_i[0] * T(i.b.y()) - moved.y();
    return true;
  }
};

using CommonMotions = std::vector<std::pair<const PlanarMotion*, const PlanarMotion*>>;

CommonMotions common_motions(const Consensus& a, const Consensus& b) {
  std::map<std::pair<int, int>, const PlanarMotion*> of_b;
  for (const PlanarMotion* m : b.inliers) of_b[{m->from, m->to}] = m;
  CommonMotions common;
  for (const PlanarMotion* m : a.inliers) {
    const auto found = of_b.find({m->from, m->to});
    if (found != of_b.end()) common.emplace_back(m, found->second);
  }
  return common;
}

void refine_together(std::vector<std::optional<Consensus>>* sensors) {
  std::vector<Parameters> parameters(sensors->size());
  ceres::Problem problem;
  for (std::size_t i = 0; i < sensors->size(); ++i) {
    if (!(*sensors)[i]) continue;
    const Consensus& sensor = *(*sensors)[i];
    parameters[i] = {sensor.x.scale, sensor.x.t.x(), sensor.x.t.y(), sensor.x.heading};
    for (const PlanarMotion* m : sensor.inliers)
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<MotionCost, 2, 4>(new MotionCost{*m}),
                               new ceres::CauchyLoss(kMotionLoss), parameters[i].data());
  }
  for (std::size_t i = 0; i < sensors->size(); ++i) {
    for (std::size_t j = i + 1; j < sensors->size(); ++j) {
      if (!(*sensors)[i] || !(*sensors)[j]) continue;
      const CommonMotions common = common_motions(*(*sensors)[i], *(*sensors)[j]);
      if (common.size() < kMinCommonMotions) continue;
      for (const auto& [m_i, m_j] : common)
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PairCost, 2, 4, 4>(new PairCost{*m_i, *m_j}),
                                 new ceres::CauchyLoss(kMotionLoss), parameters[i].data(), parameters[j].data());
    }
  }
  if (problem.NumResidualBlocks() == 0) return;
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.max_num_iterations = 200;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-14;
  quiet_solve(options, &problem);
  for (std::size_t i = 0; i < sensors->size(); ++i) {
    if (!(*sensors)[i]) continue;
    const Parameters& p = parameters[i];
    (*sensors)[i]->x = {p[0], Vector2d(p[1], p[2]), p[3]};
  }
}

double largest_turn(const AutocalibSensor& sensor) {
  double turn = 0.0;
  for (const SensorMotion& motion : sensor.motions) turn = std::max(turn, std::abs(yaw_of(motion.A)));
  return turn;
}

AutocalibPose pose_of(const AutocalibSensor& sensor, const GroundLevel& level, const Consensus& consensus,
                      const std::vector<PlanarMotion>& motions) {
  AutocalibPose pose;
  const Planar& x = consensus.x;
  const Vector2d t = x.scale * x.t;
  const double height = sensor.metric_ground ? level.height : x.scale * level.height;
  pose.T_robot_sensor = Rigid3(rotation_z(x.heading) * level.levelling(), Vector3d(t.x(), t.y(), height));
  pose.scale = x.scale;
  for (const PlanarMotion& motion : motions)
    pose.inliers.push_back(std::find(consensus.inliers.begin(), consensus.inliers.end(), &motion) !=
                           consensus.inliers.end());
  return pose;
}

}  // namespace

Eigen::Quaterniond GroundLevel::levelling() const {
  return Eigen::AngleAxisd(pitch_rad, Vector3d::UnitY()) * Eigen::AngleAxisd(roll_rad, Vector3d::UnitX());
}

std::optional<GroundLevel> fit_ground_level(const std::vector<Vector3d>& points) {
  if (points.size() < 3) return std::nullopt;
  // Closed form: min sum (h + n.x)^2 / |x|, |n| = 1; h is eliminated.
  double weights = 0.0;
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& x : points) weights += 1.0 / x.norm(), mean += x / x.norm();
  mean /= weights;
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
  for (const Vector3d& x : points) C += (x - mean) * (x - mean).transpose() / x.norm();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(C);
  if (!(eigen.eigenvalues()(1) > 1e-9 * eigen.eigenvalues()(2))) return std::nullopt;
  Vector3d n = eigen.eigenvectors().col(0);
  double h = -n.dot(mean);
  if (h < 0.0) n = -n, h = -h;
  double pitch = std::asin(std::clamp(-n.x(), -1.0, 1.0)), roll = std::atan2(n.y(), n.z());
  // Gauss-Newton under Cauchy's loss, with the same weights.
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Vector3d normal = normal_of(roll, pitch);
    const Vector3d by_pitch(-std::cos(pitch), -std::sin(pitch) * std::sin(roll), -std::sin(pitch) * std::cos(roll));
    const Vector3d by_roll(0.0, std::cos(pitch) * std::cos(roll), -std::cos(pitch) * std::sin(roll));
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Vector3d g = Vector3d::Zero();
    for (const Vector3d& x : points) {
      const double e = h + normal.dot(x);
      const double weight = 1.0 / (x.norm() * (1.0 + e * e / (kGroundLoss * kGroundLoss)));
      const Vector3d J(by_roll.dot(x), by_pitch.dot(x), 1.0);
      H += weight * J * J.transpose();
      g += weight * e * J;
    }
    const Vector3d step = H.ldlt().solve(-g);
    if (!step.allFinite()) break;
    roll += step(0), pitch += step(1), h += step(2);
    if (step.norm() < 1e-12) break;
  }
  return GroundLevel{roll, pitch, h};
}

AutocalibResult robot_autocalib(const std::vector<AutocalibSensor>& sensors) {
  AutocalibResult result;
  result.poses.resize(sensors.size());
  result.reasons.resize(sensors.size());
  std::vector<std::optional<GroundLevel>> levels(sensors.size());
  std::vector<std::vector<PlanarMotion>> motions(sensors.size());
  std::vector<std::optional<Consensus>> found(sensors.size());
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    levels[i] = fit_ground_level(sensors[i].ground_points);
    if (!levels[i]) {
      result.reasons[i] = Finding("camera.no_ground_points");
    } else if (!(largest_turn(sensors[i]) > kMinTurn_rad)) {
      result.reasons[i] = Finding("camera.never_turned");
    } else {
      motions[i] = planarise(sensors[i], levels[i]->levelling());
      found[i] = lo_ransac(motions[i], static_cast<std::int32_t>(i));
      if (!found[i]) result.reasons[i] = Finding("camera.few_motions", {{"motions", motions[i].size()}});
    }
  }
  refine_together(&found);
  for (std::size_t i = 0; i < sensors.size(); ++i)
    if (found[i]) result.poses[i] = pose_of(sensors[i], *levels[i], *found[i], motions[i]);
  return result;
}

}  // namespace rigproof::rivals
