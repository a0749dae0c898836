// Stops that are suggested before more than one board.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "forecast.h"
#include "past_boards.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/information.h"
#include "rigproof/calib/plan/suggest.h"

namespace rigproof {
namespace {

constexpr std::size_t kAside = 2;  // the camera that sees the second board alone

SuggestOptions options_of(int stops) {
  SuggestOptions options;
  options.stops = stops;
  options.reach_m = 1.2;
  options.clearance_m = 1.0;
  return options;
}

TEST(SuggestBeforeTwoBoards, WhatIsKnownIsAsStated) {
  PastTwoBoards made(21, 12);
  const GeometricRun run = made.drawn();
  const Result result = estimate_maximum_likelihood(run.observations, {}).result;
  ASSERT_EQ(result.status, ResultStatus::kSolved);
  const suggest::CalibrationSoFar knowledge = suggest::calibration_so_far(run.observations);
  EXPECT_EQ(suggest::Foresight(knowledge, options_of(1)).boards(), (std::vector<int>{0, 1}));
  const std::vector<AxisSigmas> now = suggest::Forecast(knowledge).sigmas({});
  ASSERT_EQ(now.size(), 3U);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      const double stated = std::sqrt((*result.camera_to_robot[c].covariance)(i, i));
      EXPECT_NEAR(now[c][axis].value_or(0.0) / stated, 1.0, 0.03) << c << axis;
    }
}

// Of stops that show either board. Lenses and boards have priors, which count once however many stops there are, and so
// does what is stated of a place.
TEST(SuggestBeforeTwoBoards, ForecastsAreThoseOfTheWholeProblem) {
  for (const bool with_place : {false, true}) {
    SCOPED_TRACE(with_place);
    PastTwoBoards made(24, 12);
    made.config.rig.board.doubt();
    made.second.board.doubt();
    for (RigCamera& camera : made.config.rig.cameras) camera.intrinsics_sigma = IntrinsicsSigma();
    for (RigCamera& camera : made.config.rig.cameras) camera.intrinsics_sigma.residual_px = 0.0;
    GeometricRun run = made.drawn();
    for (Board* board : {&run.observations.board, &run.observations.more_boards[0]}) board->print_sigma_m = 0.0;
    if (with_place)
      run.observations.more_boards[0].place =
          BoardPlace{run.truth.T_world_board.inverse() * run.truth.board_at(1).T_world_board, 0.003, 0.003};
    MlOptions as_stated;
    as_stated.estimate_corner_level = as_stated.estimate_plane_level = false;
    const suggest::CalibrationSoFar knowledge = suggest::calibration_so_far(run.observations, as_stated);
    ASSERT_TRUE(knowledge.determined);
    ASSERT_EQ(knowledge.basis.used.more_boards[0].place.has_value(), with_place);
    const suggest::Foresight foresight(knowledge, options_of(1));
    const suggest::Forecast forecast(knowledge);
    Observations whole = foresight.as_expected(forecast.levels());
    CalibrationState state = knowledge.estimate.state;
    std::vector<suggest::StopInformation> stops;
    suggest::Place before = suggest::Place::of(state.T_world_robot.back());
    std::set<int> boards;
    for (const double turn_rad : {0.4, -0.5, 0.9, -1.1}) {
      const suggest::Place place = before.turned_to(before.yaw_rad + turn_rad, Eigen::Vector2d::Zero());
      stops.push_back(forecast.information_of(foresight, place));
      foresight.append_stop(before.T_world_robot(), place.T_world_robot(), &whole);
      state.T_world_robot.push_back(place.T_world_robot());
      before = place;
    }
    for (const BoardView& view : whole.board_views)
      if (view.stop >= 12) boards.insert(view.board);
    ASSERT_EQ(boards.size(), 2U) << "the stops show both";
    std::vector<const suggest::StopInformation*> all;
    for (const suggest::StopInformation& stop : stops) all.push_back(&stop);
    const std::vector<AxisSigmas> foretold = forecast.sigmas(all);
    CalibrationNoise noise = knowledge.estimate.noise;
    noise.law = forecast.levels().law;
    noise.odometry_xy_m = forecast.levels().odometry_xy_m;
    noise.odometry_yaw_rad = forecast.levels().odometry_yaw_rad;
    noise.suspension_height_m = forecast.levels().suspension_height_m;
    noise.suspension_tilt_rad = forecast.levels().suspension_tilt_rad;
    const InformationBound bound = cramer_rao_bound(whole, state, noise);
    ASSERT_EQ(foretold.size(), 3U);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t axis = 0; axis < 6; ++axis) {
        const auto i = static_cast<Eigen::Index>(axis);
        ASSERT_TRUE(foretold[c][axis]);
        EXPECT_NEAR(*foretold[c][axis] / std::sqrt(bound.camera_to_robot[c](i, i)), 1.0, 0.03) << c << axis;
      }
  }
}

// Each camera sees what is foretold that it sees, and what is stated then is what was foretold.
TEST(SuggestBeforeTwoBoards, StopsComeTrue) {
  PastTwoBoards made(22, 10);
  GeometricScene scene = made.scene();
  const GeometricRun run = drawn_past_boards(made.config, scene, {made.second});
  const Suggestion suggestion = suggest_stops(run.observations, options_of(5));
  ASSERT_GE(suggestion.stops.size(), 3U);
  for (const SuggestedStop& stop : suggestion.stops)
    scene.T_world_robot.push_back(scene.T_world_robot.back() * stop.command.motion());
  const GeometricRun replay = drawn_past_boards(made.config, scene, {made.second});
  std::set<int> of_aside;
  for (std::size_t i = 0; i < suggestion.stops.size(); ++i) {
    std::set<int> seeing;
    for (const BoardView& view : replay.observations.board_views)
      if (view.stop == static_cast<int>(run.truth.stops.size() + i)) seeing.insert(view.camera);
    for (const int camera : suggestion.stops[i].cameras) EXPECT_EQ(seeing.count(camera), 1U) << i << camera;
    if (seeing.count(static_cast<int>(kAside)) > 0) of_aside.insert(static_cast<int>(i));
    for (const GeometricBoard& board : {GeometricBoard{run.truth.board, scene.T_world_board, {}}, made.second})
      EXPECT_GT(
          (scene.T_world_robot[run.truth.stops.size() + i].translation - board.T_world_board * board.board.centre())
              .head<2>()
              .norm(),
          0.9);
  }
  EXPECT_GE(of_aside.size(), 1U) << "the camera that is known worst";
  const Result then = estimate_maximum_likelihood(replay.observations, {}).result;
  ASSERT_EQ(then.status, ResultStatus::kSolved);
  ASSERT_EQ(suggestion.cameras.size(), 3U);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      const double stated = std::sqrt((*then.camera_to_robot[c].covariance)(i, i));
      ASSERT_TRUE(suggestion.cameras[c].then[axis]);
      EXPECT_GT(stated / *suggestion.cameras[c].then[axis], 0.6) << c << axis;
      EXPECT_LT(stated / *suggestion.cameras[c].then[axis], 1.6) << c << axis;
      EXPECT_LE(*suggestion.cameras[c].then[axis], 1.001 * *suggestion.cameras[c].now[axis]) << c << axis;
    }
}

// A camera that has seen no board yet is turned to the nearest one, whichever that is.
TEST(SuggestBeforeTwoBoards, ACameraWithoutABoardIsTurnedToOne) {
  PastTwoBoards made(23, 10);
  GeometricRun run = made.drawn();
  forget_board(&run.observations, [](const BoardView& view) { return view.camera == 0; });
  for (int stop = 0; stop < 10; ++stop)
    run.observations.exclusions.push_back({0, stop, "0.png", Finding("board.not_found")});
  const Suggestion suggestion = suggest_stops(run.observations, options_of(3));
  EXPECT_TRUE(std::any_of(suggestion.stops.begin(), suggestion.stops.end(), [](const SuggestedStop& stop) {
    return std::find(stop.hoped.begin(), stop.hoped.end(), 0) != stop.hoped.end();
  }));
}

}  // namespace
}  // namespace rigproof
