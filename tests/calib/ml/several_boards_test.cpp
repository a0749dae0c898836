// Cameras that see other boards than each other, or one after the other, are calibrated in one drive.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "calibration_truth.h"
#include "past_boards.h"
#include "pose_near.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/problem.h"
#include "rigproof/calib/geometry/initial_guess.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/core/error.h"
#include "rigproof/core/random.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

const Trials kTrials(12, 60);
constexpr int kUnknowns = 18;  // of three cameras: the mean of their NEES

MlOptions told() {
  MlOptions options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
  options.estimate_corner_level = options.estimate_plane_level = false;
  return options;
}

int views_of(const Observations& observations, int camera, int board) {
  return static_cast<int>(
      std::count_if(observations.board_views.begin(), observations.board_views.end(),
                    [&](const BoardView& view) { return view.camera == camera && view.board == board; }));
}

// What is said of it; empty: nothing.
std::string said_of(const std::vector<Finding>& findings, const char* code) {
  for (const Finding& finding : findings)
    if (finding.is(code)) return worded(finding);
  return "";
}

void expect_refused_for(const Observations& observations, const char* code, const char* words) {
  const Result result = estimate_maximum_likelihood(observations, told()).result;
  EXPECT_EQ(result.status, ResultStatus::kRefused);
  EXPECT_THAT(said_of(result.reasons, code), HasSubstr(words)) << findings_json(result.reasons);
}

TEST(SeveralBoards, AreSolvedExactlyWithoutNoise) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    PastTwoBoards made(seed);
    made.config.corner_sigma_px = made.config.inverse_depth_sigma_per_m = made.config.lambda = 0.0;
    const GeometricRun run = made.drawn();
    ASSERT_EQ(views_of(run.observations, 2, 0), 0);  // the camera that looks aside
    ASSERT_GE(views_of(run.observations, 2, 1), 5);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
    ASSERT_EQ(estimate.result.status, ResultStatus::kSolved);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_TRUE(IsPoseNear(run.truth.cameras[c].T_robot_camera, estimate.state.T_robot_camera[c], 1e-7, 1e-7)) << c;
    ASSERT_EQ(estimate.state.T_world_more_boards.size(), 1U);
    const Rigid3 between = estimate.state.T_world_board.inverse() * estimate.state.T_world_more_boards[0];
    EXPECT_TRUE(IsPoseNear(run.truth.T_world_board.inverse() * made.second.T_world_board, between, 1e-7, 1e-7));
  }
}

TEST(SeveralBoards, AreSolvedWithinTheStatedUncertaintyOverTrials) {
  double mean = 0.0;
  for (int trial = 0; trial < kTrials.count(); ++trial) {
    const GeometricRun run = PastTwoBoards(static_cast<std::uint64_t>(100 + trial)).drawn();
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
    ASSERT_EQ(estimate.result.status, ResultStatus::kSolved) << trial;
    mean += nees(estimate, poses_of(run.truth)) / kTrials.count();
  }
  EXPECT_NEAR(mean, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
}

// Of a board whose squares, sheet and corners are not as stated.
std::vector<Eigen::Vector3d> drawn_print(const Board& board, RandomStream* random, double* size) {
  const double side = board.square_sigma_relative(), ratio = random->normal(0.0, 0.2 * side);
  *size = random->normal(0.0, side);
  const double bow_x = random->normal(0.0, board.bow_sigma()), bow_y = random->normal(0.0, board.bow_sigma());
  std::vector<Eigen::Vector3d> errors;
  for (const Eigen::Vector3d& corner : board.corners()) {
    const Eigen::Vector3d p = corner - board.centre();
    const double u = 2.0 * p.x() / (board.square_m * board.squares_x),
                 v = 2.0 * p.y() / (board.square_m * board.squares_y);
    errors.emplace_back((*size + 0.5 * ratio) * p.x(), (*size - 0.5 * ratio) * p.y(), bow_x * u * u + bow_y * v * v);
    for (int axis = 0; axis < 3; ++axis) errors.back()[axis] += random->normal(0.0, board.print_sigma());
  }
  return errors;
}

TEST(SeveralBoards, EachErrsOnItsOwnOverTrials) {
  double mean = 0.0, z_square = 0.0;
  int suspicions = 0;
  for (int trial = 0; trial < kTrials.count(); ++trial) {
    PastTwoBoards made(static_cast<std::uint64_t>(200 + trial));
    made.config.board_planes = true;
    made.config.depth_scale_sigma = 0.01;
    made.config.rig.board.doubt();
    made.second.board.doubt();
    RandomStream random(made.config.seed, "prints");
    std::array<double, 2> size{};
    made.config.rig.print_errors_m = drawn_print(made.config.rig.board, &random, &size[0]);
    made.second.print_errors_m = drawn_print(made.second.board, &random, &size[1]);
    const GeometricRun run = made.drawn();
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
    ASSERT_EQ(estimate.result.status, ResultStatus::kSolved) << trial;
    mean += nees(estimate, poses_of(run.truth)) / kTrials.count();
    for (const Finding& note : estimate.result.notes) suspicions += note.severity == Severity::kSuspect;
    int told_of = 0;
    for (const EstimatedQuantity& quantity : estimate.result.also_estimated) {
      const bool second = quantity.name == "board_2_size_percent";
      if (quantity.name != "board_size_percent" && !second) continue;
      z_square += std::pow((quantity.value - 100.0 * size[second ? 1 : 0]) / quantity.sigma, 2);
      ++told_of;
    }
    ASSERT_EQ(told_of, 2);
  }
  EXPECT_NEAR(mean, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
  EXPECT_NEAR(z_square / kTrials.count(), 2.0, kTrials.chi_square_tolerance(2));
  EXPECT_EQ(suspicions, 0);
}

// As one board they contradict the drive, and the answer is not silently wrong.
TEST(SeveralBoards, ThatAreTakenForOneAreRefused) {
  GeometricRun run = PastTwoBoards(7, 12).drawn();
  run.observations.more_boards.clear();
  for (BoardView& view : run.observations.board_views) view.board = 0;
  EXPECT_EQ(estimate_maximum_likelihood(run.observations, {}).result.status, ResultStatus::kRefused);
}

GeometricConfig three_cameras(std::uint64_t seed, int stops) {
  GeometricConfig config;
  config.seed = seed;
  config.stops = stops;
  config.board_planes = true;
  config.depth_scale_sigma = 0.005;
  return config;
}

// Each camera sees one and the other in turn, and two of them at one stop see different ones.
TEST(SeveralBoards, SeenInTurnAreSolvedWithinTheStatedUncertaintyOverTrials) {
  double mean = 0.0;
  for (int trial = 0; trial < kTrials.count(); ++trial) {
    const GeometricRun run = drawn_past_boards_in_turn(three_cameras(static_cast<std::uint64_t>(300 + trial), 30));
    for (int camera = 0; camera < 3; ++camera)
      for (int board = 0; board < 2; ++board) EXPECT_GE(views_of(run.observations, camera, board), 3) << trial;
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
    ASSERT_EQ(estimate.result.status, ResultStatus::kSolved) << trial;
    mean += nees(estimate, poses_of(run.truth)) / kTrials.count();
  }
  EXPECT_NEAR(mean, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
}

// The only board of a camera, from so few stops that its own motion tells nothing: what it leaves open is said, and the
// others are as good as ever.
TEST(SeveralBoards, TheOneFromFewStopsLeavesItsCameraOpen) {
  for (const int most : {1, 2}) {
    SCOPED_TRACE(most);
    GeometricRun run = PastTwoBoards(13).drawn();
    int seen = 0;
    forget_board(&run.observations, [&](const BoardView& view) { return view.board == 1 && ++seen > most; });
    const Result result = estimate_maximum_likelihood(run.observations, told()).result;
    EXPECT_EQ(result.status, ResultStatus::kPartial);
    for (std::size_t c = 0; c < result.camera_to_robot.size(); ++c) {
      const EstimatedTransform& camera = result.camera_to_robot[c];
      const std::array<bool, 6> open = {false, false, true, true, true, false};
      if (camera.child == "right")
        EXPECT_EQ(camera.observable, open);
      else
        EXPECT_TRUE(camera.fully_observable());
      const Vector6d error = transform_error(camera.T_parent_child, run.truth.cameras[c].T_robot_camera);
      for (int axis = 0; axis < 6; ++axis) {
        if (!camera.observable[static_cast<std::size_t>(axis)]) continue;
        EXPECT_LT(std::abs(error[axis]), 5.0 * std::sqrt((*camera.covariance)(axis, axis))) << camera.child << axis;
      }
    }
  }
}

// Six views, but from two stops: no step can be told from a wrong stop.
TEST(SeveralBoards, TheOneThatMovedBetweenItsOnlyTwoStopsDoesNoHarm) {
  GeometricRun run = drawn_past_boards_in_turn(three_cameras(5, 30));
  forget_board(&run.observations, [](const BoardView& view) { return view.board == 1; });
  GeometricConfig config = three_cameras(5, 30);
  const GeometricScene scene = draw_scene(config);
  for (const int stop : {8, 20}) {
    Rigid3 T_world_board = scene.T_world_board;
    T_world_board.translation.x() += stop == 8 ? 0.05 : -0.05;
    forget_board(&run.observations, [stop](const BoardView& view) { return view.stop == stop; });
    for (BoardView view : draw_geometric_run(config, {T_world_board, scene.T_world_robot}).observations.board_views) {
      view.board = 1;
      if (view.stop == stop) run.observations.board_views.push_back(view);
    }
  }
  std::sort(
      run.observations.board_views.begin(), run.observations.board_views.end(),
      [](const BoardView& a, const BoardView& b) { return std::tie(a.stop, a.camera) < std::tie(b.stop, b.camera); });
  ASSERT_EQ(views_of(run.observations, 0, 1) + views_of(run.observations, 1, 1) + views_of(run.observations, 2, 1), 6);
  const Result result = estimate_maximum_likelihood(run.observations, told()).result;
  for (const EstimatedTransform& camera : result.camera_to_robot) {
    const auto c = static_cast<std::size_t>(&camera - result.camera_to_robot.data());
    const Vector6d error = transform_error(camera.T_parent_child, run.truth.cameras[c].T_robot_camera);
    for (int axis = 0; axis < 6; ++axis)
      EXPECT_LT(std::abs(error[axis]), 5.0 * std::sqrt((*camera.covariance)(axis, axis))) << c << axis;
  }
}

// A board whose only view is wrong: with the view goes the depth on it, which would tie the camera to any place.
TEST(SeveralBoards, DepthOnTheOneWhoseViewsAreLeftOutCountsNothing) {
  GeometricRun run = drawn_past_boards_in_turn(three_cameras(6, 30));
  Observations& observations = run.observations;
  int seen = 0;
  forget_board(&observations, [&](const BoardView& view) { return view.board == 1 && ++seen > 1; });
  Observations without = observations;
  forget_board(&without, [](const BoardView& view) { return view.board == 1; });
  ASSERT_EQ(without.board_planes.size() + 1, observations.board_planes.size());
  const ml::Priors priors = ml::Priors::of({observations, usual_priors(), false});
  ml::NoiseLevels levels;
  levels.corner_scale = levels.ground_scale = levels.board_plane_scale = {1.0, 1.0, 1.0};
  ml::Problem problem(observations, priors, levels), less(without, priors, levels);
  for (std::size_t v = 0; v < observations.board_views.size(); ++v)
    problem.view_left_out[v] = observations.board_views[v].board == 1;
  const ml::State state = ml::state_from(state_of(run.truth));
  double cost = 0.0, cost_of_less = 0.0;
  const ml::ArrowSystem system = problem.linearise(state, ml::Weighting::kRobust, &cost, nullptr);
  const ml::ArrowSystem of_less = less.linearise(state, ml::Weighting::kRobust, &cost_of_less, nullptr);
  EXPECT_EQ(cost, cost_of_less);
  EXPECT_EQ(system.global, of_less.global);
  EXPECT_EQ(problem.log_normalisation(), less.log_normalisation());
}

// What no two views of one board tell, the closed form does not say, and what they do, whichever board it was.
TEST(SeveralBoards, AreFoundInClosedForm) {
  for (int seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    for (const bool in_turn : {true, false}) {
      PastTwoBoards aside(static_cast<std::uint64_t>(seed));
      GeometricConfig both = three_cameras(aside.config.seed, 30);
      aside.config.lambda = both.lambda = 0.1;  // odometry drifts between boards, and the closed form with it
      const GeometricRun run = in_turn ? drawn_past_boards_in_turn(both) : aside.drawn();
      const std::vector<ViewPose> views = estimate_view_poses(run.observations).poses;
      const TrajectoryAlignment alignment = align_trajectories(run.observations, views);
      ASSERT_EQ(alignment.source, VerticalSource::kMotion);
      const InitialGuess guess =
          initial_guess(run.observations, views, alignment, check_ground_planes(run.observations, alignment));
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_TRUE(guess.T_robot_camera[c]) << c;
        EXPECT_TRUE(IsPoseNear(run.truth.cameras[c].T_robot_camera, *guess.T_robot_camera[c], 0.03, 0.02)) << c;
      }
      ASSERT_EQ(guess.T_world_more_boards.size(), 1U);
      EXPECT_TRUE(IsPoseNear(run.truth.T_world_board, *guess.T_world_board, 0.1, 0.1));
      const Rigid3& second = in_turn ? guess.T_world_more_boards[0] : aside.second.T_world_board;
      EXPECT_TRUE(IsPoseNear(second, guess.T_world_more_boards[0], 0.1, 0.1));
      // A view from afar tells the heading to some degrees.
      for (std::size_t i = 0; i < guess.T_world_robot.size(); ++i)
        EXPECT_TRUE(IsPoseNear(run.truth.stops[i].T_world_robot, guess.T_world_robot[i], 0.3, 0.1)) << i;
    }
  }
}

// A board that is seen twice tells no vertical: it has it from a camera that knows it, and hands it on to another one.
TEST(SeveralBoards, TheVerticalSpreads) {
  GeometricConfig config = three_cameras(9, 30);
  config.ground = false;
  GeometricRun run = drawn_past_boards_in_turn(config);
  int of_first = 0, of_last = 0;
  forget_board(&run.observations, [&](const BoardView& view) {
    if (view.camera == 0) return view.board == 1 && ++of_first > 1;
    if (view.camera == 2) return view.board == 0 || ++of_last > 1;
    return view.board == 1;
  });
  const std::vector<ViewPose> views = estimate_view_poses(run.observations).poses;
  const TrajectoryAlignment alignment = align_trajectories(run.observations, views);
  ASSERT_EQ(alignment.source, VerticalSource::kMotion);
  ASSERT_EQ(alignment.up_board.size(), 2U);
  for (std::size_t c = 0; c < 3; ++c) {
    ASSERT_TRUE(alignment.up_camera[c]) << c;
    const Eigen::Vector3d up = run.truth.cameras[c].T_robot_camera.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    EXPECT_LT((*alignment.up_camera[c] - up).norm(), 6.0 * alignment.sigma_up_camera_rad[c] + 1e-3) << c;
  }
  EXPECT_GT(alignment.sigma_up_camera_rad[2], alignment.sigma_up_camera_rad[0]);
  EXPECT_LT(alignment.sigma_up_camera_rad[2], 0.02);
}

TEST(SeveralBoards, TheOneThatIsInNoImageIsNamed) {
  GeometricRun run = PastTwoBoards(8).drawn();
  const MlEstimate before = estimate_maximum_likelihood(run.observations, told());
  EXPECT_EQ(said_of(before.result.notes, "board.in_no_image"), "");
  run.observations.more_boards.push_back(run.observations.board);
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
  ASSERT_EQ(estimate.result.status, ResultStatus::kSolved);
  EXPECT_THAT(said_of(estimate.result.notes, "board.in_no_image"), HasSubstr("Board no. 3 of the rig"));
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_TRUE(IsPoseNear(before.state.T_robot_camera[c], estimate.state.T_robot_camera[c], 1e-9, 1e-9));
}

// The first one need not be seen.
TEST(SeveralBoards, AnyOfThemMaySuffice) {
  GeometricRun run = PastTwoBoards(9).drawn();
  Observations& observations = run.observations;
  observations.more_boards = {observations.board, observations.board};
  for (BoardView& view : observations.board_views) ++view.board;
  const MlEstimate estimate = estimate_maximum_likelihood(observations, told());
  ASSERT_EQ(estimate.result.status, ResultStatus::kSolved);
  EXPECT_LT(nees(estimate, poses_of(run.truth)), 60.0);
  EXPECT_THAT(said_of(estimate.result.notes, "board.in_no_image"), HasSubstr("Board no. 1 of the rig"));
}

TEST(SeveralBoards, TheOneThatMovedIsNamed) {
  PastTwoBoards made(10);
  const GeometricScene scene = made.scene();
  GeometricBoard after = made.second;
  after.T_world_board.translation += Eigen::Vector3d(0.03, -0.02, 0.0);
  GeometricRun run = drawn_past_boards(made.config, scene, {made.second});
  const Observations moved = drawn_past_boards(made.config, scene, {after}).observations;
  const int half = made.config.stops / 2;
  std::vector<BoardView> views;
  for (const BoardView& view : run.observations.board_views)
    if (view.stop < half) views.push_back(view);
  for (const BoardView& view : moved.board_views)
    if (view.stop >= half) views.push_back(view);
  run.observations.board_views = views;
  expect_refused_for(run.observations, "board.moved", "the board no. 2 moved during the drive");
}

TEST(SeveralBoards, TheOneOfAnotherSizeIsNamed) {
  PastTwoBoards made(11);
  made.config.board_planes = true;
  GeometricRun run = made.drawn();
  run.observations.board.square_sigma_m = 1e-4;
  run.observations.more_boards[0].square_sigma_m = 1e-4;
  run.observations.more_boards[0].square_m *= 1.1;
  expect_refused_for(run.observations, "board.size", "(board no. 2)");
}

TEST(SeveralBoards, StartsOfFewerAreRefused) {
  const GeometricRun run = PastTwoBoards(14, 12).drawn();
  MlOptions options = told();
  options.start = state_of(run.truth);
  options.start->T_world_more_boards.clear();
  EXPECT_THROW(estimate_maximum_likelihood(run.observations, options), Error);
  EXPECT_THROW(cramer_rao_bound(run.observations, *options.start, noise_of(run.truth)), Error);
}

TEST(SeveralBoards, AreRefusedByMethodsOfOne) {
  const GeometricRun run = PastTwoBoards(12, 12).drawn();
  int refused = 0;
  for (const Method* method : all_methods()) {
    const Result result = run_method(*method, {run.observations, nullptr, {}});
    if (method->traits().several_boards) {
      EXPECT_NE(result.status, ResultStatus::kRefused) << method->traits().name;
      continue;
    }
    ++refused;
    ASSERT_EQ(result.reasons.size(), 1U) << method->traits().name;
    EXPECT_EQ(result.reasons[0].code, "method.one_board") << method->traits().name;
  }
  EXPECT_GT(refused, 3);
}

}  // namespace
}  // namespace rigproof
