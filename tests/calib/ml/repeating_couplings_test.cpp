// Errors that repeat in every image are many, and most of their equations are zero: what leaves zeros out is what the
// whole matrices give.
#include "repeating_couplings.h"

#include <gtest/gtest.h>

#include <utility>

#include "past_boards.h"
#include "rigproof/calib/estimate/fit.h"
#include "rigproof/calib/estimate/preparation.h"
#include "rigproof/calib/estimate/repeating_covariance.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof::ml {
namespace {

// Nothing is said of lenses and boards, and one camera's lens is believed. A camera sees a board of its own.
class RepeatingCouplingsTest : public testing::Test {
 protected:
  RepeatingCouplingsTest() : run_(drive()), prepared_(prepare(run_.observations, options_)) {}

  static GeometricRun drive() {
    GeometricRun run = PastTwoBoards(0, 24).drawn();
    run.observations.board.doubt();
    run.observations.more_boards[0].doubt();
    for (std::size_t c = 1; c < run.observations.cameras.size(); ++c)
      run.observations.cameras[c].intrinsics_sigma = IntrinsicsSigma();
    return run;
  }

  GeometricRun run_;
  MlOptions options_;
  Preparation prepared_;
};

TEST_F(RepeatingCouplingsTest, ByUnknownsIsTheWholeMatrixTransposed) {
  const RepeatingErrors& errors = prepared_.repeating.errors;
  ASSERT_LT(errors.field(0), 0);
  ASSERT_GE(errors.field(1), 0);
  ASSERT_GE(errors.print(0, 0), 0);
  ASSERT_GE(errors.print(1, 0), errors.print(0, 0) + 3 * run_.observations.board.corner_count());
  const Eigen::MatrixXd any = Eigen::MatrixXd::Random(errors.raw_size(), 7);
  const Eigen::MatrixXd whole = errors.raw_by_unknowns().transpose() * any;
  EXPECT_TRUE(errors.by_unknowns(any).isApprox(whole, 1e-12));
}

// Cost of the corners of a problem, its robust weights aside, by displacing corners as an error of unit variance would.
TEST_F(RepeatingCouplingsTest, EquationsAreThoseOfCornersThatErrorsDisplace) {
  const Fit fit = fit_model(prepared_, {OdometryModel::kPerIncrement, false});
  const RemovedErrors& repeating = prepared_.repeating;
  const auto gradient_with = [&](const RemovedErrors& moved) {
    Observations used = prepared_.used;
    remove_repeating(moved, prepared_.views, &used);
    return Problem(used, prepared_.priors, fit.noise).linearise(fit.state, Weighting::kUnit, nullptr, nullptr);
  };
  const Problem problem(prepared_.used, prepared_.priors, fit.noise);
  const ArrowSystem all = problem.linearise_with(repeating, fit.state, Weighting::kUnit);
  const Eigen::Index globals = problem.layout().globals();
  ASSERT_EQ(all.fields.size(), run_.observations.cameras.size() - 1);
  RemovedErrors none = repeating;
  none.value.setZero();
  for (RemovedErrors::Fine& fine : none.fine) fine.value.setZero();

  // Corners that are displaced by -h pull as much as errors of h: the gradient changes by H h.
  constexpr double kStep = 1e-3;
  const auto expect_column = [&](const RemovedErrors& moved, const Eigen::VectorXd& of_poses,
                                 const Eigen::VectorXd& of_own, double tolerance) {
    const ArrowSystem before = gradient_with(none), after = gradient_with(moved);
    const Eigen::VectorXd poses = (after.pose_gradient - before.pose_gradient) / kStep,
                          own = (after.global_gradient - before.global_gradient) / kStep;
    EXPECT_GT(of_poses.norm(), 0.0);
    EXPECT_LE((poses - of_poses).norm(), tolerance * of_poses.norm());
    EXPECT_LE((own - of_own).norm(), tolerance * of_own.norm());
  };
  // What is printed elsewhere is taken out where each view by itself sees the board, a little beside the solution.
  for (const auto& [error, tolerance] : {std::pair(Eigen::Index(3), 0.02), {repeating.value.size() - 5, 1e-3}}) {
    RemovedErrors moved = none;
    moved.value[error] = kStep;
    expect_column(moved, all.pose_global.col(globals + error), all.global.col(globals + error).head(globals),
                  tolerance);
  }
  for (std::size_t f = 0; f < all.fields.size(); ++f) {
    Eigen::Index most = 0;
    all.fields[f].own.diagonal().maxCoeff(&most);
    RemovedErrors moved = none;
    moved.fine[f + 1].value[most] = kStep;
    expect_column(moved, all.fields[f].with_poses.col(most), all.fields[f].with_globals.col(most).head(globals), 1e-3);
  }
}

TEST_F(RepeatingCouplingsTest, TheCovarianceIsThatOfAllUnknowns) {
  const Fit fit = fit_model(prepared_, {OdometryModel::kPerIncrement, false});
  const Problem problem = problem_at(prepared_, fit, fit.noise);
  const ArrowSystem system = problem.linearise_with(prepared_.repeating, fit.state, Weighting::kInformation);
  const Eigen::Index poses = system.pose_gradient.size(), others = system.globals(),
                     globals = problem.layout().globals();
  Eigen::Index n = poses + others;
  for (const FieldEquations& field : system.fields) n += field.gradient.size();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);  // below the diagonal
  for (Eigen::Index i = 0; i < poses; i += 6) {
    H.block<6, 6>(i, i) = system.diagonal[static_cast<std::size_t>(i / 6)];
    if (i > 0) H.block<6, 6>(i, i - 6) = system.coupling[static_cast<std::size_t>(i / 6)];
  }
  H.block(poses, 0, others, poses) = system.pose_global.transpose();
  H.block(poses, poses, others, others) = system.global;
  Eigen::Index at = poses + others;
  for (const FieldEquations& field : system.fields) {
    const Eigen::Index size = field.gradient.size();
    H.block(at, 0, size, poses) = field.with_poses.transpose();
    H.block(at, poses, size, others) = field.with_globals.transpose();
    H.block(at, at, size, size) = field.own;
    EXPECT_GE(field.own.diagonal().minCoeff(), 1.0) << "of unit variance before any data";
    at += size;
  }
  H = H.selfadjointView<Eigen::Lower>().toDenseMatrix();
  const Eigen::VectorXd unit = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inverse =
      unit.asDiagonal() *
      Eigen::MatrixXd(
          Eigen::MatrixXd(unit.asDiagonal() * H * unit.asDiagonal()).llt().solve(Eigen::MatrixXd::Identity(n, n))) *
      unit.asDiagonal();

  const auto solved = solve_equations(prepared_.repeating, problem, fit.state);
  ASSERT_TRUE(solved);
  EXPECT_TRUE(solved->of_globals().covariance.isApprox(inverse.block(poses, poses, globals, globals), 1e-6));
  EXPECT_TRUE(solved->with_poses.isApprox(inverse.block(poses, 0, globals, poses), 1e-6));
  at = poses + others;
  for (const Eigen::MatrixXd& field : solved->with_fields) {
    EXPECT_TRUE(field.isApprox(inverse.block(poses, at, globals, field.cols()), 1e-6));
    at += field.cols();
  }
}

}  // namespace
}  // namespace rigproof::ml
