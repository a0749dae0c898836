// The rig in three dimensions: what is drawn where, how much too large, and what is said of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "../validate/synthetic.h"
#include "inspect_pictures.h"
#include "inspect_rig.h"
#include "rigproof/core/conventions.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using namespace testing_support;
using namespace inspect_detail;

const Eigen::Vector2d kCorner(10.0, 20.0), kSize(300.0, 200.0);

std::vector<Eigen::Vector3d> cube() {
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {0.0, 1.0}) corners.emplace_back(x, y, z);
  return corners;
}

TEST(SpaceView, FillsItsRectangleWithZUp) {
  const SpaceView view({1.0, 0.5, 0.7}, cube(), kCorner, kSize);
  Eigen::AlignedBox2d filled;
  for (const Eigen::Vector3d& p : cube()) filled.extend(view(p));
  EXPECT_NEAR(filled.sizes().y(), kSize.y(), 1e-9);
  EXPECT_LE(filled.sizes().x(), kSize.x());
  EXPECT_LT((filled.center() - kCorner - 0.5 * kSize).norm(), 1e-9);
  EXPECT_LT(view({0.0, 0.0, 1.0}).y(), view({0.0, 0.0, 0.0}).y()) << "z points up";
  EXPECT_NEAR(view({0.0, 0.0, 1.0}).x(), view({0.0, 0.0, 0.0}).x(), 1.0);
}

TEST(SpaceView, DoesNotMirror) {
  const SpaceView ahead({1.0, 0.0, 0.5}, cube(), kCorner, kSize), behind({-1.0, 0.0, 0.5}, cube(), kCorner, kSize);
  const Eigen::Vector3d left(0.0, 1.0, 0.0), right(0.0, -1.0, 0.0), front(1.0, 0.0, 0.0), back(-1.0, 0.0, 0.0);
  EXPECT_GT(ahead(left).x(), ahead(right).x()) << "who stands before the robot has its left hand on the right";
  EXPECT_LT(behind(left).x(), behind(right).x());
  EXPECT_LT(ahead.depth(front), ahead.depth(back));
  EXPECT_GT(behind.depth(front), behind.depth(back));
}

TEST(SpaceView, NearFacesCoverFarOnes) {
  const TempFolder folder;
  const auto wall = [](double x, const Color& color) {
    return Shape{{{x, -1.0, 0.0}, {x, 1.0, 0.0}, {x, 1.0, 1.0}, {x, -1.0, 1.0}}, color, 1.0};
  };
  for (const bool near_first : {false, true}) {
    std::vector<Shape> shapes = {wall(-1.0, {255, 0, 0}), wall(1.0, {0, 0, 255})};
    if (near_first) std::swap(shapes[0], shapes[1]);
    Canvas canvas(320, 240);
    const SpaceView view({1.0, 0.0, 0.3}, cube(), kCorner, kSize);
    draw_shapes(shapes, view, &canvas);
    const cv::Mat picture = cv::imread(canvas.save(folder / "walls.png").string());
    const Eigen::Vector2d middle = view({1.0, 0.0, 0.5});
    EXPECT_EQ(picture.at<cv::Vec3b>(static_cast<int>(middle.y()), static_cast<int>(middle.x())), cv::Vec3b(255, 0, 0));
  }
}

struct RigPicture : testing::Test {
  RigPicture() {
    input.truth = make_truth(12);
    input.observations = make_observations(*input.truth, 0.02);
    input.results = {exact_result(*input.truth)};
  }
  EstimatedTransform& estimate(std::size_t camera) { return input.results[0].camera_to_robot[camera]; }
  void displace(std::size_t camera, const Vector6d& error) {
    estimate(camera).T_parent_child = apply_transform_error(estimate(camera).T_parent_child, error);
  }
  InspectInput input;
};

TEST_F(RigPicture, SmallErrorsAreDrawnTooLargeByARoundFactor) {
  EXPECT_EQ(exaggeration(mounted_rig(input)), 1.0) << "no error, no sigma";
  displace(0, (Vector6d() << 0.001, 0.0, 0.0, 0.0, 0.0, 0.0005).finished());
  const MountedRig rig = mounted_rig(input);
  EXPECT_EQ(exaggeration(rig), 50.0);
  const Vector6d drawn = transform_error(exaggerated(rig.cameras[0], 50.0), input.truth->cameras[0].T_robot_camera);
  EXPECT_LT((drawn - (Vector6d() << 0.05, 0.0, 0.0, 0.0, 0.0, 0.025).finished()).norm(), 1e-9);
  EXPECT_FALSE(is_striking(rig.cameras[0], frustum_length(rig)));
}

TEST_F(RigPicture, WithoutTruthTheSigmasTellHowMuch) {
  input.truth.reset();
  estimate(1).covariance = Matrix6d(1e-6 * Matrix6d::Identity());
  const MountedRig rig = mounted_rig(input);
  EXPECT_EQ(exaggeration(rig), 20.0) << "two sigma are 2 mm; 81 mm can be seen";
  EXPECT_EQ(exaggerated(rig.cameras[1], 20.0).translation, estimate(1).T_parent_child.translation);
}

TEST_F(RigPicture, AGrossErrorIsDrawnAsItIs) {
  estimate(0).T_parent_child = looking({0.31, -0.24, 0.62}, -25.0, 12.0);  // mounted mirrored
  const MountedRig rig = mounted_rig(input);
  EXPECT_EQ(exaggeration(rig), 1.0);
  EXPECT_TRUE(is_striking(rig.cameras[0], frustum_length(rig)));
  EXPECT_FALSE(is_striking(rig.cameras[1], frustum_length(rig)));
}

TEST_F(RigPicture, TheRoofIsOnTheUpperSideOfTheImage) {
  const Camera camera = Camera::symmetric(640, 360, 320.0);
  for (const double roll_deg : {0.0, 180.0}) {
    const Frustum frustum = frustum_of(camera, looking({0.3, 0.0, 1.0}, 30.0, 0.0, roll_deg), 0.3);
    ASSERT_EQ(frustum.mouth.size(), 4U);
    const double roof = frustum.roof[1].z() - 1.0, lower_side = frustum.mouth[2].z() - 1.0;
    EXPECT_GT(roll_deg > 0.0 ? -roof : roof, 0.2);
    EXPECT_LT(roll_deg > 0.0 ? -lower_side : lower_side, -0.1);
  }
}

TEST(RigWords, TellHowACameraLooks) {
  const Eigen::Vector3d place(0.3, 0.0, 0.6);
  EXPECT_EQ(looks(looking(place, 25.0, 12.0)), "looks 25 deg left, 12 deg down");
  EXPECT_EQ(looks(looking(place, -90.0, -7.0, 180.0)), "looks 90 deg right, 7 deg up");
  EXPECT_EQ(looks(looking(place, 0.2, 0.0)), "looks ahead, level");
  EXPECT_EQ(looks(looking(place, 179.9, 20.0)), "looks back, 20 deg down");
  EXPECT_EQ(looks(looking(place, 0.0, 90.0)), "looks straight down");
  EXPECT_EQ(unusual_roll(looking(place, 25.0, 12.0, 3.0)), "");
  EXPECT_EQ(unusual_roll(looking(place, 25.0, 12.0, -90.0)), "on its side");
  EXPECT_EQ(unusual_roll(looking(place, 25.0, 12.0, 178.0)), "upside down");
  EXPECT_EQ(unusual_roll(looking(place, 25.0, 88.0, 178.0)), "") << "nobody can tell";
}

TEST_F(RigPicture, DrawsTheNearestBoardWhereItStands) {
  const RigShapes shapes = rig_shapes(input, mounted_rig(input), 1.0);
  ASSERT_TRUE(shapes.stop);
  const Rigid3 T_robot_board =
      input.truth->stops[static_cast<std::size_t>(*shapes.stop)].T_world_robot.inverse() * input.truth->T_world_board;
  const Eigen::Vector3d corner = T_robot_board * input.truth->board.outline()[2];
  const std::vector<Eigen::Vector3d> points = shapes.seen();
  EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](const auto& p) { return (p - corner).norm() < 1e-9; }));
  input.truth->T_world_board.translation.x() = 40.0;
  EXPECT_FALSE(rig_shapes(input, mounted_rig(input), 1.0).stop) << "too far to be drawn";
}

TEST_F(RigPicture, DrawsWhatMlSaysElseTheFirstResultWithAPose) {
  Result refused = input.results[0], ml = input.results[0];
  refused.method = "li";
  refused.camera_to_robot.clear();
  ml.method = "ml";
  input.results = {refused, input.results[0], ml};
  EXPECT_EQ(mounted_rig(input).method, "ml");
  input.results.pop_back();
  EXPECT_EQ(mounted_rig(input).method, "synthetic");
}

TEST_F(RigPicture, ACameraWithoutAPoseIsNamedOnly) {
  input.truth.reset();
  estimate(0).observable[2] = false;
  const MountedRig rig = mounted_rig(input);
  EXPECT_FALSE(rig.cameras[0].is_known());
  EXPECT_TRUE(rig.cameras[1].is_known());
  const TempFolder folder;
  EXPECT_TRUE(draw_rig_in_space(input, folder.path()));
  input.results.clear();
  EXPECT_FALSE(draw_rig_in_space(input, folder.path()));
}

}  // namespace
}  // namespace rigproof
