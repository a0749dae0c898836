#include "room.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "looking_forward.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const Vector3d kLow(-4.0, -3.0, 0.0), kHigh(4.0, 3.0, 2.6);

double hash(std::int64_t x, std::int64_t y, std::uint64_t seed) {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL ^
                    static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL ^ seed * 0x165667B19E3779F9ULL;
  h ^= h >> 29U;
  h *= 0xBF58476D1CE4E5B9ULL;
  h ^= h >> 32U;
  return static_cast<double>(h & 0xFFFFFFU) / 16777215.0;
}

// Smooth noise whose blobs are one unit wide.
double noise(double x, double y, std::uint64_t seed) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
  const auto fade = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double u = fade(x - fx), v = fade(y - fy);
  const double low = (1.0 - u) * hash(ix, iy, seed) + u * hash(ix + 1, iy, seed);
  const double high = (1.0 - u) * hash(ix, iy + 1, seed) + u * hash(ix + 1, iy + 1, seed);
  return (1.0 - v) * low + v * high;
}

double pattern(double x, double y, std::uint64_t seed) {
  return 0.5 * noise(x / 0.25, y / 0.25, seed) + 0.3 * noise(x / 0.1, y / 0.1, seed + 7) +
         0.2 * noise(x / 0.045, y / 0.045, seed + 13);
}

bool on_edge(double along, double height) {
  const double place = along / 0.7 - std::floor(along / 0.7);
  return place < 0.06 || std::abs(height - 0.9) < 0.02 || std::abs(height - 1.8) < 0.02;
}

double brightness(const Vector3d& origin, const Vector3d& direction, Walls walls) {
  double nearest = 1e9;
  int axis = 0;
  bool high = false;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(direction[i]) < 1e-12) continue;
    const bool up = direction[i] > 0.0;
    const double distance = ((up ? kHigh[i] : kLow[i]) - origin[i]) / direction[i];
    if (distance < nearest) nearest = distance, axis = i, high = up;
  }
  const Vector3d p = origin + nearest * direction;
  if (walls == Walls::kPanelled && axis < 2 && on_edge(p[1 - axis], p.z())) return 0.05;
  return pattern(p[(axis + 1) % 3], p[(axis + 2) % 3], static_cast<std::uint64_t>(2 * axis + (high ? 1 : 0) + 1));
}

}  // namespace

Image8 draw_room(const Camera& camera, const Rigid3& T_world_camera, Walls walls) {
  Image8 image(camera.width_px, camera.height_px);
  const Eigen::Matrix3d R = T_world_camera.rotation_matrix();
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      Vector3d ray;
      camera.unproject(Vector2d(u, v), &ray);
      const double value = 255.0 * brightness(T_world_camera.translation, R * ray, walls);
      image.at(u, v) = static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
    }
  }
  return image;
}

Rigid3 mounted(double x_m, double y_m, double z_m, double yaw_rad, double pitch_rad, double roll_rad) {
  const Eigen::Quaterniond body = Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(pitch_rad, Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(roll_rad, Vector3d::UnitX());
  return Rigid3(body * looking_forward(), Vector3d(x_m, y_m, z_m));
}

RoomDrive drive_through_room(const std::vector<Rigid3>& T_room_robot, const std::vector<Rigid3>& T_robot_camera,
                             bool with_board, const std::filesystem::path& folder, Walls walls) {
  RoomDrive drive;
  drive.T_robot_camera = T_robot_camera;
  drive.recording.folder = folder;
  drive.recording.frames.resize(T_robot_camera.size());
  Observations& o = drive.observations;
  for (std::size_t k = 0; k < T_robot_camera.size(); ++k) {
    RigCamera camera;
    camera.name = camera.folder = "camera" + std::to_string(k);
    camera.camera = Camera::symmetric(480, 360, 300.0);
    o.cameras.push_back(camera);
    std::filesystem::create_directories(folder / camera.folder);
  }
  drive.recording.rig.cameras = o.cameras;
  const Rigid3 T_room_board = mounted(3.2, 0.1, 1.1, 0.05, 0.1, 0.03);
  for (std::size_t i = 0; i < T_room_robot.size(); ++i) {
    const double stamp_s = static_cast<double>(i);
    const Rigid3& pose = T_room_robot[i];
    o.stops.push_back({stamp_s, pose.translation.x(), pose.translation.y(), yaw_of(pose), 0.0});
    for (std::size_t k = 0; k < T_robot_camera.size(); ++k) {
      const Rigid3 T_room_camera = pose * T_robot_camera[k];
      const Image8 image = draw_room(o.cameras[k].camera, T_room_camera, walls);
      const std::string file = o.cameras[k].folder + "/" + std::to_string(i) + ".png";
      cv::imwrite((folder / file).string(),
                  cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())));
      drive.recording.frames[k].push_back({file, "", "", stamp_s, 0.0, 0});
      BoardView view{static_cast<int>(i), static_cast<int>(k), stamp_s, file, {}};
      for (int id = 0; with_board && id < o.board.corner_count(); ++id) {
        Vector2d pixel;
        if (o.cameras[k].camera.project(T_room_camera.inverse() * (T_room_board * o.board.corner(id)), &pixel))
          view.corners.push_back({id, pixel, 1e-4 * Eigen::Matrix2d::Identity()});
      }
      if (static_cast<int>(view.corners.size()) == o.board.corner_count())
        o.board_views.push_back(view);
      else
        o.exclusions.push_back({static_cast<int>(k), static_cast<int>(i), file, Finding("board.not_found")});
    }
  }
  return drive;
}

std::vector<Rigid3> two_cameras() {
  return {mounted(0.25, 0.05, 0.65, deg_to_rad(6.0), deg_to_rad(18.0), deg_to_rad(2.0)),
          mounted(0.10, 0.20, 0.70, deg_to_rad(80.0), deg_to_rad(22.0), deg_to_rad(-3.0))};
}

void Steps::arc(double metres, double turn_deg, int times) {
  for (int i = 0; i < times; ++i) poses.push_back(poses.back() * planar_pose(metres, 0.0, deg_to_rad(turn_deg)));
}

}  // namespace rigproof
