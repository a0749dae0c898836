#include "diagnosis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "broken_runs.h"
#include "cases.h"
#include "faults.h"
#include "rigproof/calib/diagnose/board_scale.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/odometry_rows.h"
#include "rigproof/core/conventions.h"
#include "stop_edits.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

bool mentioned(const std::vector<Finding>& findings, const std::string& words) {
  for (const std::string& sentence : worded(findings))
    if (sentence.find(words) != std::string::npos) return true;
  return false;
}

class Broken : public testing::TestWithParam<std::size_t> {};

// One recording for each thing that can be wrong; bench_refusals measures the rates over many.
TEST_P(Broken, IsRefusedAndTheCauseNamedFirst) {
  const Breakage& breakage = breakages()[GetParam()];
  constexpr std::uint64_t kSeed = 2;
  Observations observations = draw_geometric_run(broken_run_config(breakage, kSeed)).observations;
  const std::string words = breakage.apply(kSeed, &observations);
  const Result result = estimate_maximum_likelihood(observations).result;
  if (breakage.named_in == NamedIn::kNotes) {
    EXPECT_TRUE(mentioned(result.notes, words)) << words << "\n" << testing::PrintToString(result.notes);
    return;
  }
  EXPECT_NE(result.status, ResultStatus::kSolved);
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_NE(worded(result.reasons).front().find(words), std::string::npos) << testing::PrintToString(result.reasons);
  EXPECT_FALSE(result.joint_covariance.has_value());
  for (const EstimatedTransform& transform : result.camera_to_robot)
    EXPECT_FALSE(transform.observable[0] || transform.observable[1] || transform.observable[5]);
}

INSTANTIATE_TEST_SUITE_P(Recordings, Broken, testing::Range<std::size_t>(0, breakages().size()),
                         [](const auto& instance) {
                           std::string name = breakages()[instance.param].name;
                           for (char& c : name)
                             if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
                           return name;
                         });

Observations drive_with_depth_on_the_board() {
  GeometricConfig config;
  config.seed = 3;
  config.stops = 20;
  config.board_planes = true;
  return draw_geometric_run(config).observations;
}

// Far from what small steps reach, and no unit of the depth: what the depth says of the focal length is tried.
TEST(Lenses, AFocalLengthHalvedOrDoubledIsNotBlamedOnTheDepth) {
  for (const double factor : cases<double>({0.5, 2.0})) {
    Observations observations = drive_with_depth_on_the_board();
    Camera& told = observations.cameras[1].camera;
    told.fx_px *= factor;
    told.fy_px *= factor;
    const Result result = estimate_maximum_likelihood(observations).result;
    ASSERT_FALSE(result.reasons.empty());
    EXPECT_EQ(result.reasons.front().code, "lens.intrinsics") << factor;
    EXPECT_EQ(result.reasons.front().cameras, std::vector<std::string>{observations.cameras[1].name});
  }
}

// Small steps end at another optimum; from where another resolution puts focal length and centre they do not.
TEST(Lenses, IntrinsicsOfThreeTimesTheResolutionAreNotBlamedOnTheDepth) {
  Observations observations = drive_with_depth_on_the_board();
  Camera& told = observations.cameras[1].camera;
  for (double* focal_px : {&told.fx_px, &told.fy_px}) *focal_px *= 3.0;
  for (double* centre_px : {&told.cx_px, &told.cy_px}) *centre_px = 3.0 * (*centre_px + 0.5) - 0.5;
  const Result result = estimate_maximum_likelihood(observations).result;
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_EQ(result.reasons.front().code, "lens.intrinsics");
  EXPECT_EQ(result.reasons.front().cameras, std::vector<std::string>{observations.cameras[1].name});
}

// The levels of suspension and odometry grow with the slip and hide it, four and a half deviations deep.
TEST(Lenses, AHalfPixelIsJudgedByTheLevelsWithoutIt) {
  const auto slip = std::find_if(breakages().begin(), breakages().end(), [](const Breakage& breakage) {
    return std::string(breakage.name) == "half-pixel offset";
  });
  ASSERT_NE(slip, breakages().end());
  for (const std::uint64_t seed : cases<std::uint64_t>({6U, 7U, 8U, 9U})) {
    Observations observations = draw_geometric_run(broken_run_config(*slip, seed)).observations;
    const std::string words = slip->apply(seed, &observations);
    const Result result = estimate_maximum_likelihood(observations).result;
    ASSERT_FALSE(result.reasons.empty()) << seed;
    EXPECT_NE(worded(result.reasons).front().find(words), std::string::npos)
        << seed << ": " << worded(result.reasons).front();
  }
}

Observations run_with_depth(std::uint64_t seed, double depth_scale_sigma) {
  GeometricConfig config;
  config.seed = seed;
  config.stops = 12;
  config.board_planes = true;
  config.depth_scale_sigma = depth_scale_sigma;
  return draw_geometric_run(config).observations;
}

// Two cameras that never see the board together: seed 2 stated a part of the one in the other, off by 7 deg.
TEST(Diagnosis, CamerasThatOnlyContradictedOdometryConnectsAreWithheld) {
  for (const Breakage& breakage : breakages()) {
    if (std::string(breakage.name) != "yaw in degrees") continue;
    Observations observations = draw_geometric_run(broken_run_config(breakage, 2)).observations;
    breakage.apply(2, &observations);
    const Result result = estimate_maximum_likelihood(observations).result;
    ASSERT_EQ(result.camera_to_camera.size(), 1U);
    for (const bool observable : result.camera_to_camera[0].observable) EXPECT_FALSE(observable);
    const std::vector<std::string> reasons = worded(result.reasons);
    EXPECT_EQ(std::count(reasons.begin(), reasons.end(),
                         "camera2 in camera1: too few stops show the board to both, and the odometry that connects "
                         "them is contradicted."),
              1);
    return;
  }
  FAIL() << "no such breakage";
}

TEST(BoardScale, SaysHowLargeTheSquaresAre) {
  Observations observations = run_with_depth(1, 0.0);
  observations.board.square_m = 0.108;
  const Result result = estimate_maximum_likelihood(observations).result;
  EXPECT_EQ(result.status, ResultStatus::kRefused);
  ASSERT_FALSE(result.reasons.empty());
  // 36 boards of 60 points: 0.01 %. PnP of 0.1 px adds less than 0.1 %.
  EXPECT_NE(worded(result.reasons).front().find("measure about 100.0 mm by depth, the rig says 108.0 mm"),
            std::string::npos)
      << worded(result.reasons).front();
  EXPECT_NE(worded(result.reasons).front().find("by the odometry"), std::string::npos);
}

// If the board were wrong, the odometry would have to be wrong as well.
TEST(BoardScale, OdometryThatSeesTheStatedSizeSpeaksAgainstTheDepth) {
  Observations observations = run_with_depth(1, 0.0);
  for (auto* planes : {&observations.ground_planes, &observations.board_planes})
    for (PlaneObservation& plane : *planes) plane.inverse_depth_plane /= 1.15;
  const Result result = estimate_maximum_likelihood(observations).result;
  EXPECT_EQ(result.status, ResultStatus::kRefused);
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_EQ(result.reasons.front().code, "depth.board_size") << testing::PrintToString(worded(result.reasons));
  EXPECT_TRUE(mentioned(result.reasons, "by it the squares of the board measure about 115.0 mm"))
      << testing::PrintToString(worded(result.reasons));
}

// Nothing is known of odometry that sees yet another size.
TEST(BoardScale, OdometryThatSeesAnotherSizeDoesNotSpeakAgainstTheDepth) {
  Observations observations = run_with_depth(1, 0.0);
  observations.board.square_m = 0.108;
  for (Stop& stop : observations.stops) {
    stop.x_m *= 0.9;
    stop.y_m *= 0.9;
  }
  const Result result = estimate_maximum_likelihood(observations).result;
  EXPECT_EQ(result.status, ResultStatus::kRefused);
  EXPECT_TRUE(has_code(result.reasons, "board.size")) << testing::PrintToString(worded(result.reasons));
  EXPECT_FALSE(has_code(result.reasons, "depth.board_size"));
}

// Real depth sensors are off by 1 %: no reason to refuse, and none to blame the board.
TEST(BoardScale, ForgivesWhatDepthSensorsAreOffByOverTrials) {
  for (int seed = 0; seed < Trials(8, 20).count(); ++seed) {
    const Result result = estimate_maximum_likelihood(run_with_depth(static_cast<std::uint64_t>(seed), 0.01)).result;
    EXPECT_EQ(result.status, ResultStatus::kSolved)
        << seed << ": " << (result.reasons.empty() ? "" : worded(result.reasons).front());
  }
}

Observations with_farther_depth(Observations observations, double factor) {
  for (auto* planes : {&observations.ground_planes, &observations.board_planes})
    for (PlaneObservation& plane : *planes) plane.inverse_depth_plane /= factor;
  return observations;
}

// One figure for check and estimate: what the rig says, of each sensor and of its make.
TEST(BoardScale, DepthIsJudgedByWhatTheRigSaysOfItsScale) {
  Observations poor = with_farther_depth(run_with_depth(1, 0.0), 1.06);
  for (RigCamera& camera : poor.cameras) camera.depth->noise.common_scale_sigma = 0.03;
  const Result forgiven = estimate_maximum_likelihood(poor).result;
  EXPECT_EQ(forgiven.status, ResultStatus::kSolved) << testing::PrintToString(worded(forgiven.reasons));

  Observations fine = with_farther_depth(run_with_depth(1, 0.0), 1.02);
  for (RigCamera& camera : fine.cameras) camera.depth->noise.scale_sigma = 0.002;
  const Result refused = estimate_maximum_likelihood(fine).result;
  EXPECT_EQ(refused.status, ResultStatus::kRefused);
}

// Corners know a focal length ten times better than is stated here: it excuses no depth.
TEST(BoardScale, TheLensCountsAsItIsEstimated) {
  GeometricConfig config;
  config.stops = 40;
  config.board_planes = true;
  config.corner_sigma_px = 0.02;
  config.depth_scales = {1.02, 1.02, 1.02};
  Observations observations = draw_geometric_run(config).observations;
  for (RigCamera& camera : observations.cameras) {
    camera.depth->noise.scale_sigma = 0.002;
    camera.intrinsics_sigma.focal_relative = 0.02;
  }
  const Result result = estimate_maximum_likelihood(observations).result;
  EXPECT_EQ(result.status, ResultStatus::kRefused);
}

TEST(BoardScale, NamesTheCameraWhoseDepthIsInAnotherUnit) {
  Observations observations = run_with_depth(3, 0.0);
  for (auto* planes : {&observations.ground_planes, &observations.board_planes})
    for (PlaneObservation& plane : *planes)
      if (plane.camera == 2) plane.inverse_depth_plane *= 0.25;  // counts of 0.25 mm read as millimetres
  const Result result = estimate_maximum_likelihood(observations).result;
  EXPECT_NE(result.status, ResultStatus::kSolved);
  EXPECT_TRUE(mentioned(result.reasons, "the depth of right is in another unit"))
      << testing::PrintToString(result.reasons);
}

// Of four cameras one states a poor depth: what is wrong with another one shows against the two that are good.
TEST(BoardScale, APoorCameraHidesNoOtherOne) {
  Observations observations = run_with_depth(3, 0.0);
  observations.cameras.push_back(observations.cameras[0]);
  observations.cameras.back().name = "rear";
  const auto see_again = [](auto& all) {
    const auto before = all;
    for (auto one : before)
      if (one.camera == 0) {
        one.camera = 3;
        all.push_back(one);
      }
  };
  see_again(observations.board_views);
  see_again(observations.board_planes);
  for (RigCamera& camera : observations.cameras)
    camera.depth->noise.scale_sigma = camera.name == "center" ? 0.2 : 0.003;
  for (PlaneObservation& plane : observations.board_planes)
    if (plane.camera == 2) plane.inverse_depth_plane /= 1.6;
  const ml::BoardScale scale =
      ml::check_board_scale(observations, estimate_view_poses(observations).poses, std::nullopt);
  ASSERT_EQ(scale.contradictions.size(), 1U);
  EXPECT_EQ(scale.contradictions[0].cameras, std::vector<std::string>{"right"});
}

// Any factor may be an error, a unit is one in use.
TEST(BoardScale, CallsNoFactorAUnitThatIsNone) {
  Observations observations = run_with_depth(3, 0.0);
  for (auto* planes : {&observations.ground_planes, &observations.board_planes})
    for (PlaneObservation& plane : *planes)
      if (plane.camera == 2) plane.inverse_depth_plane /= 0.513;
  const Result result = estimate_maximum_likelihood(observations).result;
  EXPECT_NE(result.status, ResultStatus::kSolved);
  EXPECT_TRUE(mentioned(result.reasons, "the depth of right is 0.513 times what the corners say, which no other unit"))
      << testing::PrintToString(result.reasons);
}

TEST(BoardScale, RestsOnTheBoardWhereNoDepthIs) {
  GeometricConfig config;
  config.stops = 12;
  const Result result = estimate_maximum_likelihood(draw_geometric_run(config).observations).result;
  EXPECT_EQ(result.status, ResultStatus::kSolved);
  EXPECT_TRUE(mentioned(result.notes, "Scale rests on the board")) << testing::PrintToString(result.notes);
  EXPECT_TRUE(mentioned(result.notes, "the odometry agrees"));
}

TEST(BoardScale, TellsOfOdometryThatDoesNotAgree) {
  GeometricConfig config;
  config.stops = 12;
  config.odometry_scale = 1.0;
  Observations observations = draw_geometric_run(config).observations;
  observations.board.square_m *= 1.08;
  const Result result = estimate_maximum_likelihood(observations).result;
  // 11 increments of 2 mm and more over a metre: 0.1 mm of 100 mm.
  EXPECT_TRUE(mentioned(result.notes, "by the odometry they measure 100.") ||
              mentioned(result.notes, "by the odometry they measure 99."))
      << testing::PrintToString(result.notes);
}

// Wheels that are believed stay at what is stated, whatever the data show: they vouch for no board.
TEST(BoardScale, WheelsThatAreBelievedDoNotAgree) {
  GeometricConfig config;
  config.stops = 12;
  config.odometry_scale = 1.0;
  Observations observations = draw_geometric_run(config).observations;
  observations.board.square_m *= 1.005;
  observations.odometry_noise.scale_sigma = 0.001;
  const Result result = estimate_maximum_likelihood(observations).result;
  EXPECT_TRUE(mentioned(result.notes, "Scale rests on the board")) << testing::PrintToString(worded(result.notes));
  EXPECT_FALSE(mentioned(result.notes, "the odometry agrees")) << testing::PrintToString(worded(result.notes));
  EXPECT_TRUE(result.reasons.empty()) << testing::PrintToString(worded(result.reasons));
}

Observations healthy() {
  GeometricConfig config;
  config.stops = 9;
  config.lambda = 0.0;
  return draw_geometric_run(config).observations;
}

double farthest(const Observations& a, const Observations& b, std::size_t first, std::size_t end) {
  double worst = 0.0;
  for (std::size_t i = first; i < end; ++i)
    worst = std::max({worst, std::abs(a.stops[i].x_m - b.stops[i].x_m), std::abs(a.stops[i].y_m - b.stops[i].y_m),
                      std::abs(wrap_angle(a.stops[i].yaw_rad - b.stops[i].yaw_rad))});
  return worst;
}

TEST(Faults, AreUndone) {
  const std::vector<std::pair<const char*, double>> units = {
      {"millimetres", 1e-3}, {"centimetres", 1e-2}, {"inches", 0.0254}, {"feet", 0.3048}};
  const Observations right = healthy();
  for (const ml::Fault& fault : ml::odometry_faults(right)) {
    if (fault.kind == ml::FaultKind::kStamps) continue;
    Observations wrong = right;
    for (Stop& stop : wrong.stops) {
      for (const auto& [unit, metres] : units) {
        if (!(fault.cause == Finding("odometry.unit", {{"unit", unit}}))) continue;
        stop.x_m /= metres;
        stop.y_m /= metres;
      }
      if (fault.cause.is("odometry.yaw_in_degrees") || has_code(fault.further, "odometry.yaw_in_degrees"))
        stop.yaw_rad = rad_to_deg(stop.yaw_rad);
      if (fault.cause.is("odometry.yaw_of_quaternion")) stop.yaw_rad = std::sin(0.5 * stop.yaw_rad);
    }
    if (fault.kind == ml::FaultKind::kSign) fault.undo(&wrong);                            // these undo themselves
    for (int i = 0; i < 5 && fault.cause.is("odometry.columns"); ++i) fault.undo(&wrong);  // all orders in six
    fault.undo(&wrong);
    EXPECT_LT(farthest(right, wrong, 0, right.stops.size()), 1e-9) << worded(fault.cause);
  }
}

TEST(Faults, ShiftedStampsAreUndoneButAtTheEnd) {
  const Observations right = healthy();
  Observations wrong = right;
  for (std::size_t i = 0; i + 1 < wrong.stops.size(); ++i) wrong.stops[i] = right.stops[i + 1];
  ml::odometry_ahead(right, 1.0).undo(&wrong);
  EXPECT_LT(farthest(right, wrong, 1, right.stops.size()), 1e-9);
}

TEST(Faults, ScaledTurnsAreUndone) {
  const Observations right = healthy();
  Observations wrong = right;
  ml::turns_scaled(1.0 / 0.8).undo(&wrong);
  EXPECT_GT(farthest(right, wrong, 0, right.stops.size()), 0.1);
  ml::turns_scaled(0.8).undo(&wrong);
  EXPECT_LT(farthest(right, wrong, 0, right.stops.size()), 1e-9);
}

Observations drive_of(int stops) {
  GeometricConfig config;
  config.stops = stops;
  config.declare_odometry_model = config.declare_odometry_sigmas = false;
  return draw_geometric_run(config).observations;
}

// Ten stops are nine ways, also where a camera missed a stop and saw the way past it.
TEST(Diagnosis, CountsEachWayOfADeadOdometryOnce) {
  Observations observations = drive_of(10);
  for (Stop& stop : observations.stops) stop.x_m = stop.y_m = stop.yaw_rad = 0.0;
  std::vector<BoardView>& views = observations.board_views;
  views.erase(std::remove_if(views.begin(), views.end(),
                             [](const BoardView& view) { return view.camera == 0 && view.stop % 3 == 1; }),
              views.end());
  const std::vector<Finding> reasons = estimate_maximum_likelihood(observations).result.reasons;
  const auto dead =
      std::find_if(reasons.begin(), reasons.end(), [](const Finding& reason) { return reason.is("odometry.dead"); });
  ASSERT_NE(dead, reasons.end()) << testing::PrintToString(worded(reasons));
  EXPECT_EQ(std::get<double>(dead->find("motions")->value), 9.0);
  EXPECT_EQ(std::get<double>(dead->find("still")->value), 9.0);
}

TEST(Diagnosis, NamesFramesInAnotherOrder) {
  const Observations right = drive_of(12);
  std::vector<int> backward(12), text(12);
  std::iota(backward.rbegin(), backward.rend(), 0);
  std::iota(text.begin(), text.end(), 0);
  // Frame i has the stamp of the place at which its number, from 1 on, comes as text.
  std::vector<std::string> numbers;
  for (int i = 1; i <= 12; ++i) numbers.push_back(std::to_string(i));
  std::sort(numbers.begin(), numbers.end());
  for (int place = 0; place < 12; ++place)
    text[static_cast<std::size_t>(std::stoi(numbers[static_cast<std::size_t>(place)]) - 1)] = place;
  const auto orders = cases<std::pair<std::vector<int>, std::vector<int>>>({{{0, 1, 2}, text}, {{1}, backward}});
  for (const auto& [cameras, order] : orders) {
    Observations wrong = right;
    ml::move_frames(cameras, order, &wrong);
    const Result result = estimate_maximum_likelihood(wrong).result;
    ASSERT_FALSE(result.reasons.empty());
    EXPECT_EQ(result.reasons.front().code, "frames.misordered") << testing::PrintToString(worded(result.reasons));
    EXPECT_EQ(result.reasons.front().cameras.size(), cameras.size() % 3);
  }
}

Observations drive_of_one_camera(std::uint64_t seed) {
  GeometricConfig config;
  config.seed = seed;
  config.stops = 16;
  config.rig.cameras.resize(1);
  config.rig.T_robot_camera.resize(1);
  config.rig.min_cameras_per_stop = 1;
  return draw_geometric_run(config).observations;
}

// One frame less or more from a stop in the middle on, of the only camera or of one among others.
TEST(Diagnosis, NamesFramesFromWhichOnOneIsMissingOrDoubled) {
  for (const auto& [right, camera, by] :
       cases<std::tuple<Observations, int, int>>({{drive_of_one_camera(2), 0, 1}, {drive_of(12), 1, -1}})) {
    Observations wrong = right;
    const int split = static_cast<int>(right.stops.size()) / 2;
    ml::shift_cameras({camera}, -by, by > 0 ? split + 1 : split, &wrong);
    const Result result = estimate_maximum_likelihood(wrong).result;
    ASSERT_FALSE(result.reasons.empty());
    const Finding& cause = result.reasons.front();
    EXPECT_EQ(cause.code, "frames.shifted") << testing::PrintToString(worded(result.reasons));
    EXPECT_EQ(cause.cameras, std::vector<std::string>{right.cameras[static_cast<std::size_t>(camera)].name});
    ASSERT_NE(cause.find("from"), nullptr);
    EXPECT_NEAR(std::get<double>(cause.find("from")->value), split, 1.0);
    EXPECT_EQ(std::get<std::string>(cause.find("to")->value), by > 0 ? "next" : "previous");
  }
}

// So large that they outweigh the images, of which most are left out, and the equations have no solution.
TEST(Diagnosis, NamesMillimetresThatOutweighTheImages) {
  for (const std::uint64_t seed : cases<std::uint64_t>({1U, 2U, 3U, 4U})) {
    Observations wrong = drive_of_one_camera(seed);
    for (Stop& stop : wrong.stops) stop.x_m *= 1e3, stop.y_m *= 1e3;
    const Result result = estimate_maximum_likelihood(wrong).result;
    ASSERT_FALSE(result.reasons.empty());
    EXPECT_EQ(result.reasons.front().code, "odometry.unit") << seed << testing::PrintToString(worded(result.reasons));
  }
}

TEST(Diagnosis, NamesMillimetresAndDegreesAtOnce) {
  for (const std::uint64_t seed : cases<std::uint64_t>({1U, 2U, 3U})) {
    Observations wrong = drive_of_one_camera(seed);
    for (Stop& stop : wrong.stops) stop.x_m *= 1e3, stop.y_m *= 1e3, stop.yaw_rad = rad_to_deg(stop.yaw_rad);
    const Result result = estimate_maximum_likelihood(wrong).result;
    ASSERT_GE(result.reasons.size(), 2U);
    EXPECT_EQ(result.reasons[0].code, "odometry.unit") << seed << testing::PrintToString(worded(result.reasons));
    EXPECT_EQ(result.reasons[1].code, "odometry.yaw_in_degrees");
  }
}

// The same images again and again leave too few poses; that they repeat is the reason, not that the drive is short.
TEST(Diagnosis, NamesACameraThatHung) {
  Observations wrong = drive_of_one_camera(1);
  std::vector<BoardView> kept;
  for (BoardView& view : wrong.board_views) {
    if (view.stop == 0) {
      kept.push_back(view);
      continue;
    }
    wrong.exclusions.push_back({0, view.stop, "again.png", Finding("image.repeats", {{"file", "first.png"}}), false});
  }
  wrong.board_views = kept;
  const Result result = estimate_maximum_likelihood(wrong).result;
  EXPECT_NE(result.status, ResultStatus::kSolved);
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_EQ(result.reasons.front().code, "images.frozen") << testing::PrintToString(worded(result.reasons));
  EXPECT_EQ(result.reasons.front().cameras, std::vector<std::string>{wrong.cameras[0].name});
  EXPECT_FALSE(has_code(result.notes, "frames.repeat"));
}

// That depth repeats says nothing against the images, whatever the camera's answer lacks.
TEST(Diagnosis, DoesNotTakeDepthThatHungForImages) {
  Observations wrong = drive_of_one_camera(1);
  for (const PlaneObservation& plane : wrong.ground_planes)
    wrong.exclusions.push_back({0, plane.stop, "again.png", Finding("depth.repeats", {{"file", "first.png"}}), true});
  wrong.ground_planes.clear();
  const Result result = estimate_maximum_likelihood(wrong).result;
  EXPECT_EQ(result.status, ResultStatus::kPartial);
  EXPECT_TRUE(has_code(result.reasons, "ground.unseen")) << testing::PrintToString(worded(result.reasons));
  EXPECT_FALSE(has_code(result.reasons, "images.frozen"));
  EXPECT_FALSE(has_code(result.notes, "frames.repeat"));
  EXPECT_TRUE(has_code(result.notes, "depth.frames_repeat"));
}

// The camera sees the board at the first ten of 16 stops, and the data would be in order without the last of its views:
// frames that are lost there would put no view elsewhere.
TEST(Diagnosis, LosesNoFrameToLeaveOutAView) {
  Observations wrong = drive_of_one_camera(1);
  std::vector<BoardView>& views = wrong.board_views;
  views.erase(std::remove_if(views.begin(), views.end(), [](const BoardView& view) { return view.stop >= 10; }),
              views.end());
  const auto seen_at = [](const Observations& observations) {
    std::vector<std::pair<int, double>> seen;  // stop, and what tells one view from another
    for (const BoardView& view : observations.board_views) seen.emplace_back(view.stop, view.corners.front().pixel.x());
    return seen;
  };
  std::vector<std::pair<int, double>> without_last = seen_at(wrong);
  without_last.pop_back();
  int tried = 0;
  const auto refit = [&](const Observations& repaired, bool, const ml::Trial*) {
    ml::Trial trial;
    trial.clean = seen_at(repaired) == without_last;
    trial.unexplained = trial.clean ? 0.0 : 1000.0;
    ++tried;
    return std::optional<ml::Trial>(trial);
  };
  ml::Symptoms symptoms;
  symptoms.bad_corners = {false};
  symptoms.frames = true;
  const std::optional<ml::Cause> cause = ml::find_cause(wrong, symptoms, refit);
  EXPECT_FALSE(cause) << testing::PrintToString(worded(cause->findings));
  EXPECT_GT(tried, 5);
}

TEST(Diagnosis, NamesStampsThatAreFarOff) {
  const Observations right = drive_of(16);
  Observations wrong = right;
  for (std::size_t i = 0; i + 5 < wrong.stops.size(); ++i) {
    wrong.stops[i] = right.stops[i + 5];
    wrong.stops[i].stamp_s = right.stops[i].stamp_s;
  }
  const Result result = estimate_maximum_likelihood(ml::first_stops(wrong, 11)).result;
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_EQ(result.reasons.front().code, "odometry.stamps");
  EXPECT_NEAR(std::get<double>(result.reasons.front().find("shift_stops")->value), 5.0, 1e-9);
}

TEST(Diagnosis, NamesFramesWithoutOdometryAndTheirUnit) {
  Observations few = ml::first_stops(drive_of(12), 2);
  for (int i = 0; i < 30; ++i)
    few.exclusions.push_back(
        {i % 3, -1, "x.png",
         Finding("odometry.not_covering", {{"stamp_s", 2000.0 * i}, {"first_s", 0.0}, {"last_s", 58.0}})});
  const Result result = estimate_maximum_likelihood(few).result;
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_EQ(worded(result.reasons.front()),
            "Most likely cause: the odometry has nothing for 30 of 36 frames: their stamps look like milliseconds, not "
            "seconds.");
}

TEST(OdometryRows, NameARowAndASlip) {
  GeometricConfig config;
  config.stops = 20;
  Observations observations = draw_geometric_run(config).observations;
  observations.stops[7].x_m += 0.4;
  Observations slipped = observations;
  for (std::size_t i = 13; i < slipped.stops.size(); ++i) slipped.stops[i].y_m += 0.3;
  const Result result = estimate_maximum_likelihood(slipped).result;
  EXPECT_EQ(result.status, ResultStatus::kSolved);
  EXPECT_TRUE(mentioned(result.notes, "The odometry's row at stop 7 (14.0 s) contradicts the cameras by"))
      << testing::PrintToString(result.notes);
  EXPECT_TRUE(mentioned(result.notes, "The odometry's motion from stop 12 to 13 (26.0 s)"))
      << testing::PrintToString(result.notes);
}

TEST(Note, WhatOneStopCannotSayIsNotSaid) {
  GeometricConfig config;
  config.stops = 1;
  config.declare_odometry_model = config.declare_odometry_sigmas = false;
  const Result result = estimate_maximum_likelihood(draw_geometric_run(config).observations).result;
  EXPECT_FALSE(mentioned(result.notes, "nan")) << testing::PrintToString(result.notes);
}

}  // namespace
}  // namespace rigproof
