// The conventions that every other file relies on. The page for people is docs/reference/conventions.md.
//
// Frames
//   robot   fixed to the chassis; at static equilibrium on flat ground it coincides with the ground point amid the
//           wheels: x forward, y left, z up.
//   world   the ground-levelled robot frame at the first pose.
//   ground  the reference plane of the world, z = 0.
//   camera  optical: x right, y down, z forward.
//   board   origin at the first inner corner, x along inner_corners_x, y along inner_corners_y, z into the board.
//           The first corner is the one whose outer diagonal square is dark (see board.h).
//
// Transforms  T_target_source maps source coordinates to target coordinates: p_robot = T_robot_camera * p_camera.
// Pixels      the centre of the top-left pixel is (0, 0); a symmetric camera has cx = (width - 1) / 2.
// Depth       z along the optical axis; 0 means "no measurement".
// Units       metres, radians, seconds; any other unit is part of the name (_deg, _px, _mm).
// Errors      of a transform: t_est - t_true and Log(R_est R_true^T), both along the parent's axes, in the order
//             tx ty tz rx ry rz; covariances are in the same chart.
#pragma once

#include <array>

namespace rigproof {

/// Principal point, in pixels, of a camera that is symmetric about its optical axis.
constexpr double symmetric_principal_point(int size_px) { return (size_px - 1) / 2.0; }

/// Names of the six degrees of freedom in the order of every error vector and covariance.
inline constexpr std::array<const char*, 6> kDegreeOfFreedomNames = {"tx", "ty", "tz", "rx", "ry", "rz"};

/// The same of a camera in the robot as people read them: rotations about the robot's x, y and z.
inline constexpr std::array<const char*, 6> kSpokenAxisNames = {"tx", "ty", "tz", "roll", "pitch", "yaw"};

inline constexpr double kPi = 3.14159265358979323846;
constexpr double deg_to_rad(double angle_deg) { return angle_deg * (kPi / 180.0); }
constexpr double rad_to_deg(double angle_rad) { return angle_rad * (180.0 / kPi); }

}  // namespace rigproof
