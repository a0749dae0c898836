// Geometric mode: observations drawn from a noise model without rendering, thousands of runs a minute.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/rig.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

/// Cameras, where they truly sit, and the board in front of them.
struct GeometricRig {
  std::vector<RigCamera> cameras;
  std::vector<Rigid3> T_robot_camera;
  Board board;
  std::vector<Eigen::Vector3d> print_errors_m;  ///< of each corner, true minus stated [board frame]; empty: none
  double board_centre_height_m = 0.55;
  double board_spin_rad = 0.0;         ///< of the board about its own normal
  double board_inclination_rad = 0.0;  ///< of its normal to the horizontal
  int min_cameras_per_stop = 1;        ///< cameras that see the whole board from every stop
  double min_distance_m = 1.0;         ///< of the camera that is aimed at the board
  double max_distance_m = 3.0;
  double max_bearing_rad = 0.9;    ///< of that camera about the board's normal
  double max_aim_error_rad = 0.5;  ///< between its axis and the board's centre
};

/// The reference scene of the accuracy goals: three cameras (fx 640, 1280x720) that see the same board of 4x3 inner
/// corners of 10 cm from every stop.
GeometricRig reference_rig();
/// A rig of `cameras` cameras mounted in any direction (backwards, sideways, upside down, pitched up to 40 degrees)
/// and a board in any orientation that faces them. Every stop is seen by one camera at least, by turns.
GeometricRig random_rig(std::uint64_t seed, int cameras);

/// How the robot moves between stops.
enum class GeometricDrive {
  kRandom,       ///< independent poses, on average about 1.65 m and 24 degrees apart
  kSteps,        ///< steps of about 0.3 m and 8 degrees
  kStraight,     ///< degenerate: along one straight line
  kTurnInPlace,  ///< degenerate: about the robot's own origin
  kArc,          ///< degenerate: about one other centre
  kStandstill,   ///< degenerate: not at all
};

/// Noise of one camera.
struct GeometricNoise {
  double corner_sigma_px = 0.0;
  /// Of 1/z at one effective point of a plane; absent: such planes are not seen.
  std::optional<double> ground_sigma_per_m, board_sigma_per_m;
  /// Effective points in a frame; 0: one a pixel that shows the plane.
  double ground_points = 0.0, board_points = 0.0;
};

struct GeometricConfig {
  std::uint64_t seed = 0;
  GeometricRig rig = reference_rig();
  GeometricDrive drive = GeometricDrive::kRandom;
  int stops = 100;
  double corner_sigma_px = 0.1;
  bool ground = true;         ///< ground planes in every depth camera that sees enough of it
  bool board_planes = false;  ///< depth on the board itself
  double inverse_depth_sigma_per_m = 0.0025;
  double ground_points = 300.0;  ///< effective ones in a frame
  double board_points = 60.0;
  double depth_scale_sigma = 0.0;  ///< of each camera's true depth scale about 1
  /// One a camera, in place of corner_sigma_px, ground, board_planes and what they come with. Empty: those.
  std::vector<GeometricNoise> measured;
  /// True scales, one a camera, and each rig camera declares its own scale_sigma; empty: drawn, and what is true is
  /// declared.
  std::vector<double> depth_scales;
  OdometryModel odometry_model = OdometryModel::kPerIncrement;
  /// Multiple of the noise of the paper: 0.2 cm on x and y, 0.01 rad on yaw.
  double lambda = 1.0;
  /// Increments only: the robot turns, drives straight on or back, and turns; stops know the way. Noise is a random
  /// walk along it: 0.2 cm after one metre and 0.01 rad after a turn of one radian, times lambda; scale and yaw factor
  /// act on all of the way.
  bool along_way = false;
  double metre_as_turn_rad = 0.1;        ///< along the way, a metre loses as much heading as this turn
  double odometry_scale = 1.0;           ///< measured = scale * true translation (increments only)
  double odometry_yaw_factor = 1.0;      ///< measured = factor * true rotation (increments only)
  double odometry_veer_rad_per_m = 0.0;  ///< measured heading gains on the true one with each metre (along the way)
  bool declare_odometry_model = true;
  bool declare_odometry_sigmas = true;
  double suspension_height_sigma_m = 0.0;
  double suspension_tilt_sigma_rad = 0.0;
  double corner_outlier_fraction = 0.0;    ///< corners off by up to tens of pixels
  double odometry_outlier_fraction = 0.0;  ///< poses or increments off by decimetres and degrees
  double plane_outlier_fraction = 0.0;     ///< planes of something else than the ground
};

struct GeometricRun {
  Observations observations;
  Truth truth;
};

/// What a depth image of a plane {p : a . p = 1} (camera coordinates) holds. The covariance of a is the variance of 1/z
/// times the inverse of the moments and of the number of effective points.
struct RayMoments {
  Eigen::Matrix3d mean;  ///< of r r^T over the rays r (z = 1) that meet the plane
  double pixels = 0.0;   ///< that show it
};
/// Absent where too little of the ground is in sight.
std::optional<RayMoments> ground_ray_moments(const Camera& camera, const Eigen::Vector3d& a);
/// Of a board that is wholly in sight.
RayMoments board_ray_moments(const Camera& camera, const Board& board, const Rigid3& T_camera_board);

/// Noise of the odometry at the given multiple of the paper's level.
OdometryNoise paper_odometry_noise(OdometryModel model, double lambda);

/// A board beside the rig's.
struct GeometricBoard {
  Board board;
  Rigid3 T_world_board;
  std::vector<Eigen::Vector3d> print_errors_m;  ///< as GeometricRig's
};

/// True poses of the robot in the world (the first one's x, y and yaw are zero), and the board in it.
struct GeometricScene {
  Rigid3 T_world_board;
  std::vector<Rigid3> T_world_robot;
  /// Where a camera sees more than one whole board, the one with most corners counts.
  std::vector<GeometricBoard> more_boards = {};
};
/// Throws Error where the rig cannot see the board as asked.
GeometricScene draw_scene(const GeometricConfig& config);

/// The whole run; depends on the configuration alone.
GeometricRun draw_geometric_run(const GeometricConfig& config);
/// The same at given true poses, in place of those that the configuration would draw: the noise of a stop depends on
/// the seed and its number alone.
GeometricRun draw_geometric_run(const GeometricConfig& config, const GeometricScene& scene);

}  // namespace rigproof
