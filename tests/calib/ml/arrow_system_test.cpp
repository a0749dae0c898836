#include "rigproof/calib/estimate/arrow_system.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "rigproof/core/random.h"

namespace rigproof::ml {
namespace {

constexpr int kPoses = 7, kGlobals = 9;

Eigen::MatrixXd random_matrix(RandomStream& random, int rows, int columns) {
  Eigen::MatrixXd matrix(rows, columns);
  for (int i = 0; i < rows * columns; ++i) matrix(i) = random.normal();
  return matrix;
}

// A sum of squares over neighbouring poses and the globals, so positive definite and of the arrow's shape.
ArrowSystem random_system(Eigen::MatrixXd* dense, Eigen::VectorXd* gradient) {
  RandomStream random(3, "arrow test");
  const int n = 6 * kPoses + kGlobals;
  *dense = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < kPoses; ++i) {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(20, n);
    const int first = std::max(0, i - 1);
    J.middleCols(6 * first, 6 * (i - first + 1)) = random_matrix(random, 20, 6 * (i - first + 1));
    J.rightCols(kGlobals) = random_matrix(random, 20, kGlobals);
    *dense += J.transpose() * J;
  }
  *gradient = random_matrix(random, n, 1);
  ArrowSystem system(kPoses, kGlobals);
  for (int i = 0; i < kPoses; ++i) {
    system.diagonal[static_cast<std::size_t>(i)] = dense->block<6, 6>(6 * i, 6 * i);
    if (i > 0) system.coupling[static_cast<std::size_t>(i)] = dense->block<6, 6>(6 * i, 6 * i - 6);
  }
  system.pose_global = dense->topRightCorner(6 * kPoses, kGlobals);
  system.global = dense->bottomRightCorner(kGlobals, kGlobals);
  system.pose_gradient = gradient->head(6 * kPoses);
  system.global_gradient = gradient->tail(kGlobals);
  return system;
}

// Everything is compared with dense linear algebra of condition about 1e3: 1e-10 leaves three digits of room.
constexpr double kTolerance = 1e-10;

void expect_blocks_of(const Eigen::MatrixXd& dense, const EliminatedSystem::PoseCovariance& found) {
  EXPECT_LE((dense.topRightCorner(6 * kPoses, kGlobals) - found.with_globals).norm(), kTolerance);
  for (int i = 0; i < kPoses; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    EXPECT_LE((dense.block<6, 6>(6 * i, 6 * i) - found.diagonal[k]).norm(), kTolerance) << i;
    if (i == 0) continue;
    EXPECT_LE((dense.block<6, 6>(6 * i, 6 * i - 6) - found.with_previous[k]).norm(), kTolerance) << i;
  }
}

TEST(ArrowSystem, StepEqualsTheDenseSolution) {
  Eigen::MatrixXd dense;
  Eigen::VectorXd gradient, pose_step, global_step;
  const ArrowSystem system = random_system(&dense, &gradient);
  const auto eliminated = EliminatedSystem::eliminate(system, 0.0);
  ASSERT_TRUE(eliminated && eliminated->step(&pose_step, &global_step));
  const Eigen::VectorXd expected = -dense.ldlt().solve(gradient);
  EXPECT_LE((expected.head(6 * kPoses) - pose_step).norm(), kTolerance);
  EXPECT_LE((expected.tail(kGlobals) - global_step).norm(), kTolerance);
}

TEST(ArrowSystem, CovarianceEqualsTheDenseInverse) {
  Eigen::MatrixXd dense;
  Eigen::VectorXd gradient;
  const ArrowSystem system = random_system(&dense, &gradient);
  const auto eliminated = EliminatedSystem::eliminate(system, 0.0);
  ASSERT_TRUE(eliminated);
  const Eigen::MatrixXd inverse = dense.inverse();
  const Eigen::MatrixXd globals = eliminated->schur().inverse();
  EXPECT_LE((inverse.bottomRightCorner(kGlobals, kGlobals) - globals).norm(), kTolerance);
  const EliminatedSystem::PoseCovariance covariance = eliminated->pose_covariance(globals);
  expect_blocks_of(inverse, covariance);
}

TEST(ArrowSystem, SquaresFromEachPoseEqualTheDenseOnes) {
  Eigen::MatrixXd dense;
  Eigen::VectorXd gradient;
  const auto eliminated = EliminatedSystem::eliminate(random_system(&dense, &gradient), 0.0);
  ASSERT_TRUE(eliminated);
  RandomStream random(5, "arrow test");
  const Eigen::MatrixXd coupling = random_matrix(random, 6 * kPoses, 6);
  std::vector<Matrix6d> B;
  for (int i = 0; i < kPoses; ++i) B.emplace_back(coupling.middleRows<6>(6 * i));
  const Eigen::MatrixXd inverse = dense.topLeftCorner(6 * kPoses, 6 * kPoses).inverse();
  const std::vector<Matrix6d> squares = eliminated->squares_from_each_pose(B);
  for (int k = 0; k < kPoses; ++k) {
    Eigen::MatrixXd from = coupling;
    from.topRows(6 * k).setZero();
    const Matrix6d expected = from.transpose() * inverse * from;
    EXPECT_LE((expected - squares[static_cast<std::size_t>(k)]).norm(), kTolerance * expected.norm()) << k;
  }
  const Eigen::MatrixXd response = inverse * dense.topRightCorner(6 * kPoses, kGlobals);
  EXPECT_LE((response.transpose() - eliminated->pose_response().topRows(kGlobals)).norm(), kTolerance);
}

TEST(ArrowSystem, LogDeterminantEqualsTheDenseOne) {
  Eigen::MatrixXd dense;
  Eigen::VectorXd gradient;
  const auto eliminated = EliminatedSystem::eliminate(random_system(&dense, &gradient), 0.0);
  ASSERT_TRUE(eliminated);
  const double expected = 2.0 * Eigen::MatrixXd(dense.llt().matrixL()).diagonal().array().log().sum();
  EXPECT_NEAR(expected, eliminated->log_determinant_of_poses() + eliminated->log_determinant_of_globals(), 1e-9);
}

// Two fields, of which each couples with some poses; together of fewer unknowns than the poses, or of more.
struct WithFields {
  explicit WithFields(int numbers) : system(random_system(&dense, &gradient)) {
    RandomStream random(7, "arrow test");
    const int others = 6 * kPoses + kGlobals, n = others + 2 * numbers;
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, n);
    all.topLeftCorner(others, others) = dense;
    for (int f = 0; f < 2; ++f) {
      Eigen::MatrixXd J = random_matrix(random, 2 * numbers, n);
      J.leftCols(6 * (2 + f)).setZero();
      J.middleCols(6 * (4 + f), 6 * (3 - f)).setZero();
      J.middleCols(others + (1 - f) * numbers, numbers).setZero();
      // As if poses and globals were observed so that only what the field couples with is there.
      Eigen::MatrixXd H = J.transpose() * J;
      for (int i = 0; i < kPoses; ++i)  // the chain of poses stays one
        for (int j = 0; j + 1 < i; ++j) {
          H.block<6, 6>(6 * i, 6 * j).setZero();
          H.block<6, 6>(6 * j, 6 * i).setZero();
        }
      all += H;
    }
    all.diagonal().array() += 30.0;
    dense = all;
    gradient = random_matrix(random, n, 1);
    for (int i = 0; i < kPoses; ++i) {
      system.diagonal[static_cast<std::size_t>(i)] = dense.block<6, 6>(6 * i, 6 * i);
      if (i > 0) system.coupling[static_cast<std::size_t>(i)] = dense.block<6, 6>(6 * i, 6 * i - 6);
    }
    system.pose_global = dense.block(0, 6 * kPoses, 6 * kPoses, kGlobals);
    system.global = dense.block(6 * kPoses, 6 * kPoses, kGlobals, kGlobals);
    system.pose_gradient = gradient.head(6 * kPoses);
    system.global_gradient = gradient.segment(6 * kPoses, kGlobals);
    for (int f = 0; f < 2; ++f) {
      FieldEquations& field = system.fields.emplace_back(kPoses, kGlobals, numbers);
      const int at = others + f * numbers;
      field.own = dense.block(at, at, numbers, numbers).triangularView<Eigen::Lower>();
      field.with_poses = dense.block(0, at, 6 * kPoses, numbers);
      field.with_globals = dense.block(6 * kPoses, at, kGlobals, numbers);
      field.gradient = gradient.segment(at, numbers);
    }
  }
  Eigen::MatrixXd dense;  // poses, globals, the fields
  Eigen::VectorXd gradient;
  ArrowSystem system;
};

class ArrowSystemWithFields : public testing::TestWithParam<int> {};

TEST_P(ArrowSystemWithFields, StepAndInverseEqualTheDenseOnes) {
  const int numbers = GetParam(), others = 6 * kPoses + kGlobals;
  const WithFields with(numbers);
  ASSERT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(with.dense).eigenvalues().minCoeff(), 1.0);
  const auto eliminated = EliminatedSystem::eliminate(with.system, 0.0);
  Eigen::VectorXd pose_step, global_step;
  ASSERT_TRUE(eliminated && eliminated->step(&pose_step, &global_step));
  const Eigen::VectorXd expected = -with.dense.ldlt().solve(with.gradient);
  EXPECT_LE((expected.head(6 * kPoses) - pose_step).norm(), kTolerance);
  EXPECT_LE((expected.segment(6 * kPoses, kGlobals) - global_step).norm(), kTolerance);

  const Eigen::MatrixXd inverse = with.dense.inverse();
  const Eigen::MatrixXd globals = eliminated->schur().inverse();
  EXPECT_LE((inverse.block(6 * kPoses, 6 * kPoses, kGlobals, kGlobals) - globals).norm(), kTolerance);
  EXPECT_TRUE(eliminated->schur().isApprox(eliminated->schur().transpose(), kTolerance));
  const Eigen::MatrixXd poses = -globals * eliminated->pose_response().topRows(kGlobals);
  EXPECT_LE((inverse.block(6 * kPoses, 0, kGlobals, 6 * kPoses) - poses).norm(), kTolerance);
  for (int f = 0; f < 2; ++f) {
    const FieldEquations& field = with.system.fields[static_cast<std::size_t>(f)];
    const int at = others + f * numbers;
    EXPECT_LE((expected.segment(at, numbers) - field.step(pose_step, global_step)).norm(), kTolerance);
    EXPECT_LE((inverse.block(6 * kPoses, at, kGlobals, numbers) - field.columns_of_inverse(poses, globals)).norm(),
              kTolerance);
  }
}
INSTANTIATE_TEST_SUITE_P(OfFewAndManyNumbers, ArrowSystemWithFields, testing::Values(5, 40));

TEST(ArrowSystem, FixedUnknownsDoNotMoveBesideFields) {
  for (const int numbers : {5, 40}) {
    WithFields with(numbers);
    with.system.fix_pose_unknown(2, 4);
    with.system.fix_global_unknown(3);
    const auto eliminated = EliminatedSystem::eliminate(with.system, 0.0);
    Eigen::VectorXd pose_step, global_step;
    ASSERT_TRUE(eliminated && eliminated->step(&pose_step, &global_step));
    EXPECT_NEAR(pose_step[6 * 2 + 4], 0.0, 1e-20);
    EXPECT_NEAR(global_step[3], 0.0, 1e-20);
    EXPECT_GT(global_step.norm(), 1e-4);
  }
}

TEST(ArrowSystem, FixedUnknownsDoNotMove) {
  Eigen::MatrixXd dense;
  Eigen::VectorXd gradient, pose_step, global_step;
  ArrowSystem system = random_system(&dense, &gradient);
  system.fix_pose_unknown(2, 4);
  system.fix_global_unknown(3);
  const auto eliminated = EliminatedSystem::eliminate(system, 0.0);
  ASSERT_TRUE(eliminated && eliminated->step(&pose_step, &global_step));
  EXPECT_EQ(pose_step[6 * 2 + 4], 0.0);
  EXPECT_EQ(global_step[3], 0.0);
}

TEST(ArrowSystem, SingularPosesAreReported) { EXPECT_FALSE(EliminatedSystem::eliminate(ArrowSystem(2, 1), 0.0)); }

}  // namespace
}  // namespace rigproof::ml
