// Errors that repeat in every image are many, and most of their equations are zero: what leaves zeros out is what the
// whole matrices give.
#include "repeating_couplings.h"

#include <gtest/gtest.h>

#include "rigproof/calib/estimate/fit.h"
#include "rigproof/calib/estimate/preparation.h"
#include "rigproof/calib/estimate/repeating_covariance.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof::ml {
namespace {

// Nothing is said of lenses and board, and one camera's lens is believed.
class RepeatingCouplingsTest : public testing::Test {
 protected:
  RepeatingCouplingsTest() : run_(drive()), prepared_(prepare(run_.observations, options_)) {}

  static GeometricRun drive() {
    GeometricConfig config;
    config.stops = 8;
    GeometricRun run = draw_geometric_run(config);
    run.observations.board.doubt();
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
  ASSERT_GE(errors.print(0), 0);
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

  const auto covariance = covariance_with(prepared_.repeating, problem, fit.state);
  ASSERT_TRUE(covariance);
  EXPECT_GT(covariance->unweighed.maxCoeff(), 0.0);
  EXPECT_TRUE(covariance->covariance.isApprox(whole, 1e-9));
}

TEST_F(RepeatingCouplingsTest, NoErrorOfAPoseIsCountedTwice) {
  const Fit fit = fit_model(prepared_, {OdometryModel::kPerIncrement, false});
  Couplings fine(0, 0, 0);
  problem_at(prepared_, fit, fit.noise).linearise_with(prepared_.repeating, fit.state, Weighting::kInformation, &fine);
  for (const std::vector<Couplings::Range>& ranges : fine.of_pose) {
    std::vector<int> times(static_cast<std::size_t>(fine.with_poses.cols()), 0);
    for (const Couplings::Range& range : ranges)
      for (int error = range.first; error < range.end; ++error) ++times[static_cast<std::size_t>(error)];
    for (const int counted : times) EXPECT_LE(counted, 1);
  }
}

}  // namespace
}  // namespace rigproof::ml
