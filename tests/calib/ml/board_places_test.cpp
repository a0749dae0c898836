// Boards whose places against the first one somebody measured.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibration_truth.h"
#include "past_boards.h"
#include "pose_near.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/board_place.h"
#include "rigproof/calib/plan/moved.h"
#include "rigproof/core/lens_residual.h"
#include "rigproof/core/random.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

const Trials kTrials(12, 60);
constexpr int kUnknowns = 18;      // of three cameras: the mean of their NEES
constexpr std::size_t kAside = 2;  // the camera that sees the second board alone

MlOptions told() {
  MlOptions options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
  options.estimate_corner_level = options.estimate_plane_level = false;
  return options;
}

Rigid3 true_place(const Truth& truth) { return truth.T_world_board.inverse() * truth.board_at(1).T_world_board; }

// Measured with an error of the sigmas that are stated.
BoardPlace measured_place(const Truth& truth, double sigma_m, double sigma_rad) {
  RandomStream random(truth.seed, "measured place");
  Vector6d error;
  for (Eigen::Index i = 0; i < 6; ++i) error[i] = random.normal(0.0, i < 3 ? sigma_m : sigma_rad);
  BoardPlace place{true_place(truth), sigma_m, sigma_rad};
  place.T_first_board.translation += error.head<3>();
  place.T_first_board.rotation = place.T_first_board.rotation * so3_exp(error.tail<3>());
  return place;
}

// A lens that displaces its images smoothly, by so much in the mean.
void displace_smoothly(Observations* observations, std::uint64_t seed, double rms_px) {
  std::vector<LensResidual> fields;
  for (std::size_t c = 0; c < observations->cameras.size(); ++c)
    fields.push_back(draw_lens_residual(observations->cameras[c].camera, rms_px, 8.0,
                                        RandomStream(seed, "field", -1, static_cast<std::int32_t>(c))));
  for (BoardView& view : observations->board_views)
    for (CornerObservation& corner : view.corners)
      corner.pixel += fields[static_cast<std::size_t>(view.camera)].at(corner.pixel);
}

const Finding* note_of(const Result& result, const char* code) {
  const auto found = std::find_if(result.notes.begin(), result.notes.end(),
                                  [code](const Finding& finding) { return finding.is(code); });
  return found == result.notes.end() ? nullptr : &*found;
}

TEST(BoardPlaces, ErrorsAreZeroWhereStatedAndHaveTheRightDerivatives) {
  const GeometricRun run = PastTwoBoards(3, 8).drawn();
  ml::State state = ml::state_from(state_of(run.truth));
  BoardPlace place{true_place(run.truth), 0.01, 0.02};
  EXPECT_LT(ml::place_error(state, 1, place).value.norm(), 1e-12);
  place.T_first_board.translation += Eigen::Vector3d(0.02, -0.01, 0.03);
  place.T_first_board.rotation = place.T_first_board.rotation * so3_exp({0.2, -0.3, 0.1});
  const ml::PlaceError error = ml::place_error(state, 1, place);
  EXPECT_NEAR(error.value.tail<3>().norm(), Eigen::Vector3d(0.2, -0.3, 0.1).norm(), 1e-9);
  const ml::Layout layout = ml::Layout::of(run.observations, ml::Priors::of({run.observations, usual_priors(), false}));
  const Eigen::MatrixXd J = error.by_globals(layout);
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(6 * layout.poses);
  constexpr double kStep = 1e-6;
  for (int unknown = 0; unknown < layout.globals(); ++unknown) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(layout.globals());
    step[unknown] = kStep;
    const Vector6d ahead = ml::place_error(ml::moved(state, layout, still, step), 1, place).value;
    const Vector6d behind = ml::place_error(ml::moved(state, layout, still, -step), 1, place).value;
    EXPECT_LT(((ahead - behind) / (2.0 * kStep) - J.col(unknown)).norm(), 1e-7) << unknown;
  }
}

TEST(BoardPlaces, TightenWhatIsStatedAndKeepItTrueOverTrials) {
  double mean = 0.0, z_square = 0.0, ratio = 0.0;
  for (int trial = 0; trial < kTrials.count(); ++trial) {
    GeometricRun run = PastTwoBoards(static_cast<std::uint64_t>(400 + trial), 20).drawn();
    const MlEstimate without = estimate_maximum_likelihood(run.observations, told());
    run.observations.more_boards[0].place = measured_place(run.truth, 0.001, 0.001);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
    ASSERT_EQ(estimate.result.status, ResultStatus::kSolved) << trial;
    EXPECT_EQ(note_of(estimate.result, "board.place"), nullptr) << trial;
    mean += nees(estimate, poses_of(run.truth)) / kTrials.count();
    const auto sigma = [](const MlEstimate& of) {
      const EstimatedTransform* apart =
          of.result.find(of.result.camera_to_robot[0].child, of.result.camera_to_robot[kAside].child);
      return std::sqrt((*apart->covariance)(5, 5));
    };
    ratio += sigma(estimate) / sigma(without) / kTrials.count();
    ASSERT_EQ(estimate.result.boards.size(), 1U);
    const EstimatedBoard& board = estimate.result.boards[0];
    EXPECT_EQ(board.number, 2);
    const BoardPlace estimated{board.T_first_board, 1.0, 1.0};
    const Vector6d off = ml::place_error(ml::state_from(state_of(run.truth)), 1, estimated).value;
    for (Eigen::Index i = 0; i < 6; ++i)
      z_square += std::pow(off[i] / board.sigma[static_cast<std::size_t>(i)], 2) / kTrials.count();
  }
  EXPECT_NEAR(mean, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
  EXPECT_NEAR(z_square, 6.0, kTrials.chi_square_tolerance(6));
  EXPECT_LT(ratio, 0.9);
}

// Errors that repeat in every image are found again with the place. Fields as they are drawn have nothing that
// intrinsics follow, so that less than all unknowns err: as without a place.
TEST(BoardPlaces, CountWithErrorsThatRepeatOverTrials) {
  double mean = 0.0;
  for (int trial = 0; trial < kTrials.count(); ++trial) {
    PastTwoBoards made(static_cast<std::uint64_t>(500 + trial), 20);
    made.config.lambda = 0.2;
    for (RigCamera& camera : made.config.rig.cameras) {
      camera.intrinsics_sigma = IntrinsicsSigma::exact();
      camera.intrinsics_sigma.residual_px = 0.1;
    }
    GeometricRun run = made.drawn();
    displace_smoothly(&run.observations, made.config.seed, 0.1);
    run.observations.more_boards[0].place = measured_place(run.truth, 0.0005, 0.0005);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
    ASSERT_EQ(estimate.result.status, ResultStatus::kSolved) << trial;
    EXPECT_EQ(note_of(estimate.result, "board.place"), nullptr) << trial;
    mean += nees(estimate, poses_of(run.truth)) / kTrials.count();
  }
  EXPECT_LT(mean, kUnknowns + kTrials.chi_square_tolerance(kUnknowns));
  EXPECT_GT(mean, 0.6 * kUnknowns);
}

// The first board was never seen: what is stated against it tells nothing.
TEST(BoardPlaces, AgainstABoardThatNobodySawAreSaidToBeUnused) {
  GeometricRun run = PastTwoBoards(34).drawn();
  Observations& observations = run.observations;
  observations.more_boards = {observations.board, observations.board};
  for (BoardView& view : observations.board_views) ++view.board;
  observations.more_boards[1].place = BoardPlace{Rigid3(), 0.005, 0.005};
  const Result result = estimate_maximum_likelihood(observations, told()).result;
  EXPECT_EQ(result.status, ResultStatus::kSolved);
  EXPECT_NE(note_of(result, "board.places_unused"), nullptr);
  EXPECT_TRUE(result.boards.empty());
}

// `moved` does without: a board that was shifted is no camera that moved.
TEST(BoardPlaces, DoNotMoveCameras) {
  GeometricRun run = PastTwoBoards(35).drawn();
  const Result before = estimate_maximum_likelihood(run.observations, told()).result;
  ASSERT_EQ(before.status, ResultStatus::kSolved);
  GeometricRun again = PastTwoBoards(36, 12).drawn();
  BoardPlace place = measured_place(again.truth, 0.002, 0.002);
  place.T_first_board.translation.x() += 0.05;
  again.observations.more_boards[0].place = place;
  const MovedReport report = detect_movement(before, again.observations);
  ASSERT_EQ(report.cameras.size(), 3U);
  for (const CameraShift& camera : report.cameras) EXPECT_NE(camera.verdict, MovedVerdict::kMoved) << camera.camera;
}

TEST(BoardPlaces, HaveALineInTheBudget) {
  GeometricRun run = PastTwoBoards(31, 20).drawn();
  run.observations.more_boards[0].place = measured_place(run.truth, 0.002, 0.002);
  const Result result = estimate_maximum_likelihood(run.observations, told()).result;
  ASSERT_EQ(result.status, ResultStatus::kSolved);
  double share = 0.0;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    double sum = 0.0;
    for (const EstimatedTransform::Share& line : result.camera_to_robot[kAside].budget) {
      sum += line.share[axis];
      if (line.source == "places of boards") share = std::max(share, line.share[axis]);
    }
    EXPECT_NEAR(sum, 1.0, 1e-6) << axis;
  }
  EXPECT_GT(share, 0.01);
}

// Beyond doubt elsewhere: it is named, and the answer is the one without it.
TEST(BoardPlaces, ThatAreWrongAreNamedAndNotUsed) {
  GeometricRun run = PastTwoBoards(32).drawn();
  const MlEstimate without = estimate_maximum_likelihood(run.observations, told());
  BoardPlace& place = run.observations.more_boards[0].place.emplace(measured_place(run.truth, 0.005, 0.005));
  const Rigid3 right = place.T_first_board;
  for (const bool inverted : {false, true}) {
    SCOPED_TRACE(inverted);
    place.T_first_board = inverted ? right.inverse() : right;
    if (!inverted) place.T_first_board.translation += Eigen::Vector3d(0.1, 0.0, 0.0);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
    ASSERT_EQ(estimate.result.status, ResultStatus::kSolved);
    const Finding* note = note_of(estimate.result, "board.place");
    ASSERT_NE(note, nullptr);
    EXPECT_EQ(note->severity, Severity::kSuspect);
    EXPECT_THAT(worded(*note), HasSubstr("Board no. 2 stands "));
    EXPECT_EQ(worded(*note).find("the inverse of it fits") != std::string::npos, inverted) << worded(*note);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_TRUE(IsPoseNear(without.state.T_robot_camera[c], estimate.state.T_robot_camera[c], 1e-12, 1e-12));
  }
}

// What is wrong otherwise is named as without them.
TEST(BoardPlaces, MendNothingThatIsNotInOrder) {
  GeometricRun run = PastTwoBoards(33).drawn();
  for (Stop& stop : run.observations.stops) stop.yaw_rad = -stop.yaw_rad;
  const Result without = estimate_maximum_likelihood(run.observations, told()).result;
  ASSERT_EQ(without.status, ResultStatus::kRefused);
  run.observations.more_boards[0].place = measured_place(run.truth, 0.005, 0.005);
  const Result result = estimate_maximum_likelihood(run.observations, told()).result;
  EXPECT_EQ(result.status, ResultStatus::kRefused);
  EXPECT_EQ(findings_json(result.reasons), findings_json(without.reasons));
  EXPECT_NE(note_of(result, "board.places_unused"), nullptr);
  EXPECT_TRUE(result.boards.empty());
}

}  // namespace
}  // namespace rigproof
