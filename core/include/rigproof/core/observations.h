// What calibration sees: corners, planes and odometry at each stop of the robot. On disk: observations.json.
// Kilobytes; may replace the images.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/finding.h"
#include "rigproof/core/rig.h"

namespace rigproof {

/// One detected inner corner.
struct CornerObservation {
  int id = 0;                                                    ///< Board's corner id
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();               ///< distorted image coordinates
  Eigen::Matrix2d covariance_px2 = Eigen::Matrix2d::Identity();  ///< of the detector's fit
};

/// The board as one camera sees it from one stop.
struct BoardView {
  int stop = 0;    ///< index into Observations::stops
  int camera = 0;  ///< index into Observations::cameras
  double stamp_s = 0.0;
  std::string file;  ///< image it came from, for messages
  std::vector<CornerObservation> corners;
  int board = 0;  ///< which of the boards: 0 is Observations::board, then Observations::more_boards
};

/// A plane seen by the depth sensor, as 1/z = a . (x/z, y/z, 1): the plane is {p : a . p = 1} in camera coordinates.
/// For the ground at height h below the camera with unit normal n towards the camera, a = -n / h.
struct PlaneObservation {
  int stop = 0;
  int camera = 0;
  std::string file;
  Eigen::Vector3d inverse_depth_plane = Eigen::Vector3d::Zero();    ///< a [1/m], colour camera's frame
  Eigen::Matrix3d covariance_per_m2 = Eigen::Matrix3d::Identity();  ///< of a, with the effective number of points
  double effective_points = 0.0;
  int inlier_points = 0;
  double residual_rms = 0.0;  ///< of the inliers, in units of the sensor's sigma
};

/// One place where the robot took images, with the odometry there.
struct Stop {
  double stamp_s = 0.0;
  double x_m = 0.0;  ///< odometry: T_odom_robot projected to the ground, of the robot's origin wherever it turns
  double y_m = 0.0;
  double yaw_rad = 0.0;
  /// Standard deviation of the interpolation between odometry samples; 0 where a sample was met.
  double interpolation_sigma_m = 0.0;
  /// Odometry poses (x [m], y [m], yaw [rad]) between the stop before and this one, in the order of driving, thinned so
  /// that arcs of constant twist between them meet what was left out; empty where odometry has no rows in between.
  std::vector<Eigen::Vector3d> way = {};
  /// Velocity by the odometry, in the robot's frame [m/s, m/s, rad/s]; zero where the robot stands, and where the rows
  /// of odometry are too far apart to tell.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  /// How that changes [m/s^2, m/s^2, rad/s^2]: the twist a time dt later is velocity + dt * acceleration. Zero where
  /// too few rows of odometry lie around the stop to tell.
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
};

/// A frame that calibration does not use, and why.
struct Exclusion {
  int camera = 0;
  int stop = -1;  ///< -1: belongs to no stop
  std::string file;
  Finding why;         ///< board.cut_off, view.residual, ..
  bool depth = false;  ///< only the depth of the frame is left out, its image is not
};

struct Observations {
  std::string source;  ///< where it came from, for people
  std::string robot_frame = "base_footprint";
  Board board;
  std::vector<RigCamera> cameras;
  OdometryNoise odometry_noise;
  std::optional<AcceptLimits> accept;
  std::vector<Stop> stops;                      ///< in the order of driving
  std::vector<BoardView> board_views;           ///< sorted by (stop, camera)
  std::vector<PlaneObservation> ground_planes;  ///< sorted by (stop, camera)
  std::vector<PlaneObservation> board_planes;   ///< depth on the board itself: calibrates the depth scale
  std::vector<Exclusion> exclusions;
  std::vector<Board> more_boards = {};  ///< that stand elsewhere; of an image one board at most counts

  int boards() const { return 1 + static_cast<int>(more_boards.size()); }
  const Board& board_at(int index) const {
    return index == 0 ? board : more_boards[static_cast<std::size_t>(index) - 1];
  }
  const Board& board_of(const BoardView& view) const { return board_at(view.board); }
};

/// Reads observations.json. Throws Error with every problem found.
Observations load_observations(const std::filesystem::path& file);
/// Writes observations.json atomically; reading it back gives the same bytes again.
void save_observations(const Observations& observations, const std::filesystem::path& file);

}  // namespace rigproof
