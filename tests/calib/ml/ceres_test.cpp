// The same problem once more, written for Ceres with automatic derivatives: both must find the same optimum.
#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "calibration_truth.h"
#include "pose_near.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof {
namespace {

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

// A transform as seven numbers: quaternion xyzw, translation.
template <typename T>
Eigen::Quaternion<T> rotation_of(const T* pose) {
  return Eigen::Map<const Eigen::Quaternion<T>>(pose);
}
template <typename T>
Vector3<T> translation_of(const T* pose) {
  return Eigen::Map<const Vector3<T>>(pose + 4);
}

// Rotation by a small tilt (roll, pitch, 0): Rodrigues by way of ceres.
template <typename T>
Eigen::Quaternion<T> tilt_of(const T* robot) {
  const T axis[3] = {robot[4], robot[5], T(0.0)};
  T q[4];
  ceres::AngleAxisToQuaternion(axis, q);
  return Eigen::Quaternion<T>(q[0], q[1], q[2], q[3]);
}
template <typename T>
Eigen::Quaternion<T> yaw_rotation(const T& yaw) {
  return Eigen::Quaternion<T>(cos(yaw / T(2.0)), T(0.0), T(0.0), sin(yaw / T(2.0)));
}

struct CornerCost {
  Eigen::Vector3d point;
  Eigen::Vector2d pixel;
  double sigma;
  Camera camera;
  template <typename T>
  bool operator()(const T* X, const T* board, const T* robot, T* residual) const {
    const Vector3<T> world = rotation_of(board) * point.cast<T>() + translation_of(board);
    const Vector3<T> origin(robot[0], robot[1], robot[3]);
    const Vector3<T> in_robot = (yaw_rotation(robot[2]) * tilt_of(robot)).conjugate() * (world - origin);
    const Vector3<T> q = rotation_of(X).conjugate() * (in_robot - translation_of(X));
    residual[0] = (T(camera.fx_px) * q.x() / q.z() + T(camera.cx_px) - T(pixel.x())) / T(sigma);
    residual[1] = (T(camera.fy_px) * q.y() / q.z() + T(camera.cy_px) - T(pixel.y())) / T(sigma);
    return true;
  }
};

struct GroundCost {
  Eigen::Vector3d measured;
  Eigen::Matrix3d whitening;
  template <typename T>
  bool operator()(const T* X, const T* robot, T* residual) const {
    const Vector3<T> up_robot = tilt_of(robot).conjugate() * Vector3<T>(T(0.0), T(0.0), T(1.0));
    const T height = up_robot.dot(translation_of(X)) + robot[3];
    const Vector3<T> predicted = -(rotation_of(X).conjugate() * up_robot) / height;
    Eigen::Map<Vector3<T>> r(residual);
    r = whitening.cast<T>() * (predicted - measured.cast<T>());
    return true;
  }
};

struct IncrementCost {
  Eigen::Vector3d measured;
  double sigma_xy, sigma_yaw;
  template <typename T>
  bool operator()(const T* from, const T* to, const T* systematic, T* residual) const {
    const T dx = to[0] - from[0], dy = to[1] - from[1];
    const T c = cos(from[2]), s = sin(from[2]);
    residual[0] = (systematic[0] * (c * dx + s * dy) - T(measured.x())) / T(sigma_xy);
    residual[1] = (systematic[0] * (c * dy - s * dx) - T(measured.y())) / T(sigma_xy);
    T turn = to[2] - from[2];
    while (turn - T(measured.z()) > T(3.14159265358979)) turn -= T(2.0 * 3.14159265358979323846);
    while (turn - T(measured.z()) < T(-3.14159265358979)) turn += T(2.0 * 3.14159265358979323846);
    residual[2] = (systematic[1] * turn - T(measured.z())) / T(sigma_yaw);
    return true;
  }
};

struct SlackCost {
  double sigma_height, sigma_tilt;
  template <typename T>
  bool operator()(const T* robot, T* residual) const {
    residual[0] = robot[3] / T(sigma_height);
    residual[1] = robot[4] / T(sigma_tilt);
    residual[2] = robot[5] / T(sigma_tilt);
    return true;
  }
};

struct PriorCost {
  double sigma;
  template <typename T>
  bool operator()(const T* systematic, T* residual) const {
    residual[0] = (systematic[0] - T(1.0)) / T(sigma);
    residual[1] = (systematic[1] - T(1.0)) / T(sigma);
    return true;
  }
};

std::array<double, 7> seven(const Rigid3& T) {
  return {T.rotation.x(),    T.rotation.y(),    T.rotation.z(),   T.rotation.w(),
          T.translation.x(), T.translation.y(), T.translation.z()};
}

class CeresProblem {
 public:
  CeresProblem(const GeometricRun& run, const MlEstimate& levels) : run_(run), noise_(levels.noise) {
    for (const TrueCamera& camera : run.truth.cameras) cameras.push_back(seven(camera.T_robot_camera));
    board_ = seven(run.truth.T_world_board);
    for (const TrueStop& stop : run.truth.stops) {
      const Rigid3& T = stop.T_world_robot;
      robots_.push_back({T.translation.x(), T.translation.y(), yaw_of(T), 0.0, 0.0, 0.0});
    }
    for (auto& camera : cameras) add_pose(camera.data());
    add_pose(board_.data());
    add_corners();
    add_ground();
    add_odometry();
  }

  void solve() {
    ceres::Solver::Options options;
    options.max_num_iterations = 200;
    options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-18;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    cost = 2.0 * summary.final_cost;
  }

  std::vector<std::array<double, 7>> cameras;
  double cost = 0.0;

 private:
  void add_pose(double* pose) {
    problem_.AddParameterBlock(
        pose, 7, new ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>());
  }
  static ceres::LossFunction* loss() { return new ceres::CauchyLoss(3.0); }

  void add_corners() {
    for (const BoardView& view : run_.observations.board_views) {
      for (const CornerObservation& corner : view.corners) {
        const auto c = static_cast<std::size_t>(view.camera);
        auto* functor = new CornerCost{run_.observations.board.corner(corner.id), corner.pixel,
                                       std::sqrt(corner.covariance_px2(0, 0)), run_.observations.cameras[c].camera};
        problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<CornerCost, 2, 7, 7, 6>(functor), loss(),
                                  cameras[c].data(), board_.data(),
                                  robots_[static_cast<std::size_t>(view.stop)].data());
      }
    }
  }

  void add_ground() {
    for (const PlaneObservation& plane : run_.observations.ground_planes) {
      const Eigen::Matrix3d L = plane.covariance_per_m2.llt().matrixL();
      auto* functor = new GroundCost{plane.inverse_depth_plane, L.inverse()};
      problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<GroundCost, 3, 7, 6>(functor), loss(),
                                cameras[static_cast<std::size_t>(plane.camera)].data(),
                                robots_[static_cast<std::size_t>(plane.stop)].data());
    }
  }

  void add_odometry() {
    const std::vector<Stop>& stops = run_.observations.stops;
    for (std::size_t i = 0; i < stops.size(); ++i) {
      auto* slack = new SlackCost{noise_.suspension_height_m, noise_.suspension_tilt_rad};
      problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<SlackCost, 3, 6>(slack), loss(), robots_[i].data());
      if (i == 0) continue;
      const Rigid3 step = planar_pose(stops[i - 1].x_m, stops[i - 1].y_m, stops[i - 1].yaw_rad).inverse() *
                          planar_pose(stops[i].x_m, stops[i].y_m, stops[i].yaw_rad);
      auto* functor = new IncrementCost{
          {step.translation.x(), step.translation.y(), yaw_of(step)}, noise_.odometry_xy_m, noise_.odometry_yaw_rad};
      problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<IncrementCost, 3, 6, 6, 2>(functor), loss(),
                                robots_[i - 1].data(), robots_[i].data(), systematic_.data());
    }
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorCost, 2, 2>(new PriorCost{0.1}), nullptr,
                              systematic_.data());
    problem_.SetManifold(robots_[0].data(), new ceres::SubsetManifold(6, {0, 1, 2}));
  }

  const GeometricRun& run_;
  CalibrationNoise noise_;
  std::array<double, 7> board_;
  std::array<double, 2> systematic_ = {1.0, 1.0};
  std::vector<std::array<double, 6>> robots_;
  ceres::Problem problem_;
};

TEST(MlAgainstCeres, FindsTheSameOptimum) {
  GeometricConfig config;
  config.stops = 15;
  // Little noise: the cost resolves a step of 1e-6 sigma at best, and 1e-9 m must be more than that.
  config.corner_sigma_px = 0.02;
  config.lambda = 0.1;
  config.suspension_height_sigma_m = config.suspension_tilt_sigma_rad = 0.001;
  config.odometry_scale = 1.01;
  config.corner_outlier_fraction = 0.01;
  const GeometricRun run = draw_geometric_run(config);
  MlOptions options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.001;
  options.estimate_corner_level = options.estimate_plane_level = false;
  options.priors.believe_told = true;  // the other problem knows of no doubts
  options.priors.odometry_veer_rad_per_m = 0.0;
  options.tolerance = 1e-20;
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations, options);
  CeresProblem ceres_problem(run, estimate);
  ceres_problem.solve();
  EXPECT_NEAR(ceres_problem.cost, estimate.cost, 1e-8 * estimate.cost);
  for (std::size_t c = 0; c < ceres_problem.cameras.size(); ++c) {
    const double* pose = ceres_problem.cameras[c].data();
    const Rigid3 expected(rotation_of(pose), translation_of(pose));
    // Both stop at rounding: 1e-9 m and rad.
    EXPECT_TRUE(IsPoseNear(expected, estimate.state.T_robot_camera[c], 1e-9, 1e-9)) << "camera " << c;
  }
}

}  // namespace
}  // namespace rigproof
