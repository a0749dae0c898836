// The factors of the problem, a file each under factors/: residuals that share a loss, whitened, with their part of the
// normal equations. A factor knows where its unknowns stand, and nothing of what its blocks are summed up for.
#pragma once

#include "local_block.h"
#include "rigproof/calib/estimate/clock.h"
#include "rigproof/calib/estimate/noise.h"
#include "rigproof/calib/estimate/odometry_way.h"
#include "rigproof/calib/estimate/problem.h"

namespace rigproof::ml {

/// Where residuals are evaluated, and how.
struct Evaluation {
  const Observations& observations;
  const std::vector<Lenses>& lenses;
  const Layout& layout;
  const NoiseLevels& noise;
  const CauchyLoss& loss;
  const State& state;
  Weighting weighting;

  const RobotPose& pose(int stop) const { return state.poses[static_cast<std::size_t>(stop)]; }
  const Stop& stop(int index) const { return observations.stops[static_cast<std::size_t>(index)]; }
  /// Poses at a stop, and where they stand among the unknowns: a step changes them.
  const Rigid3& T_robot_camera(int camera, int stop) const { return pose_of(camera, stop); }
  Segment camera_unknowns(int camera, int stop) const { return unknowns_of(camera, stop); }
  const Rigid3& T_world_board(int board, int stop) const { return pose_of(Step::board(board), stop); }
  Segment board_unknowns(int board, int stop) const { return unknowns_of(Step::board(board), stop); }

 private:
  const Rigid3& pose_of(int body, int stop) const {
    const int second = layout.second_of(body, stop);
    return second < 0 ? state.first_pose(body) : state.second_poses[static_cast<std::size_t>(second)];
  }
  Segment unknowns_of(int body, int stop) const {
    const int second = layout.second_of(body, stop);
    return of_globals(second < 0 ? layout.body(body) : layout.second(second), 6);
  }
};

/// By what a block's squares count, of residuals of so many dimensions with this weight by the loss.
double block_factor(Weighting weighting, double weight, int dimensions);
/// A camera by the intrinsics of the state.
Camera lens_at(const Evaluation& at, int camera);
/// Relative error of a camera's depth: its own, and what cameras of its make share.
double depth_error(const Evaluation& at, int camera);
/// A plane as its depth image shows it through the intrinsics of the state and without the error of its depth camera's
/// place, and its derivatives by both.
struct MeasuredPlane {
  Eigen::Vector3d value;
  Eigen::Matrix<double, 3, 5> by_lens = Eigen::Matrix<double, 3, 5>::Zero();
  Eigen::Matrix3d by_offset = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 6> by_shape = Eigen::Matrix<double, 3, 6>::Zero();
};
MeasuredPlane measured_plane(const Evaluation& at, const WhitenedPlane& plane);

void corners(const Evaluation& at, const WhitenedView& view, BlockSink* sink);
void board_plane(const Evaluation& at, const WhitenedPlane& plane, BlockSink* sink);
void ground_plane(const Evaluation& at, const WhitenedPlane& plane, BlockSink* sink);
/// Odometry from the stop before `to` to that stop: as one motion, or along the way.
void odometry_increment(const Evaluation& at, int to, const VeeringIncrement& measured, BlockSink* sink);
void odometry_along_way(const Evaluation& at, int to, const OdometryWay& way, BlockSink* sink);
void odometry_pose(const Evaluation& at, int stop, BlockSink* sink);
void suspension(const Evaluation& at, int stop, BlockSink* sink);

/// Standard deviations of odometry that is not along the way, of x, y and yaw.
Eigen::Vector3d odometry_sigmas(const Observations& observations, const NoiseLevels& noise, int stop);

ViewFit view_fit(const Evaluation& at, const WhitenedView& view);
/// @param block its information on the unknowns, by the twist alone
ViewPull view_pull(const Evaluation& at, const WhitenedView& view, LocalBlock* block);

/// Three residuals that share a loss between two groups; few stops have none to spare, so that they count by the loss
/// even in steps from afar.
/// @param block with its unknowns @param rows and their whitened derivatives
/// @param share_of_second what the second group's noise is of the whitened residuals' variance; the rest is the first's
void add_shared(const Evaluation& at, const std::array<Group, 2>& groups, const Eigen::Matrix3d& share_of_second,
                const Eigen::Vector3d& r, const BlockRows& rows, LocalBlock* block, BlockSink* sink);

}  // namespace rigproof::ml
