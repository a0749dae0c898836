// A room with patterned walls, floor and ceiling, seen by cameras on a robot: images with known truth, quickly.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "rigproof/core/image.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

enum class Walls { kPatterned, kPanelled };

/// What the camera sees from T_world_camera: an 8 x 6 x 2.6 m room, its centre at the world's origin, floor at z = 0.
/// Panelled walls have plumb dark edges every 0.7 m and level ones at 0.9 and 1.8 m.
Image8 draw_room(const Camera& camera, const Rigid3& T_world_camera, Walls walls = Walls::kPatterned);

/// A drive through the room with exact odometry and, where asked, exact board corners at every stop.
struct RoomDrive {
  Observations observations;
  Recording recording;
  std::vector<Rigid3> T_robot_camera;
};
/// Writes the images below `folder`.
/// @param poses of the robot in the room
RoomDrive drive_through_room(const std::vector<Rigid3>& T_room_robot, const std::vector<Rigid3>& T_robot_camera,
                             bool with_board, const std::filesystem::path& folder, Walls walls = Walls::kPatterned);

/// A camera on the robot: yaw to the left, pitch downwards, roll.
Rigid3 mounted(double x_m, double y_m, double z_m, double yaw_rad, double pitch_rad, double roll_rad);

/// One looks ahead, one to the side and down: where it looks, no point ever lies ahead of the robot.
std::vector<Rigid3> two_cameras();

/// Poses in the room: one step after another in the robot's own frame.
struct Steps {
  std::vector<Rigid3> poses;

  explicit Steps(const Rigid3& start) : poses({start}) {}
  void forward(double metres, int times) { arc(metres, 0.0, times); }
  void arc(double metres, double turn_deg, int times);
};

}  // namespace rigproof
