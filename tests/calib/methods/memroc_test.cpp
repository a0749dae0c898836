#include "rigproof/calib/methods/memroc.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "error_text.h"
#include "pose_near.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/methods/registry.h"
#include "synthetic_drive.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

using testing::HasSubstr;
using testing::Not;

Result solve(const SyntheticDrive& drive, bool joint) {
  return solve_memroc(drive.observations, {drive.views, {}}, {joint});
}

std::string text(const std::vector<Finding>& findings) {
  std::string all;
  for (const std::string& sentence : worded(findings)) all += sentence + "\n";
  return all;
}

Rigid3 true_pair(const SyntheticDrive& drive, const EstimatedTransform& pair) {
  const std::size_t j = static_cast<std::size_t>(pair.parent.back() - '0');
  const std::size_t k = static_cast<std::size_t>(pair.child.back() - '0');
  return drive.T_robot_camera[j].inverse() * drive.T_robot_camera[k];
}

std::uint64_t seeds(int few, int all) { return static_cast<std::uint64_t>(Trials(few, all).count()); }

class BothMemrocs : public testing::TestWithParam<bool> {};

TEST_P(BothMemrocs, RecoverExactGeometryForAnyMountingOverTrials) {
  for (std::uint64_t seed = 0; seed < seeds(15, 60); ++seed) {
    SCOPED_TRACE(seed);
    DriveOptions options = any_mounting(seed, 4);
    options.plane_sigma_per_m = 0.0;
    const SyntheticDrive drive = make_drive(options);
    const Result result = solve(drive, GetParam());
    ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
    for (std::size_t k = 0; k < drive.T_robot_camera.size(); ++k)
      EXPECT_TRUE(IsPoseNear(drive.T_robot_camera[k], result.camera_to_robot[k].T_parent_child, 1e-8, 1e-8));
    for (const EstimatedTransform& pair : result.camera_to_camera) EXPECT_TRUE(pair.fully_observable());
  }
}

DriveOptions noisy(std::uint64_t seed, int stops) {
  DriveOptions options;
  options.seed = seed;
  options.stops = stops;
  options.corner_sigma_px = 0.1;
  options.odometry_sigma_m = 0.002;
  options.odometry_sigma_rad = 0.01;
  return options;
}

// Mean absolute errors over runs of 100 poses without sensor noise and with exact odometry; corners of a good detector.
TEST_P(BothMemrocs, BeatThePublishedRowOnEveryAxis) {
  const double cm = 0.01, deg = deg_to_rad(1.0);
  Vector6d published_robot, published_pair;
  if (GetParam()) {
    published_robot << 0.66 * cm, 0.16 * cm, 0.14 * cm, 0.14 * deg, 0.14 * deg, 0.15 * deg;
    published_pair << 0.20 * cm, 0.25 * cm, 0.78 * cm, 0.22 * deg, 0.23 * deg, 0.14 * deg;
  } else {
    published_robot << 0.61 * cm, 0.25 * cm, 0.15 * cm, 0.08 * deg, 0.13 * deg, 0.16 * deg;
    published_pair << 0.42 * cm, 0.23 * cm, 0.87 * cm, 0.11 * deg, 0.18 * deg, 0.15 * deg;
  }
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    DriveOptions options;
    options.seed = seed;
    options.stops = 100;
    options.corner_sigma_px = 0.01;
    const SyntheticDrive drive = make_drive(options);
    const Result result = solve(drive, GetParam());
    ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector6d error =
          transform_error(result.camera_to_robot[k].T_parent_child, drive.T_robot_camera[k]).cwiseAbs();
      for (int axis = 0; axis < 6; ++axis) EXPECT_LT(error(axis), published_robot(axis)) << "axis " << axis;
    }
    for (const EstimatedTransform& pair : result.camera_to_camera) {
      const Vector6d error = transform_error(pair.T_parent_child, true_pair(drive, pair)).cwiseAbs();
      for (int axis = 0; axis < 6; ++axis) EXPECT_LT(error(axis), published_pair(axis)) << "axis " << axis;
    }
  }
}

// Sums of (error / sigma)^2 over the axes that are answered.
struct Honesty {
  Vector6d squares = Vector6d::Zero(), counts = Vector6d::Zero();
  double worst = 0.0;

  void add(const EstimatedTransform& estimate, const Rigid3& truth) {
    const Vector6d error = transform_error(estimate.T_parent_child, truth);
    for (int axis = 0; axis < 6; ++axis) {
      if (!estimate.observable[static_cast<std::size_t>(axis)]) continue;
      const double z = std::abs(error(axis)) / std::sqrt((*estimate.covariance)(axis, axis));
      squares(axis) += z * z;
      counts(axis) += 1.0;
      worst = std::max(worst, z);
    }
  }
  void expect_honest(const Trials& drives) const {
    // Mean z squared of 60 drives whose three cameras share the odometry: 1 +- 0.2; three of those, and as much
    // again for the odometry's sigma, which is estimated.
    for (int axis = 0; axis < 6; ++axis) {
      EXPECT_GT(squares(axis) / counts(axis), 1.0 / (1.0 + drives.tolerance(1.5))) << "axis " << axis;
      EXPECT_LT(squares(axis) / counts(axis), 1.0 + drives.tolerance(1.0)) << "axis " << axis;
    }
    // The largest of 1,080 is about 3.5.
    EXPECT_LT(worst, 5.5);
  }
};

TEST_P(BothMemrocs, StateHonestUncertaintyOverTrials) {
  Honesty cameras, pairs;
  const Trials drives(20, 60);
  for (int seed = 0; seed < drives.count(); ++seed) {
    const SyntheticDrive drive = make_drive(noisy(static_cast<std::uint64_t>(seed), 40));
    const Result result = solve(drive, GetParam());
    ASSERT_EQ(result.camera_to_robot.size(), 3u) << text(result.reasons);
    for (std::size_t k = 0; k < 3; ++k) cameras.add(result.camera_to_robot[k], drive.T_robot_camera[k]);
    for (const EstimatedTransform& pair : result.camera_to_camera) pairs.add(pair, true_pair(drive, pair));
  }
  cameras.expect_honest(drives);
  pairs.expect_honest(drives);
}

TEST_P(BothMemrocs, NeverRefuseAHealthyDriveOverTrials) {
  for (std::uint64_t seed = 0; seed < seeds(60, 300); ++seed) {
    SCOPED_TRACE(seed);
    DriveOptions options = noisy(seed, 5 + static_cast<int>(seed % 20));
    options.cameras = 1;
    const SyntheticDrive drive = make_drive(options);
    const Result result = solve(drive, GetParam());
    // The motion is never blamed; five stops at this noise may still be too uncertain, which is said as such.
    EXPECT_THAT(text(result.reasons), Not(HasSubstr("unobservable")));
    ASSERT_FALSE(result.camera_to_robot.empty());
  }
}

struct Degenerate {
  DriveKind kind;
  const char* words;
  bool yaw;  // still known
};

// What is given states its uncertainty, what is not has none. 5 sigma: some 5,000 numbers are drawn.
void expect_honest(const EstimatedTransform& estimate, const Rigid3& truth) {
  ASSERT_TRUE(estimate.covariance.has_value());
  const Matrix6d& covariance = *estimate.covariance;
  for (Eigen::Index i = 0; i < 6; ++i)
    EXPECT_EQ(covariance(i, i) > 0.0, estimate.observable[static_cast<std::size_t>(i)]) << "axis " << i;
  EXPECT_LT(std::abs(estimate.T_parent_child.translation.z() - truth.translation.z()),
            5.0 * std::sqrt(covariance(2, 2)));
  const Eigen::Vector3d up = estimate.T_parent_child.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d true_up = truth.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_LT((up - true_up).norm(), 5.0 * std::sqrt(covariance(3, 3) + covariance(4, 4)));
  if (!estimate.observable[5]) return;
  EXPECT_LT(std::abs(transform_error(estimate.T_parent_child, truth)(5)), 5.0 * std::sqrt(covariance(5, 5)));
}

TEST_P(BothMemrocs, RefuseDegenerateDrivesInWordsOverTrials) {
  const Degenerate kinds[] = {
      {DriveKind::kStraight, "x, y unobservable: the robot drove straight", true},
      {DriveKind::kInPlace, "x, y, yaw unobservable: the robot only turned in place", false},
      {DriveKind::kArc, "x, y, yaw unobservable: all motions turn about one centre, (-0.02, 1.79) m in robot", false},
      {DriveKind::kStandstill, "x, y, yaw unobservable: the robot stood still", false},
  };
  for (const Degenerate& degenerate : kinds) {
    for (std::uint64_t seed = 0; seed < seeds(20, 100); ++seed) {
      SCOPED_TRACE(std::string(degenerate.words) + ", seed " + std::to_string(seed));
      DriveOptions options;
      options.seed = seed;
      options.kind = degenerate.kind;
      options.stops = 8 + static_cast<int>(seed % 20);
      options.corner_sigma_px = seed % 2 == 0 ? 0.1 : 0.005;
      options.cameras = 2;
      const SyntheticDrive drive = make_drive(options);
      const Result result = solve(drive, GetParam());
      EXPECT_EQ(result.status, ResultStatus::kPartial);
      EXPECT_THAT(text(result.reasons), HasSubstr(degenerate.words));
      for (const EstimatedTransform& estimate : result.camera_to_robot) {
        const std::size_t k = static_cast<std::size_t>(estimate.child.back() - '0');
        EXPECT_FALSE(estimate.observable[0] || estimate.observable[1]);
        EXPECT_EQ(estimate.observable[5], degenerate.yaw);
        EXPECT_TRUE(estimate.observable[2] && estimate.observable[3] && estimate.observable[4]);
        // What is given is right: the height, and the vertical in the camera (0.1 px of a distant board: 0.3 deg).
        EXPECT_NEAR(estimate.T_parent_child.translation.z(), drive.T_robot_camera[k].translation.z(), 1e-3);
        const Eigen::Vector3d up = estimate.T_parent_child.rotation.conjugate() * Eigen::Vector3d::UnitZ();
        const Eigen::Vector3d true_up = drive.T_robot_camera[k].rotation.conjugate() * Eigen::Vector3d::UnitZ();
        EXPECT_LT((up - true_up).norm(), deg_to_rad(0.3));
        expect_honest(estimate, drive.T_robot_camera[k]);
      }
      // Camera to camera needs no motion where both saw the board.
      for (const EstimatedTransform& pair : result.camera_to_camera) {
        const Vector6d error = transform_error(pair.T_parent_child, true_pair(drive, pair));
        // Eight views of one place leave a fraction of a degree at 0.1 px; the method has to say so. 5 sigma: 4,800
        // axes are drawn.
        EXPECT_LT(error.cwiseQuotient(pair.covariance->diagonal().cwiseSqrt()).cwiseAbs().maxCoeff(), 5.0);
      }
      if (HasFailure()) return;
    }
  }
}

TEST_P(BothMemrocs, RefuseTooFewPoses) {
  for (int stops = 1; stops <= 2; ++stops) {
    const SyntheticDrive drive = make_drive(noisy(1, stops));
    const Result result = solve(drive, GetParam());
    EXPECT_NE(result.status, ResultStatus::kSolved);
    EXPECT_THAT(text(result.reasons), HasSubstr("at least 3 are needed"));
    for (const EstimatedTransform& estimate : result.camera_to_robot) EXPECT_FALSE(estimate.observable[0]);
  }
}

TEST_P(BothMemrocs, RefuseEmptyObservations) {
  EXPECT_EQ(solve_memroc(Observations(), ViewPoses(), {GetParam()}).status, ResultStatus::kRefused);
  SyntheticDrive drive = make_drive(noisy(1, 5));
  drive.observations.board_views.clear();
  drive.observations.ground_planes.clear();
  drive.views.clear();
  const Result result = solve(drive, GetParam());
  EXPECT_EQ(result.status, ResultStatus::kRefused);
  EXPECT_THAT(text(result.reasons), HasSubstr("the board is in none of its images"));
}

TEST_P(BothMemrocs, KeepTheHeightOpenWithoutGround) {
  DriveOptions options = noisy(4, 30);
  options.ground = false;
  const SyntheticDrive drive = make_drive(options);
  const Result result = solve(drive, GetParam());
  EXPECT_EQ(result.status, ResultStatus::kPartial);
  EXPECT_THAT(text(result.reasons), HasSubstr("no ground seen"));
  for (std::size_t k = 0; k < drive.T_robot_camera.size(); ++k) {
    const EstimatedTransform& estimate = result.camera_to_robot[k];
    EXPECT_FALSE(estimate.observable[2]);
    EXPECT_TRUE(estimate.observable[0] && estimate.observable[3] && estimate.observable[5]);
    const Vector6d error = transform_error(estimate.T_parent_child, drive.T_robot_camera[k]);
    EXPECT_LT(error.head<2>().norm(), 0.05);
    EXPECT_EQ(estimate.covariance->row(2).norm(), 0.0);
  }
}

TEST_P(BothMemrocs, SolveTheOthersWhenOneCameraNeverSawTheBoard) {
  SyntheticDrive drive = make_drive(noisy(5, 30));
  for (std::size_t i = 0; i < drive.views.size(); ++i)
    if (drive.views[i].camera == 1) drive.views.erase(drive.views.begin() + static_cast<std::ptrdiff_t>(i--));
  const Result result = solve(drive, GetParam());
  EXPECT_EQ(result.status, ResultStatus::kPartial);
  EXPECT_THAT(worded(result.reasons),
              testing::ElementsAre(HasSubstr("camera1: x, y, yaw unobservable: the board is in none")));
  ASSERT_NE(result.find("base_footprint", "camera0"), nullptr);
  EXPECT_TRUE(result.find("base_footprint", "camera0")->fully_observable());
  // Its ground planes still tell height and tilt.
  ASSERT_NE(result.find("base_footprint", "camera1"), nullptr);
  EXPECT_THAT(result.find("base_footprint", "camera1")->observable,
              testing::ElementsAre(false, false, true, true, true, false));
  EXPECT_EQ(result.use[1].used, 0);
}

TEST_P(BothMemrocs, LeaveOutFlippedBoardPosesOverTrials) {
  std::uint64_t known = 0;
  for (std::uint64_t seed = 0; seed < seeds(6, 20); ++seed) {
    SCOPED_TRACE(seed);
    SyntheticDrive drive = make_drive(noisy(seed, 40));
    const Result clean = solve(drive, GetParam());
    // IPPE's other solution: the board tilted the other way about its centre.
    for (const std::size_t i : {3u, 20u, 41u}) {
      Rigid3& T = drive.views[i].T_camera_board;
      const Eigen::Vector3d centre = T * Board().centre();
      T.rotation = so3_exp(Eigen::Vector3d(0.5, 0.3, 0.0)) * T.rotation;
      T.translation = centre - T.rotation * Board().centre();
    }
    const Result result = solve(drive, GetParam());
    std::size_t left_out = 0;
    for (const CameraUse& use : result.use) left_out += use.left_out.size();
    EXPECT_GE(left_out, 3u);
    for (std::size_t k = 0; k < 3; ++k) {
      // What is too uncertain to be stated has no sigma to compare with.
      if (!clean.camera_to_robot[k].fully_observable()) continue;
      ++known;
      const Vector6d shift =
          transform_error(result.camera_to_robot[k].T_parent_child, clean.camera_to_robot[k].T_parent_child);
      const Vector6d sigma = clean.camera_to_robot[k].covariance->diagonal().cwiseSqrt();
      // Less data and other neighbours, but no capture.
      EXPECT_LT(shift.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 3.0);
    }
  }
  EXPECT_GE(known, 2 * seeds(6, 20)) << "of three cameras a seed";
}

TEST_P(BothMemrocs, RejectWallsAndCeilingsAndTables) {
  SyntheticDrive drive = make_drive(noisy(6, 30));
  const Result clean = solve(drive, GetParam());
  std::vector<PlaneObservation>& planes = drive.observations.ground_planes;
  planes[2].inverse_depth_plane = Eigen::Vector3d(0.0, 0.0, 0.5);
  planes[9].inverse_depth_plane *= -1.0;
  planes[17].inverse_depth_plane *= 1.8;
  const Result result = solve(drive, GetParam());
  const std::string notes = text(result.notes);
  EXPECT_THAT(notes, HasSubstr("off the vertical of the motion"));
  EXPECT_THAT(notes, HasSubstr("ceiling"));
  EXPECT_THAT(notes, HasSubstr("above the one of the other frames"));
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(result.camera_to_robot[k].T_parent_child.translation.z(),
                clean.camera_to_robot[k].T_parent_child.translation.z(), 1e-4);
}

TEST_P(BothMemrocs, DoNotDependOnBoardFrameWorldFrameOrCameraOrder) {
  const SyntheticDrive drive = make_drive(noisy(7, 30));
  const Result reference = solve(drive, GetParam());
  SyntheticDrive moved = drive;
  const Rigid3 T_odom_old = planar_pose(3.0, -2.0, 1.2);
  for (Stop& stop : moved.observations.stops) {
    const Rigid3 pose = T_odom_old * planar_pose(stop.x_m, stop.y_m, stop.yaw_rad);
    stop.x_m = pose.translation.x();
    stop.y_m = pose.translation.y();
    stop.yaw_rad = yaw_of(pose);
  }
  // Another board frame: the rotation's noise is unchanged, the translation gets the lever.
  const Rigid3 T_old_new(so3_exp(Eigen::Vector3d(0.3, -0.8, 2.0)), Eigen::Vector3d(0.2, 0.1, -0.3));
  std::reverse(moved.observations.cameras.begin(), moved.observations.cameras.end());
  for (ViewPose& view : moved.views) {
    Matrix6d J = Matrix6d::Identity();
    J.topRightCorner<3, 3>() = -skew(view.T_camera_board.rotation * T_old_new.translation);
    view.covariance = J * view.covariance * J.transpose();
    view.T_camera_board = view.T_camera_board * T_old_new;
    view.camera = 2 - view.camera;
  }
  std::stable_sort(moved.views.begin(), moved.views.end(), [](const ViewPose& a, const ViewPose& b) {
    return std::make_pair(a.stop, a.camera) < std::make_pair(b.stop, b.camera);
  });
  for (PlaneObservation& plane : moved.observations.ground_planes) plane.camera = 2 - plane.camera;
  const Result result = solve(moved, GetParam());
  for (const EstimatedTransform& estimate : reference.camera_to_robot) {
    const EstimatedTransform* other = result.find(estimate.parent, estimate.child);
    ASSERT_NE(other, nullptr);
    EXPECT_TRUE(IsPoseNear(estimate.T_parent_child, other->T_parent_child, 1e-9, 1e-9));
    EXPECT_TRUE(estimate.covariance->isApprox(*other->covariance, 1e-5));
  }
}

TEST_P(BothMemrocs, GiveTheSameBytesTwice) {
  const SyntheticDrive drive = make_drive(noisy(8, 20));
  const Result first = solve(drive, GetParam()), second = solve(drive, GetParam());
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(first.camera_to_robot[k].T_parent_child.matrix(), second.camera_to_robot[k].T_parent_child.matrix());
    EXPECT_EQ(*first.camera_to_robot[k].covariance, *second.camera_to_robot[k].covariance);
  }
}

TEST(JointMemroc, SolvesFromCornersAlone) {
  DriveOptions options = noisy(9, 30);
  options.corner_sigma_px = 0.02;
  const SyntheticDrive drive = make_drive(options);
  const Result from_poses = solve(drive, true);
  const Result from_corners = find_method("joint_memroc").solve(drive.observations);
  ASSERT_EQ(from_corners.status, ResultStatus::kSolved) << text(from_corners.reasons);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector6d shift =
        transform_error(from_corners.camera_to_robot[k].T_parent_child, from_poses.camera_to_robot[k].T_parent_child);
    const Vector6d sigma = from_poses.camera_to_robot[k].covariance->diagonal().cwiseSqrt();
    // The generator's poses are PnP to first order; the second order is far below the noise.
    EXPECT_LT(shift.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 0.5);
  }
}

TEST(Registry, EveryMethodRefusesNothingInWords) {
  for (const Method* method : all_methods()) {
    const Result result = method->solve(Observations());
    EXPECT_EQ(result.status, ResultStatus::kRefused) << method->traits().name;
    EXPECT_FALSE(result.reasons.empty()) << method->traits().name;
  }
}

TEST(Registry, FindsMethodsAndNamesTheNearest) {
  EXPECT_EQ(find_method("memroc").traits().name, "memroc");
  EXPECT_EQ(default_method().traits().name, "ml");
  EXPECT_THAT(error_text([] { find_method("memrok"); }), HasSubstr("did you mean \"memroc\"?"));
}

INSTANTIATE_TEST_SUITE_P(Memroc, BothMemrocs, testing::Bool());

// The covariance of such a drive has entries of kilometres and roots of negative numbers.
TEST_P(BothMemrocs, FrozenOdometryIsRefusedInNumbersThatPeopleRead) {
  for (const double step_m : {1e-9, 1e-3, 1e12}) {
    SyntheticDrive drive = make_drive(noisy(3, 10));
    for (std::size_t i = 0; i < drive.observations.stops.size(); ++i) {
      Stop& stop = drive.observations.stops[i];
      stop.x_m = step_m * static_cast<double>(i);
      stop.y_m = stop.yaw_rad = 0.0;
    }
    testing::internal::CaptureStderr();
    const Result result = solve(drive, GetParam());
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "a library prints nothing";
    EXPECT_NE(result.status, ResultStatus::kSolved) << step_m;
    for (const Finding& reason : result.reasons)
      for (const FindingValue& value : reason.values)
        EXPECT_LE(std::abs(std::get<double>(value.value)), 1e4) << value.name;
    EXPECT_THAT(text(result.reasons), Not(HasSubstr("nan")));
  }
}

// Whatever a method answers: run_method() lets no number pass that is none.
class RanAway : public Method {
 public:
  MethodTraits traits() const override { return {"ran_away", "", "", "", MethodReads::kObservations}; }
  Result solve(const Observations& /*observations*/) const override {
    Result result;
    result.status = ResultStatus::kSolved;
    for (const double x : {0.3, 1e308, std::nan("")}) {
      Rigid3 T;
      T.translation.x() = x;
      result.camera_to_robot.push_back({"robot", "camera" + std::to_string(result.camera_to_robot.size()), T, {}});
    }
    return result;
  }
};

TEST(RunMethod, LeavesOutWhatIsNoNumber) {
  const Result result = run_method(RanAway(), {Observations()});
  EXPECT_EQ(result.status, ResultStatus::kPartial);
  ASSERT_EQ(result.camera_to_robot.size(), 1U);
  EXPECT_EQ(result.camera_to_robot[0].child, "camera0");
  EXPECT_THAT(text(result.reasons), testing::AllOf(HasSubstr("camera1"), HasSubstr("camera2")));
}

}  // namespace
}  // namespace rigproof
