// The known failures of the MEMROC authors' program, and that no method of our own shares one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "board_drive.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/calib/vision/ground_plane.h"
#include "rigproof/core/conventions.h"
#include "temp_folder.h"
#include "worded.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

const std::vector<const Method*>& references() {
  static const std::vector<const Method*> methods = {&find_method("memroc_reference"),
                                                     &find_method("joint_memroc_reference")};
  return methods;
}

// Those that place cameras in the robot and are meant to be good at it.
const std::vector<const Method*>& others() {
  static const std::vector<const Method*> methods = {&ml_method(), &find_method("joint_memroc"), &find_method("memroc"),
                                                     &find_method("robot_autocalib_board")};
  return methods;
}

// MEMROC turns this noise into millimetres and tenths of a degree; what is tested below is off by ten times that.
constexpr double kGood_m = 0.01, kGood_rad = 0.006;

void expect_good(const Method& method, const SyntheticDrive& drive) {
  const WorstError error = worst_error(method.solve(drive.observations), drive);
  EXPECT_LT(error.distance_m, kGood_m) << method.traits().name;
  EXPECT_LT(error.angle_rad, kGood_rad) << method.traits().name;
}

void expect_others_good(const SyntheticDrive& drive) {
  for (const Method* method : others()) expect_good(*method, drive);
  const WorstError between = worst_pair_error(find_method("li").solve(drive.observations), drive);
  EXPECT_LT(between.distance_m, kGood_m) << "li";
  EXPECT_LT(between.angle_rad, kGood_rad) << "li";
}

// An upright board of a forward rig is what the program was made for.
TEST(MemrocReference, SolvesAnUprightBoard) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const SyntheticDrive drive = fine_drive(seed);
    for (const Method* method : references()) expect_good(*method, drive);
    expect_others_good(drive);
  }
}

TEST(MemrocReference, FallsIntoAWrongMinimumWhenTheBoardIsTurnedBy90Degrees) {
  for (const Method* method : references()) {
    double worst = 0.0;
    for (const double angle_deg : {90.0, -90.0}) {
      SyntheticDrive drive = fine_drive(1);
      turn_board(deg_to_rad(angle_deg), &drive);
      worst = std::max(worst, worst_error(method->solve(drive.observations), drive).angle_rad);
      expect_others_good(drive);
    }
    // Not a matter of accuracy: another minimum altogether.
    EXPECT_GT(rad_to_deg(worst), 10.0) << method->traits().name;
  }
}

TEST(MemrocReference, IgnoresTheHeightWhereOnlyTheFirstFrameHasACloud) {
  SyntheticDrive drive = fine_drive(2);
  std::vector<PlaneObservation>& planes = drive.observations.ground_planes;
  planes.erase(
      std::remove_if(planes.begin(), planes.end(), [](const PlaneObservation& plane) { return plane.stop > 0; }),
      planes.end());
  ASSERT_EQ(planes.size(), 3U);
  for (const Method* method : references()) {
    const Result result = method->solve(drive.observations);
    EXPECT_GT(worst_error(result, drive).height_m, 0.05) << method->traits().name;
    EXPECT_THAT(testing::PrintToString(result.notes), HasSubstr("no plane counted"));
  }
  expect_others_good(drive);
}

// The authors' program stops where a camera's folder of clouds is missing. An empty one leaves the height out.
TEST(MemrocReference, SaysBeforehandThatNoCameraHasDepth) {
  SyntheticDrive drive = fine_drive(2);
  drive.observations.ground_planes.clear();
  const TempFolder folder;
  Recording recording;
  recording.folder = folder.path();
  recording.rig.cameras = drive.observations.cameras;
  recording.frames.resize(3);
  for (const BoardView& view : drive.observations.board_views)
    recording.frames[static_cast<std::size_t>(view.camera)].push_back({view.file, "", "", view.stamp_s, 0.0, 0});
  for (const Method* method : references()) {
    for (const MethodInput& input : {MethodInput{drive.observations}, MethodInput{drive.observations, &recording, 1}}) {
      const Result result = run_method(*method, input);
      EXPECT_EQ(result.status, ResultStatus::kRefused);
      EXPECT_TRUE(result.camera_to_robot.empty());
      EXPECT_THAT(testing::PrintToString(result.reasons), HasSubstr("No camera has depth images or clouds"));
    }
    for (CameraFrame& frame : recording.frames[1]) frame.cloud_file = "none.txt";
    EXPECT_FALSE(method->why_not({drive.observations, &recording, 1}));
    for (CameraFrame& frame : recording.frames[1]) frame.cloud_file.clear();
  }
}

TEST(MemrocReference, ReturnsTheStartWhereViewsAreNeverConsecutive) {
  SyntheticDrive drive = fine_drive(3, 24);
  keep_views([](int stop, int /*camera*/) { return stop % 2 == 0; }, &drive);
  for (const Method* method : references()) {
    const Result result = method->solve(drive.observations);
    EXPECT_THAT(testing::PrintToString(result.notes), HasSubstr("never saw the board at two stops in a row"));
    for (std::size_t k = 0; k < 3; ++k) {
      const BoardView& first =
          *std::find_if(drive.observations.board_views.begin(), drive.observations.board_views.end(),
                        [k](const BoardView& view) { return view.camera == static_cast<int>(k); });
      const std::size_t stop = static_cast<std::size_t>(first.stop);
      const Rigid3 T_camera_board =
          (drive.T_world_robot[stop] * drive.T_robot_camera[k]).inverse() * drive.T_world_board;
      const Rigid3 start = T_camera_board * drive.T_world_robot[stop].inverse();
      const Vector6d error = transform_error(result.camera_to_robot[k].T_parent_child, start);
      // PnP of a board two metres away, at 0.02 px, and the odometry's noise.
      EXPECT_LT(error.head<3>().norm(), 0.01);
      EXPECT_LT(error.tail<3>().norm(), 0.01);
    }
    EXPECT_GT(rad_to_deg(worst_error(result, drive).angle_rad), 10.0);
  }
  expect_others_good(drive);
}

// A room whose ceiling is nearer to filling the view than its floor --------------------------------------------------

constexpr double kCeiling_m = 2.4;

// Points of a level plane before the robot, in the camera's frame.
std::vector<Eigen::Vector3f> level_points(const Rigid3& X, double height_m, double spacing_m) {
  std::vector<Eigen::Vector3f> points;
  for (double x = 0.6; x < 4.0; x += spacing_m) {
    for (double y = -1.5; y < 1.5; y += spacing_m) {
      const Eigen::Vector3d point = X.inverse() * Eigen::Vector3d(x, y, height_m);
      if (point.z() > 0.3) points.push_back(point.cast<float>());
    }
  }
  return points;
}

void write_cloud(const std::filesystem::path& file, const std::vector<Eigen::Vector3f>& points) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream stream(file);
  for (const Eigen::Vector3f& p : points) stream << p.x() << " " << p.y() << " " << p.z() << "\n";
}

TEST(MemrocReference, TakesACeilingLargerThanTheFloorForTheGround) {
  SyntheticDrive drive = fine_drive(2);
  const TempFolder folder;
  Recording recording;
  recording.folder = folder.path();
  recording.rig.cameras = drive.observations.cameras;
  recording.frames.resize(3);
  drive.observations.ground_planes.clear();
  for (const BoardView& view : drive.observations.board_views) {
    const std::size_t k = static_cast<std::size_t>(view.camera);
    const Rigid3& X = drive.T_robot_camera[k];
    std::vector<Eigen::Vector3f> points = level_points(X, 0.0, 0.15);
    const std::vector<Eigen::Vector3f> ceiling = level_points(X, kCeiling_m, 0.08);
    ASSERT_GT(points.size(), 100U);
    ASSERT_GT(ceiling.size(), points.size());
    points.insert(points.end(), ceiling.begin(), ceiling.end());
    const std::string name = "clouds/" + std::to_string(k) + "_" + std::to_string(view.stop) + ".txt";
    write_cloud(folder / name, points);
    recording.frames[k].push_back({view.file, "", name, view.stamp_s, 0.0, 0});
    // What observing makes of the same cloud: up is known from the motion.
    const Eigen::Vector3d up = X.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    const GroundPlaneFit fit = fit_ground_plane({points, 1.0, 0.0, 0.3, 6.0}, DepthNoise(), up);
    ASSERT_TRUE(fit.plane) << worded(fit.why_not);
    drive.observations.ground_planes.push_back(*fit.plane);
    drive.observations.ground_planes.back().stop = view.stop;
    drive.observations.ground_planes.back().camera = view.camera;
  }
  for (const Method* method : references()) {
    const Result result = run_method(*method, {drive.observations, &recording, 1});
    EXPECT_GT(worst_error(result, drive).height_m, 0.3) << method->traits().name;
  }
  expect_others_good(drive);
}

// The failure has its cause in the ceiling: with the floor alone the same clouds give the height.
TEST(MemrocReference, FindsTheHeightInACloudOfTheFloor) {
  const SyntheticDrive drive = fine_drive(2);
  const TempFolder folder;
  Recording recording;
  recording.folder = folder.path();
  recording.rig.cameras = drive.observations.cameras;
  recording.frames.resize(3);
  for (const BoardView& view : drive.observations.board_views) {
    const std::size_t k = static_cast<std::size_t>(view.camera);
    const std::string name = "clouds/" + std::to_string(k) + "_" + std::to_string(view.stop) + ".txt";
    write_cloud(folder / name, level_points(drive.T_robot_camera[k], 0.0, 0.15));
    recording.frames[k].push_back({view.file, "", name, view.stamp_s, 0.0, 0});
  }
  const Result result = run_method(find_method("memroc_reference"), {drive.observations, &recording, 1});
  // Text with six digits.
  EXPECT_LT(worst_error(result, drive).height_m, 1e-3);
}

// The same with links replaced ---------------------------------------------------------------------------------------

TEST(MemrocChain, IsKnownByNameButNotListed) {
  for (const Method* link : memroc_chain_methods()) {
    EXPECT_EQ(&find_method(link->traits().name), link);
    EXPECT_THAT(all_methods(), testing::Not(testing::Contains(link)));
  }
}

// But the one that cannot do without images.
std::vector<const Method*> links() {
  std::vector<const Method*> methods = memroc_chain_methods();
  methods.pop_back();
  return methods;
}

TEST(MemrocChain, EveryLinkSolvesAnUprightBoard) {
  for (const std::uint64_t seed : {1u, 2u, 3u})
    for (const Method* link : links()) expect_good(*link, fine_drive(seed));
  EXPECT_EQ(run_method(*memroc_chain_methods().back(), {fine_drive(1).observations}).status, ResultStatus::kRefused);
}

// A failure ends with the link that is its cause: those before have it, that one and those after it do not.
void expect_cured_by(const std::string& cure, const SyntheticDrive& drive, double (*error)(const WorstError&),
                     double good) {
  bool cured = false;
  for (const Method* link : links()) {
    const std::string name = link->traits().name;
    cured = cured || name == cure;
    const double size = error(worst_error(link->solve(drive.observations), drive));
    if (cured)
      EXPECT_LT(size, good) << name;
    else
      EXPECT_GT(size, 5.0 * good) << name;
  }
  EXPECT_TRUE(cured);
}

TEST(MemrocChain, TheClosedFormStartCuresTheTurnedBoard) {
  // The one of the two directions that leads the program astray.
  SyntheticDrive worst;
  double largest = 0.0;
  for (const double angle_deg : {90.0, -90.0}) {
    SyntheticDrive drive = fine_drive(1);
    turn_board(deg_to_rad(angle_deg), &drive);
    const double angle = worst_error(references()[1]->solve(drive.observations), drive).angle_rad;
    if (angle > largest) worst = drive;
    largest = std::max(largest, angle);
  }
  expect_cured_by(
      "chain_start", worst, [](const WorstError& error) { return error.angle_rad; }, kGood_rad);
}

// A start at the right height does not: what nothing determines drifts with rounding.
TEST(MemrocChain, HeightsByThemselvesCureTheFirstFrame) {
  SyntheticDrive drive = fine_drive(2);
  std::vector<PlaneObservation>& planes = drive.observations.ground_planes;
  planes.erase(
      std::remove_if(planes.begin(), planes.end(), [](const PlaneObservation& plane) { return plane.stop > 0; }),
      planes.end());
  expect_cured_by(
      "chain_residual", drive, [](const WorstError& error) { return error.height_m; }, kGood_m);
}

}  // namespace
}  // namespace rigproof
