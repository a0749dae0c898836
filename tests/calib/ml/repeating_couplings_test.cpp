// Errors that repeat in every image are many, and most of their equations are zero: what leaves zeros out is what the
// whole matrices give.
#include "repeating_couplings.h"

#include <gtest/gtest.h>

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

TEST_F(RepeatingCouplingsTest, TheCovarianceAnswersToAllErrorsThatPosesAreCoupledWith) {
  const Fit fit = fit_model(prepared_, {OdometryModel::kPerIncrement, false});
  const Problem problem = problem_at(prepared_, fit, fit.noise);
  Couplings fine(0, 0, 0);
  const ArrowSystem system = problem.linearise_with(prepared_.repeating, fit.state, Weighting::kInformation, &fine);
  const auto eliminated = EliminatedSystem::eliminate(system, 0.0);
  ASSERT_TRUE(eliminated);
  ASSERT_GT(fine.with_poses.cwiseAbs().maxCoeff(), 0.0);

  const Eigen::Index globals = problem.layout().globals();
  const Eigen::MatrixXd estimated = invert_information(eliminated->schur()).covariance;
  const Eigen::MatrixXd by_poses = estimated * eliminated->pose_response().topRows(estimated.rows());
  const Eigen::MatrixXd response = (estimated * fine.with_globals - by_poses * fine.with_poses).topRows(globals);
  const Eigen::MatrixXd whole = estimated.topLeftCorner(globals, globals) + response * response.transpose();

  const auto solved = solve_equations(prepared_.repeating, problem, fit.state);
  ASSERT_TRUE(solved);
  const GlobalCovariance covariance = solved->of_globals();
  EXPECT_GT(covariance.unweighed.maxCoeff(), 0.0);
  EXPECT_TRUE(covariance.covariance.isApprox(whole, 1e-9));
}

// Each error once, and none that was not named.
TEST(Couplings, RangesOfAPoseDoNotOverlap) {
  Couplings couplings(1, 1, 30);
  for (const Couplings::Range& range :
       std::initializer_list<Couplings::Range>{{20, 25}, {0, 4}, {2, 6}, {8, 10}, {6, 7}, {9, 12}, {21, 23}, {5, 9}})
    couplings.add_range(0, range);
  std::vector<int> times(30, 0);
  for (const Couplings::Range& range : couplings.of_pose[0])
    for (int error = range.first; error < range.end; ++error) ++times[static_cast<std::size_t>(error)];
  for (int error = 0; error < 30; ++error)
    EXPECT_EQ(times[static_cast<std::size_t>(error)], error < 12 || (error >= 20 && error < 25) ? 1 : 0) << error;
}

}  // namespace
}  // namespace rigproof::ml
