#include "rigproof/calib/estimate/residuals.h"

#include <gtest/gtest.h>

#include <functional>

#include "looking_forward.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"

namespace rigproof::ml {
namespace {

// Central differences at this step are exact to about 1e-9 of the derivative for residuals of order one; the pixel's
// third derivative is larger, hence the relative tolerance below.
constexpr double kStep = 1e-5;
constexpr double kTolerance = 2e-7;

const Eigen::Vector2d kPoint_m(0.2, -0.3);  // of the robot, of which odometry tells

Eigen::MatrixXd differences(int unknowns, const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& residual) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(unknowns);
  Eigen::MatrixXd J(residual(zero).size(), unknowns);
  for (int i = 0; i < unknowns; ++i) {
    Eigen::VectorXd step = zero;
    step[i] = kStep;
    J.col(i) = (residual(step) - residual(-step)) / (2.0 * kStep);
  }
  return J;
}

void expect_near(const Eigen::MatrixXd& expected, const Eigen::MatrixXd& actual) {
  EXPECT_LE((expected - actual).cwiseAbs().maxCoeff(), kTolerance * (1.0 + expected.cwiseAbs().maxCoeff()))
      << "differences\n"
      << expected << "\nanalytic\n"
      << actual;
}

Rigid3 moved(const Rigid3& T, const Eigen::VectorXd& step) {
  return Rigid3(T.rotation * so3_exp(step.tail<3>()), T.translation + step.head<3>());
}

RobotPose moved(RobotPose pose, const Eigen::VectorXd& step) {
  pose.x_m += step[0];
  pose.y_m += step[1];
  pose.yaw_rad += step[2];
  pose.height_m += step[3];
  pose.roll_rad += step[4];
  pose.pitch_rad += step[5];
  return pose;
}

struct Residuals : testing::TestWithParam<int> {
  Residuals() {
    RandomStream random(static_cast<std::uint64_t>(GetParam()), "residuals test");
    const auto vector = [&random](double size) {
      return Eigen::Vector3d(random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size));
    };
    // The camera looks along the robot's x axis at a board two metres ahead, all of it tilted at random.
    const Eigen::Quaterniond optical = looking_forward();
    T_robot_camera = Rigid3(so3_exp(vector(0.3)) * optical, Eigen::Vector3d(0.2, 0.1, 0.8) + vector(0.2));
    pose = {random.uniform(-1, 1),       random.uniform(-1, 1),     random.uniform(-3, 3),
            random.uniform(-0.05, 0.05), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)};
    const Rigid3 T_robot_board(so3_exp(vector(0.4)) * optical, Eigen::Vector3d(2.5, 0.2, 0.7) + vector(0.2));
    T_world_board = pose.transform() * T_robot_board;
    camera = Camera::symmetric(1280, 720, 640.0);
    camera.lens = Lens::kBrownConrady;
    camera.distortion = {-0.05, 0.02, 0.001, -0.002, 0.003};
    corner = {random.uniform(0, 0.3), random.uniform(0, 0.3), 0.0};
  }

  Rigid3 T_robot_camera, T_world_board;
  RobotPose pose;
  Camera camera;
  Eigen::Vector3d corner;
};

TEST_P(Residuals, CornerByEveryUnknown) {
  // Unknowns in the order camera, board, pose.
  const auto residual = [&](const Eigen::VectorXd& step) -> Eigen::VectorXd {
    const ViewGeometry view = view_geometry(moved(T_robot_camera, step.head<6>()),
                                            moved(T_world_board, step.segment<6>(6)), moved(pose, step.tail<6>()));
    CornerResidual value;
    EXPECT_TRUE(corner_residual(camera, view.T_camera_board * corner, {100.0, 200.0}, &value));
    return value.value;
  };
  const ViewGeometry view = view_geometry(T_robot_camera, T_world_board, pose);
  CornerResidual value;
  ASSERT_TRUE(corner_residual(camera, view.T_camera_board * corner, {100.0, 200.0}, &value));
  Eigen::MatrixXd twist(6, 18);
  twist << view.twist_by_camera, view.twist_by_board, view.twist_by_pose;
  expect_near(differences(18, residual), value.by_twist * twist);
}

TEST_P(Residuals, CornerByItsPlace) {
  const Eigen::Vector3d point = view_geometry(T_robot_camera, T_world_board, pose).T_camera_board * corner;
  const auto residual = [&](const Eigen::VectorXd& step) -> Eigen::VectorXd {
    CornerResidual value;
    EXPECT_TRUE(corner_residual(camera, point + step, {0.0, 0.0}, &value));
    return value.value;
  };
  CornerResidual value;
  ASSERT_TRUE(corner_residual(camera, point, {0.0, 0.0}, &value));
  expect_near(differences(3, residual), value.by_point);
}

TEST_P(Residuals, BoardPlaneByEveryUnknown) {
  const double bias = 0.01;
  const auto residual = [&](const Eigen::VectorXd& step) -> Eigen::VectorXd {
    const ViewGeometry view = view_geometry(moved(T_robot_camera, step.head<6>()),
                                            moved(T_world_board, step.segment<6>(6)), moved(pose, step.segment<6>(12)));
    return board_plane_residual(view.T_camera_board, bias + step[18], {0.1, 0.2, 0.3}).value;
  };
  const ViewGeometry view = view_geometry(T_robot_camera, T_world_board, pose);
  const BoardPlaneResidual value = board_plane_residual(view.T_camera_board, bias, {0.1, 0.2, 0.3});
  Eigen::MatrixXd J(3, 19);
  J << value.by_twist * view.twist_by_camera, value.by_twist * view.twist_by_board, value.by_twist * view.twist_by_pose,
      value.by_depth_bias;
  expect_near(differences(19, residual), J);
}

TEST_P(Residuals, GroundByEveryUnknown) {
  const double bias = -0.01;
  const auto residual = [&](const Eigen::VectorXd& step) -> Eigen::VectorXd {
    return ground_residual(moved(T_robot_camera, step.head<6>()), moved(pose, step.segment<6>(6)), bias + step[12],
                           {0.1, 0.2, 0.3})
        .value;
  };
  const GroundResidual value = ground_residual(T_robot_camera, pose, bias, {0.1, 0.2, 0.3});
  Eigen::MatrixXd J(3, 13);
  J << value.by_camera, value.by_pose, value.by_depth_bias;
  expect_near(differences(13, residual), J);
}

TEST_P(Residuals, IncrementByEveryUnknown) {
  RobotPose to = pose;
  to.x_m += 0.7;
  to.y_m -= 0.4;
  to.yaw_rad += 0.5;
  const VeeringIncrement measured = {{0.6, 0.1, 0.45}, {0.05, -0.3, -0.6}, kPoint_m};
  const auto residual = [&](const Eigen::VectorXd& step) -> Eigen::VectorXd {
    Eigen::VectorXd from_step = Eigen::VectorXd::Zero(6), to_step = Eigen::VectorXd::Zero(6);
    from_step.head<3>() = step.head<3>();
    to_step.head<3>() = step.segment<3>(3);
    return increment_residual(moved(pose, from_step), moved(to, to_step),
                              {1.02 + step[6], 0.97 + step[7], 0.05 + step[8]}, measured)
        .value;
  };
  const IncrementResidual value = increment_residual(pose, to, {1.02, 0.97, 0.05}, measured);
  Eigen::MatrixXd J(3, 9);
  J << value.by_from, value.by_to, value.by_factors, value.by_veer;
  expect_near(differences(9, residual), J);
}

TEST_P(Residuals, AbsoluteOdometryByEveryUnknown) {
  Stop measured;
  measured.x_m = 0.3;
  measured.yaw_rad = 0.1;
  const PoseResidual value = pose_residual(pose, measured, kPoint_m);
  expect_near(differences(3,
                          [&](const Eigen::VectorXd& step) -> Eigen::VectorXd {
                            Vector6d all = Vector6d::Zero();
                            all.head<3>() = step;
                            return pose_residual(moved(pose, all), measured, kPoint_m).value;
                          }),
              value.by_pose);
}

// A way of turns, arcs and a way back, as odometry measured it.
Stop driven_stop(RandomStream* random) {
  Stop stop;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d pose(random->uniform(-2, 2), random->uniform(-2, 2), random->uniform(-3, 3));
    if (i < 5) {
      stop.way.push_back(pose);
      stop.way.emplace_back(pose.x(), pose.y(), pose.z() + random->uniform(-1, 1));  // on the spot
    } else {
      stop.x_m = pose.x();
      stop.y_m = pose.y();
      stop.yaw_rad = pose.z();
    }
  }
  return stop;
}

TEST_P(Residuals, WayByEveryUnknown) {
  RandomStream random(static_cast<std::uint64_t>(GetParam()), "way test");
  const OdometryWay way(Stop(), driven_stop(&random), kPoint_m);
  const double scale = 1.02, factor = 1.05, veer = 0.07;
  RobotPose to = pose;
  to.x_m += 0.6;
  to.yaw_rad += way.motion(factor, veer).value.z() / factor + 0.1;
  const IncrementResidual analytic = way_residual(pose, to, {scale, factor, veer}, way);
  const Eigen::MatrixXd J = differences(9, [&](const Eigen::VectorXd& step) {
    Vector6d a = Vector6d::Zero(), b = Vector6d::Zero();
    a.head<3>() = step.head<3>();
    b.head<3>() = step.segment<3>(3);
    return way_residual(moved(pose, a), moved(to, b), {scale + step[6], factor + step[7], veer + step[8]}, way).value;
  });
  Eigen::MatrixXd expected(3, 9);
  expected << analytic.by_from, analytic.by_to, analytic.by_factors, analytic.by_veer;
  expect_near(J, expected);
}

TEST(OdometryWay, EndsWhereTheStopIs) {
  RandomStream random(3, "way test");
  Stop from;
  from.x_m = 1.0;
  from.yaw_rad = 2.0;
  const Stop to = driven_stop(&random);
  const Eigen::Vector3d motion = OdometryWay(from, to, Eigen::Vector2d::Zero()).motion(1.0).value,
                        expected = measured_increment(from, to);
  EXPECT_NEAR((motion - expected).head<2>().norm(), 0.0, 1e-12);
  EXPECT_NEAR(wrap_angle(motion.z() - expected.z()), 0.0, 1e-12);
}

// A quarter turn that was a little less bends the two metres after it; the turn at the end bends nothing.
TEST(OdometryWay, ATurnsErrorBendsTheWayAfterIt) {
  Stop to;
  to.way = {{0, 0, kPi / 2}, {0, 2, kPi / 2}};
  to.x_m = 0.0;
  to.y_m = 2.0;
  to.yaw_rad = kPi;
  const OdometryWay way(Stop(), to, Eigen::Vector2d::Zero());
  const double factor = 1.05, turned = kPi / 2 / factor;
  const Eigen::Vector2d end = way.motion(factor).value.head<2>();
  EXPECT_NEAR((end - 2.0 * Eigen::Vector2d(std::cos(turned), std::sin(turned))).norm(), 0.0, 1e-12);
  // Heading noise of the first turn alone moves the end sideways, by two metres a radian.
  const Eigen::Matrix3d turning = way.noise_of_heading({OdometryModel::kPerIncrement, true, 0.0});
  EXPECT_NEAR(turning(0, 0) / (kPi / 2), 4.0, 0.3);
  EXPECT_NEAR(turning(2, 2), kPi, 0.3);
  // Two metres that lose as much heading as turns of 3 rad, half a way before the end in the mean.
  const Eigen::Matrix3d straying = way.noise_of_heading({OdometryModel::kPerIncrement, true, 3.0}) - turning;
  EXPECT_NEAR(straying(2, 2), 6.0, 1e-12);
  EXPECT_NEAR(straying(0, 2) / 6.0, -1.0, 1e-12);
  EXPECT_NEAR(way.noise_of_translation()(0, 0), 2.0, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Random, Residuals, testing::Range(0, 8));

TEST(GroundResidual, IsZeroOnTheTruePlane) {
  const Rigid3 T_robot_camera(so3_exp({-1.9, 0.3, -0.4}), {0.3, 0.1, 0.7});
  RobotPose pose;
  pose.height_m = 0.01;
  pose.roll_rad = 0.02;
  const Rigid3 T_world_camera = pose.transform() * T_robot_camera;
  // Any point on the floor has a . p = 1.
  const Eigen::Vector3d a = -ground_residual(T_robot_camera, pose, 0.0, Eigen::Vector3d::Zero()).value;
  const Eigen::Vector3d on_floor = T_world_camera.inverse() * Eigen::Vector3d(1.2, -0.7, 0.0);
  EXPECT_NEAR(-a.dot(on_floor), 1.0, 1e-12);
}

TEST(RobotPose, SurvivesTheTransform) {
  RobotPose pose;
  pose.x_m = 1.0;
  pose.y_m = -2.0;
  pose.yaw_rad = 2.9;
  pose.height_m = 0.01;
  pose.roll_rad = 0.03;
  pose.pitch_rad = -0.02;
  const RobotPose again = RobotPose::from_transform(pose.transform());
  EXPECT_NEAR(again.yaw_rad, pose.yaw_rad, 1e-12);
  EXPECT_NEAR(again.roll_rad, pose.roll_rad, 1e-12);
  EXPECT_NEAR(again.pitch_rad, pose.pitch_rad, 1e-12);
  EXPECT_NEAR(again.height_m, pose.height_m, 1e-15);
}

}  // namespace
}  // namespace rigproof::ml
