#include "rigproof/core/rigid3.h"

#include <gtest/gtest.h>

#include "pose_near.h"
#include "random_values.h"
#include "rigproof/core/body_axes.h"

namespace rigproof {
namespace {

// Entries are of order 1 to 10; a chain of a dozen operations rounds to a few 1e-15.
constexpr double kRounding = 1e-13;

Rigid3 expected_exp(const Vector6d& xi) {
  // The matrix exponential by its power series: an independent way to the same motion.
  Eigen::Matrix4d hat = Eigen::Matrix4d::Zero();
  hat.topLeftCorner<3, 3>() = skew(xi.tail<3>());
  hat.topRightCorner<3, 1>() = xi.head<3>();
  Eigen::Matrix4d term = Eigen::Matrix4d::Identity(), sum = term;
  for (int n = 1; n < 60; ++n) {
    term = term * hat / n;
    sum += term;
  }
  return Rigid3::from_matrix(sum);
}

Vector6d random_twist(RandomStream& random, double max_angle_rad) {
  Vector6d xi;
  xi << random_vector(random, 2.0), random_rotation_vector(random, max_angle_rad);
  return xi;
}

TEST(Rigid3, ExponentialIsThePowerSeries) {
  RandomStream random(1, "exp");
  for (int i = 0; i < 200; ++i) {
    const Vector6d xi = random_twist(random, 3.14);
    EXPECT_TRUE(IsPoseNear(expected_exp(xi), se3_exp(xi), 1e-12, 1e-12));
  }
}

// From angles far below the switch to Taylor terms, through it, to nearly pi.
TEST(Rigid3, LogarithmInvertsExponentialAtEveryAngle) {
  RandomStream random(2, "log");
  for (const double angle : {0.0, 1e-12, 1e-8, 1e-6, 0.9e-3, 1.0e-3, 1.1e-3, 0.1, 1.0, 2.0, 3.0, 3.1415}) {
    for (int i = 0; i < 20; ++i) {
      Vector6d xi = random_twist(random, 1.0);
      xi.tail<3>() = xi.tail<3>().normalized() * angle;
      // Near pi the logarithm's left Jacobian is large: 1 / (pi - angle) of rounding.
      EXPECT_LT((se3_log(se3_exp(xi)) - xi).norm(), angle > 3.1 ? 1e-9 : 1e-12) << angle;
    }
  }
}

TEST(Rigid3, LogarithmIsTheShorterWay) {
  const Eigen::Quaterniond q = so3_exp({0.0, 0.0, 3.5});
  EXPECT_NEAR(so3_log(q).z(), 3.5 - 2.0 * kPi, 1e-14);
  EXPECT_NEAR(so3_log(Eigen::Quaterniond(-q.coeffs())).z(), 3.5 - 2.0 * kPi, 1e-14);
}

TEST(Rigid3, LeftJacobianAndItsInverse) {
  RandomStream random(3, "left jacobian");
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d phi = random_rotation_vector(random, 3.0);
    const Eigen::Matrix3d J = so3_left_jacobian(phi);
    EXPECT_LT((J * so3_left_jacobian_inverse(phi) - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    // Exp(phi + d) = Exp(J d) Exp(phi): central differences, truncation step^2.
    const double step = 1e-5;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d d = step * Eigen::Vector3d::Unit(axis);
      const Eigen::Vector3d slope = (so3_log(so3_exp(phi + d) * so3_exp(phi).conjugate()) -
                                     so3_log(so3_exp(phi - d) * so3_exp(phi).conjugate())) /
                                    (2.0 * step);
      EXPECT_LT((slope - J.col(axis)).norm(), 1e-9);
    }
  }
}

TEST(Rigid3, GroupLaws) {
  RandomStream random(4, "group");
  for (int i = 0; i < 200; ++i) {
    const Rigid3 A = random_transform(random), B = random_transform(random), C = random_transform(random);
    EXPECT_TRUE(IsPoseNear((A * B) * C, A * (B * C), kRounding, kRounding));
    EXPECT_TRUE(IsPoseNear(Rigid3(), A * A.inverse(), kRounding, kRounding));
    EXPECT_TRUE(IsPoseNear(B.inverse() * A.inverse(), (A * B).inverse(), kRounding, kRounding));
    const Eigen::Vector3d p = random_vector(random, 3.0);
    EXPECT_LT(((A * B) * p - A * (B * p)).norm(), kRounding);
    EXPECT_LT((A.matrix() * p.homogeneous() - (A * p).homogeneous()).norm(), kRounding);
    EXPECT_TRUE(IsPoseNear(A, Rigid3::from_matrix(A.matrix()), kRounding, kRounding));
  }
}

TEST(Rigid3, ErrorChartIsInvertible) {
  RandomStream random(6, "chart");
  for (int i = 0; i < 100; ++i) {
    const Rigid3 T = random_transform(random);
    const Vector6d error = random_twist(random, 3.0);
    EXPECT_LT((transform_error(apply_transform_error(T, error), T) - error).norm(), 1e-12);
  }
}

// The error is along the parent's axes: a camera moved along robot x shows as tx, whatever way the camera looks.
TEST(Rigid3, ErrorIsAlongTheParentsAxes) {
  RandomStream random(7, "parent axes");
  const Rigid3 T = random_transform(random);
  Rigid3 moved = T;
  moved.translation.x() += 0.01;
  moved.rotation = rotation_z(0.02) * moved.rotation;
  Vector6d expected;
  expected << 0.01, 0.0, 0.0, 0.0, 0.0, 0.02;
  EXPECT_LT((transform_error(moved, T) - expected).norm(), 1e-14);
}

TEST(Rigid3, PlanarPoses) {
  const Rigid3 T = planar_pose(1.0, 2.0, 0.5 * kPi);
  EXPECT_LT((T * Eigen::Vector3d(1.0, 0.0, 0.0) - Eigen::Vector3d(1.0, 3.0, 0.0)).norm(), 1e-15);
  EXPECT_NEAR(yaw_of(T), 0.5 * kPi, 1e-15);
}

TEST(Rigid3, AnglesWrapToTheHalfOpenInterval) {
  EXPECT_EQ(wrap_angle(kPi), kPi);
  EXPECT_EQ(wrap_angle(-kPi), kPi);
  EXPECT_NEAR(wrap_angle(7.0), 7.0 - 2.0 * kPi, 1e-15);
  EXPECT_NEAR(wrap_angle(-100.0), -100.0 + 32.0 * kPi, 1e-13);
}

// A camera that looks straight down: roll and yaw turn about nearly one axis, and must still give the rotation back.
TEST(BodyAxes, RollPitchYawGiveTheRotationBackNearThePole) {
  for (const double off_pole_rad : {2e-9, 1e-8, 1e-6, 1e-3, 0.5}) {
    const Eigen::Quaterniond R = from_roll_pitch_yaw({0.3, 0.5 * kPi - off_pole_rad, 0.7});
    EXPECT_LT(so3_log(from_roll_pitch_yaw(roll_pitch_yaw(R)) * R.conjugate()).norm(), 1e-14) << off_pole_rad;
  }
  // At the pole itself all of the turn is called yaw.
  const Eigen::Quaterniond down = from_roll_pitch_yaw({0.3, 0.5 * kPi, 0.7});
  EXPECT_EQ(roll_pitch_yaw(down).x(), 0.0);
  EXPECT_LT(so3_log(from_roll_pitch_yaw(roll_pitch_yaw(down)) * down.conjugate()).norm(), 1e-9);
}

TEST(BodyAxes, OpticalAxesAreTheBodysTurned) {
  EXPECT_LT((optical_from_body() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitZ()).norm(), 1e-15);  // forward
  EXPECT_LT((optical_from_body() * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitX()).norm(), 1e-15);  // left
  EXPECT_LT((optical_from_body() * Eigen::Vector3d::UnitZ() + Eigen::Vector3d::UnitY()).norm(), 1e-15);  // up
}

}  // namespace
}  // namespace rigproof
