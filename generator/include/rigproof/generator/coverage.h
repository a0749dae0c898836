// How much of its image each camera sees boards in.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "rigproof/core/image_cell.h"
#include "rigproof/generator/viewpoints.h"

namespace rigproof {

struct CameraCoverage {
  std::string camera;
  int rows = 0;                ///< of its image
  std::size_t stops = 0;       ///< from which it has a whole board in its image, unhidden
  std::size_t cells = 0;       ///< of kImageCells, those with a corner of a board in them
  double top_row_px = 0.0;     ///< of the uppermost corner; 0 without any
  double bottom_row_px = 0.0;  ///< of the lowest
};

/// What each camera sees of boards from some places of the robot in the scene's frame.
/// @param config its margin and obliquity decide what counts
std::vector<CameraCoverage> coverage_of(const std::vector<Rigid3>& T_scene_robot, const ViewpointConfig& config,
                                        const ViewpointSubject& subject, ViewpointWorld& world);

/// The most that any drive on level floor can show each camera of these boards where they stand: from every place in
/// the drivable area at the distances and bearings of `config`, with every heading, were nothing in the way.
/// @param T_scene_robot places of a plan, which are possible, too: those tried are a grid and may miss a cell
/// @returns cells and rows; `stops` counts places that were tried, and means nothing
std::vector<CameraCoverage> possible_coverage(const ViewpointConfig& config, const ViewpointSubject& subject,
                                              ViewpointWorld& world, const std::vector<Rigid3>& T_scene_robot = {});

/// "board in 17 of 20, in 28 of 48 parts of its image (possible: 31), rows 34 to 402 of 720 (possible: 20 to 410)".
std::string describe_camera(const CameraCoverage& seen, const CameraCoverage& possible, std::size_t stops);

/// Pixels of all corners of the board; those of a corner that cannot be projected are left out.
std::vector<Eigen::Vector2d> corners_in_image(const WorldCamera& camera, const Rigid3& T_scene_robot,
                                              const ViewedBoard& board);

}  // namespace rigproof
