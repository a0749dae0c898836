// What calibration knows, and how it foresees what more the robot may do.
#pragma once

#include <vector>

#include "floor.h"
#include "forecast.h"
#include "rigproof/calib/plan/suggest.h"

namespace rigproof::suggest {

struct Outlook {
  const CalibrationSoFar& knowledge;
  const SuggestOptions& options;
  Floor floor;
  Foresight foresight;
  Forecast forecast;

  const CalibrationState& state() const { return knowledge.estimate.state; }
  const Observations& used() const { return knowledge.basis.used; }
  const Eigen::Vector2d& turns_about_m() const { return used().odometry_noise.rotation_centre_m; }
  Place last_place() const { return Place::of(state().T_world_robot.back()); }
  Eigen::Vector3d board_centre(int board) const {
    return pose_of_board(state(), board) * used().board_at(board).centre();
  }
  bool enough(const std::vector<int>& cameras) const { return static_cast<int>(cameras.size()) >= options.min_cameras; }
};

/// Places from which enough cameras see a board: where the robot stands, turned, and others drawn from the floor.
std::vector<Place> candidates_of(const Outlook& outlook);

/// A place at which a camera that has no pose may see a board.
struct Look {
  Place place;
  std::vector<int> hoped;  ///< cameras that may see it
};
/// Turns on the spot for cameras in whose images a board was looked for in vain, those that promise most first, of
/// several boards to the nearest one whose front is towards the robot; after a step where it is seen too obliquely from
/// where the robot stands, or was cut off in their images. A camera looks where it is mounted, if that is known, else
/// somewhere that its images so far do not rule out. At most as many as stops are asked for.
std::vector<Look> looks_for_board(const Outlook& outlook);

}  // namespace rigproof::suggest
