// A robot of which is stated that it turns about another point than its origin: wheels tell the motion of that point.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "faults.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error_jacobians.h"
#include "rigproof/geometric/geometric.h"
#include "turning_robot.h"
#include "worded.h"

namespace rigproof {
namespace {

const Eigen::Vector2d kPoint_m(0.13, -0.04);

GeometricConfig drive(OdometryModel model, bool along_way) {
  GeometricConfig config;
  config.seed = 5;
  config.stops = 16;
  config.odometry_model = model;
  config.along_way = along_way;
  return config;
}

// Its origin is what moves, whatever scale and yaw factor the wheels have.
void expect_the_origin_moved(const GeometricConfig& config) {
  MlOptions options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;  // a robot tilts about its origin
  Observations observations = draw_geometric_run(config).observations;
  observations.odometry_noise.rotation_centre_sigma_m = 0.0;
  const MlEstimate of_point = estimate_maximum_likelihood(observations, options);
  const MlEstimate moved = estimate_maximum_likelihood(of_origin(observations, kPoint_m, 0.0), options);
  ASSERT_TRUE(of_point.result.joint_covariance && moved.result.joint_covariance);
  for (std::size_t c = 0; c < of_point.result.camera_to_robot.size(); ++c) {
    Rigid3 expected = of_point.result.camera_to_robot[c].T_parent_child;
    expected.translation.head<2>() += kPoint_m;
    EXPECT_LT(transform_error(moved.result.camera_to_robot[c].T_parent_child, expected).norm(), 3e-5) << c;
  }
  const Eigen::MatrixXd& joint = *of_point.result.joint_covariance;
  EXPECT_LT((*moved.result.joint_covariance - joint).norm(), 1e-3 * joint.norm());
}

TEST(MlTurningPoint, MovesTheOriginAlongTheWay) {
  GeometricConfig config = drive(OdometryModel::kPerIncrement, true);
  config.odometry_scale = 1.03;
  config.odometry_yaw_factor = 0.95;
  config.declare_odometry_model = config.declare_odometry_sigmas = false;
  expect_the_origin_moved(config);
}

TEST(MlTurningPoint, MovesTheOriginFromStopToStop) {
  GeometricConfig config = drive(OdometryModel::kPerIncrement, false);
  config.odometry_scale = 1.03;
  config.odometry_yaw_factor = 0.95;
  expect_the_origin_moved(config);
}

TEST(MlTurningPoint, MovesTheOriginOfAbsoluteOdometry) {
  expect_the_origin_moved(drive(OdometryModel::kPerPose, false));
}

double farthest(const Observations& a, const Observations& b) {
  double most = 0.0;
  const auto look = [&most](const Eigen::Vector3d& one, const Eigen::Vector3d& other) {
    most = std::max({most, (one - other).head<2>().norm(), std::abs(wrap_angle(one.z() - other.z()))});
  };
  for (std::size_t i = 0; i < a.stops.size(); ++i) {
    const Stop &one = a.stops[i], &other = b.stops[i];
    look({one.x_m, one.y_m, one.yaw_rad}, {other.x_m, other.y_m, other.yaw_rad});
    for (std::size_t row = 0; row < one.way.size(); ++row) look(one.way[row], other.way[row]);
  }
  return most;
}

// Odometry is undone as it was recorded, where the point was taken for the origin by a wrong yaw, and in a wrong unit.
TEST(MlTurningPoint, FaultsOfOdometryAreUndoneAsTheyWereRecorded) {
  const Observations drawn = draw_geometric_run(drive(OdometryModel::kPerIncrement, true)).observations;
  const Observations right = of_origin(drawn, kPoint_m, 0.005);
  ASSERT_GT(right.stops[1].way.size(), 0U);
  const auto undone = [&](const Observations& wrong, const char* code) {
    const std::vector<ml::Fault> faults = ml::odometry_faults(wrong);
    const auto fault =
        std::find_if(faults.begin(), faults.end(), [code](const ml::Fault& f) { return f.cause.is(code); });
    return ml::undone(*fault, wrong);
  };
  const auto in_millimetres = [](const Eigen::Vector3d& pose) {
    return Eigen::Vector3d(1e3 * pose.x(), 1e3 * pose.y(), pose.z());
  };
  const auto in_degrees = [](const Eigen::Vector3d& pose) {
    return Eigen::Vector3d(pose.x(), pose.y(), rad_to_deg(pose.z()));
  };
  const auto turned_over = [](const Eigen::Vector3d& pose) { return Eigen::Vector3d(pose.x(), pose.y(), -pose.z()); };
  EXPECT_LT(farthest(undone(of_origin(drawn, kPoint_m, 0.005, in_millimetres), "odometry.unit"), right), 1e-9);
  EXPECT_LT(farthest(undone(of_origin(drawn, kPoint_m, 0.005, in_degrees), "odometry.yaw_in_degrees"), right), 1e-9);
  EXPECT_LT(farthest(undone(of_origin(drawn, kPoint_m, 0.005, turned_over), "odometry.yaw_sign"), right), 1e-9);
}

TEST(MlTurningPoint, FaultsOfOdometryAreNamedAsEver) {
  const auto in_degrees = [](const Eigen::Vector3d& pose) {
    return Eigen::Vector3d(pose.x(), pose.y(), rad_to_deg(pose.z()));
  };
  const Observations observations = draw_geometric_run(drive(OdometryModel::kPerIncrement, false)).observations;
  const Result result = estimate_maximum_likelihood(of_origin(observations, kPoint_m, 0.005, in_degrees)).result;
  EXPECT_NE(result.status, ResultStatus::kSolved);
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_EQ(result.reasons.front().code, "odometry.yaw_in_degrees");
}

// Wheels that count no way: around the stated point the origin would seem to move.
TEST(MlTurningPoint, ColumnsThatNeverChangeAreNamed) {
  const auto without_a_way = [](const Eigen::Vector3d& pose) { return Eigen::Vector3d(0.0, 0.0, pose.z()); };
  const Observations observations = draw_geometric_run(drive(OdometryModel::kPerIncrement, false)).observations;
  const Result result = estimate_maximum_likelihood(of_origin(observations, kPoint_m, 0.005, without_a_way)).result;
  std::vector<Finding> all = result.reasons;
  all.insert(all.end(), result.notes.begin(), result.notes.end());
  EXPECT_TRUE(has_code(all, "odometry.constant")) << findings_json(all);
}

}  // namespace
}  // namespace rigproof
