// What only a simulator knows. On disk: truth/truth.yaml. The calibration core neither includes nor links this.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/camera.h"
#include "rigproof/core/lens_residual.h"
#include "rigproof/core/rig.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Where the robot was when a camera took an image: in the middle of the exposure of the image's middle row.
struct TrueStop {
  double stamp_s = 0.0;
  Rigid3 T_world_robot;  ///< all six degrees of freedom
  /// Of a robot that moves: its velocity (linear [m/s], angular [rad/s]) in its own frame. T_world_robot at dt later is
  /// T_world_robot * se3_exp(dt * velocity).
  std::optional<Vector6d> velocity = std::nullopt;

  Rigid3 T_world_robot_after(double dt_s) const {
    return velocity ? T_world_robot * se3_exp(dt_s * *velocity) : T_world_robot;
  }
};

struct TrueCamera {
  std::string name;
  Rigid3 T_robot_camera;
  Camera camera;                      ///< true intrinsics; the recording may tell others
  std::optional<double> depth_scale;  ///< measured = scale * true, absent without depth
  /// What else is simulated of this camera's sensor, by name with unit; 1 for a switch that is on. Nothing that is off
  /// is listed. On disk: block `sensing`.
  std::map<std::string, double> sensing;
  /// Of a depth camera that is not registered to colour; the recording may tell another one.
  std::optional<DepthStream::OwnCamera> depth_camera = std::nullopt;
  /// Of a camera that takes its images while the robot moves, and not when the others do: for each of the truth's stops
  /// its own one, as far as the drive goes. Empty = the truth's stops. See Truth::stops_of().
  std::vector<TrueStop> stops = {};
  /// What the lens does beyond its intrinsics.
  std::optional<LensResidual> lens_residual = std::nullopt;

  /// Where the colour camera sees a point, and along which ray it sees a pixel: intrinsics and lens field.
  bool project(const Eigen::Vector3d& p_camera, Eigen::Vector2d* pixel) const {
    return rigproof::project(camera, lens_residual, p_camera, pixel);
  }
  bool unproject(const Eigen::Vector2d& pixel, Eigen::Vector3d* ray) const {
    return rigproof::unproject(camera, lens_residual, pixel, ray);
  }
};

/// A shutter that reads rows one after the other: when row v of `height` is exposed, against the middle row.
inline double row_delay_s(double row, int height, double readout_s) { return readout_s * ((row + 0.5) / height - 0.5); }

struct TrueBoard {
  Board board;  ///< as it is told
  /// Where its corners truly are, by id [board frame]; empty = where `board` says.
  std::vector<Eigen::Vector3d> printed_corners = {};
  Rigid3 T_world_board;

  /// A corner as it is printed and bent [board frame].
  Eigen::Vector3d corner(int id) const {
    return printed_corners.empty() ? board.corner(id) : printed_corners[static_cast<std::size_t>(id)];
  }
};

/// Its own members of a board are those of the first one.
struct Truth : TrueBoard {
  std::string scene;
  std::uint64_t seed = 0;
  std::vector<TrueBoard> more_boards;
  /// Of a robot on unequal wheels or under a load: how the frame in which the rig's file mounts cameras, which is level
  /// on the robot's model, stands in the robot frame, which lies in the ground.
  std::optional<Rigid3> T_robot_chassis = std::nullopt;
  std::vector<TrueCamera> cameras;
  std::vector<TrueStop> stops;
  OdometryNoise odometry_noise;  ///< with the sigmas that were drawn from
  double odometry_scale = 1.0;
  double odometry_yaw_factor = 1.0;
  /// What was drawn once for the run, by the field of its configuration: "drive.payload_kg", "board.bow_mm", ...
  std::map<std::string, double> drawn;

  int boards() const { return 1 + static_cast<int>(more_boards.size()); }
  /// Throws std::out_of_range where there is none of that number.
  const TrueBoard& board_at(int index) const {
    return index == 0 ? static_cast<const TrueBoard&>(*this) : more_boards.at(static_cast<std::size_t>(index) - 1);
  }
  /// Where a camera sees a corner of a board in an image of a stop, when it reads the row at which the corner was
  /// found. Returns false where it does not.
  bool project_corner(std::size_t camera, const TrueStop& stop, const TrueBoard& seen, int id, double row,
                      Eigen::Vector2d* pixel) const;
  /// When a camera took its images and where the robot was: those of its own, or the stops that all cameras share.
  const std::vector<TrueStop>& stops_of(std::size_t camera) const {
    return cameras[camera].stops.empty() ? stops : cameras[camera].stops;
  }
};

Truth load_truth(const std::filesystem::path& file);
void save_truth(const Truth& truth, const std::filesystem::path& file);

}  // namespace rigproof
