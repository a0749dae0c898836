#include "rigproof/validate/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rigproof/core/random.h"
#include "synthetic.h"

namespace rigproof {
namespace {

using testing_support::draw;
using testing_support::random_covariance;

TEST(Statistics, ChiSquareQuantilesMatchTables) {
  // Abramowitz and Stegun, table 26.8, and NIST's Engineering Statistics Handbook 1.3.6.7.4, to their printed digits.
  EXPECT_NEAR(chi_square_quantile(0.95, 1), 3.841, 5e-4);
  EXPECT_NEAR(chi_square_quantile(0.975, 6), 14.449, 5e-4);
  EXPECT_NEAR(chi_square_quantile(0.025, 6), 1.237, 5e-4);
  EXPECT_NEAR(chi_square_quantile(0.975, 18), 31.526, 5e-4);
  EXPECT_NEAR(chi_square_quantile(0.025, 18), 8.231, 5e-4);
  EXPECT_NEAR(chi_square_quantile(0.999, 100), 149.449, 5e-4);
}

TEST(Statistics, TailHasItsClosedForms) {
  // P(chi-square > 2 x) is e^-x with two degrees of freedom and erfc(sqrt x) with one; 1e-13 is a thousand roundings.
  for (const double x : {1e-6, 0.3, 1.0, 2.5, 20.0}) {
    EXPECT_NEAR(chi_square_tail(2.0 * x, 2.0), std::exp(-x), 1e-13);
    EXPECT_NEAR(chi_square_tail(2.0 * x, 1.0), std::erfc(std::sqrt(x)), 1e-13);
  }
  EXPECT_EQ(chi_square_tail(0.0, 6.0), 1.0);
}

TEST(Statistics, QuantileInvertsTheDistribution) {
  for (const double dof : {1.0, 6.0, 18.0, 48.0})
    for (const double p : {0.001, 0.025, 0.5, 0.975, 0.999})
      EXPECT_NEAR(chi_square_tail(chi_square_quantile(p, dof), dof), 1.0 - p, 1e-13);
}

TEST(Statistics, TailIsAccurateFarOut) {
  EXPECT_NEAR(chi_square_tail(14.449, 6), 0.025, 1e-5);
  // Two degrees: e^(-x/2), where 1 - P has no digit left.
  EXPECT_NEAR(chi_square_tail(200.0, 2.0) / std::exp(-100.0), 1.0, 1e-12);
  EXPECT_EQ(chi_square_tail(0.0, 3.0), 1.0);
}

TEST(Statistics, NoncentralTailIsThatOfShiftedNormals) {
  RandomStream random(1, "noncentral");
  constexpr int kDraws = 40000;
  int beyond = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double a = random.normal() + 2.0, b = random.normal() - 1.0, c = random.normal();
    beyond += a * a + b * b + c * c > 9.0 ? 1 : 0;
  }
  // Four standard deviations of a share of 40,000.
  EXPECT_NEAR(noncentral_chi_square_tail(9.0, 3.0, 5.0), static_cast<double>(beyond) / kDraws, 0.01);
  EXPECT_NEAR(noncentral_chi_square_tail(9.0, 3.0, 0.0), chi_square_tail(9.0, 3.0), 1e-14);
}

Rigid3 random_pose(RandomStream& random) {
  return Rigid3(so3_exp({random.normal(), random.normal(), random.normal()}),
                {random.normal(), random.normal(), random.normal()});
}

// Each Jacobian against a central difference; with steps of 1e-6 the difference is good to about 1e-9.
template <int Columns, typename Function>
Eigen::Matrix<double, 6, Columns> numeric_jacobian(const Function& function) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix<double, 6, Columns> J;
  for (int i = 0; i < Columns; ++i) {
    Eigen::Matrix<double, Columns, 1> step = Eigen::Matrix<double, Columns, 1>::Zero();
    step[i] = kStep;
    J.col(i) = (function(step) - function(-step)) / (2.0 * kStep);
  }
  return J;
}

TEST(Statistics, JacobiansMatchDifferences) {
  RandomStream random(5, "jacobians");
  for (int i = 0; i < 20; ++i) {
    const Rigid3 A = random_pose(random), B = random_pose(random);
    const auto left = numeric_jacobian<6>(
        [&](const Vector6d& e) { return Vector6d(se3_log(apply_transform_error(A, e) * A.inverse())); });
    EXPECT_LT((left - left_perturbation_jacobian(A)).norm(), 1e-8);
    const auto inverse = numeric_jacobian<6>(
        [&](const Vector6d& e) { return transform_error(apply_transform_error(A, e).inverse(), A.inverse()); });
    EXPECT_LT((inverse - inverse_error_jacobian(A)).norm(), 1e-8);
    const auto relative = numeric_jacobian<12>([&](const Eigen::Matrix<double, 12, 1>& e) {
      const Rigid3 moved_a = apply_transform_error(A, e.head<6>()), moved_b = apply_transform_error(B, e.tail<6>());
      return transform_error(moved_a.inverse() * moved_b, A.inverse() * B);
    });
    EXPECT_LT((relative - relative_error_jacobian(A, B)).norm(), 1e-8);
    const auto of_inverses = numeric_jacobian<12>([&](const Eigen::Matrix<double, 12, 1>& e) {
      const Rigid3 moved_a = apply_transform_error(A, e.head<6>()), moved_b = apply_transform_error(B, e.tail<6>());
      return transform_error(moved_a * moved_b.inverse(), A * B.inverse());
    });
    EXPECT_LT((of_inverses - relative_error_jacobian_of_inverses(A, B)).norm(), 1e-8);
  }
}

TEST(Statistics, NormalisedErrorHasTheMeanOfItsDegreesOfFreedom) {
  RandomStream random(9, "nees");
  const Rigid3 T = random_pose(random);
  Vector6d sigmas;
  sigmas << 1e-3, 2e-3, 5e-4, 1e-4, 3e-4, 2e-4;
  const Eigen::MatrixXd covariance = random_covariance(sigmas, random);
  double sum = 0.0;
  constexpr int kDraws = 4000;
  for (int i = 0; i < kDraws; ++i) {
    const Rigid3 estimate = apply_transform_error(T, Vector6d(draw(covariance, random)));
    sum += *normalised_error_squared({estimate}, {T}, covariance);
  }
  // The mean of 4000 draws of chi-square with 6 degrees has the standard deviation sqrt(12 / 4000) = 0.055: 4 sigma.
  EXPECT_NEAR(sum / kDraws, 6.0, 0.22);
}

TEST(Statistics, NormalisedErrorRefusesWhatIsNoCovariance) {
  const Rigid3 T;
  EXPECT_FALSE(normalised_error_squared({T}, {T}, Eigen::MatrixXd::Zero(6, 6)));
  EXPECT_FALSE(normalised_error_squared({T}, {T}, -Eigen::MatrixXd::Identity(6, 6)));
  EXPECT_FALSE(normalised_error_squared({T}, {T}, Eigen::MatrixXd::Identity(12, 12)));
}

}  // namespace
}  // namespace rigproof
