// The vertical in a camera, from line segments of its images: the vanishing point of plumb edges, for drives with too
// few turns.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "rigproof/calib/diagnose/method.h"

namespace rigproof::rivals {

/// A line segment in an image: the unit normal of the plane of its rays, in the camera's frame, perpendicular to the
/// line's direction whatever the lens does to the line.
struct SeenLine {
  Eigen::Vector3d normal;
  double length_px = 0.0;
};

struct PlumbLines {
  Eigen::Vector3d up;      ///< unit vector in the camera's frame
  std::size_t lines = 0;   ///< segments that agree
  std::size_t images = 0;  ///< in how many images
};

/// The direction that most of the lines' length shares, among those within 45 degrees of the image's columns and 5
/// degrees of perpendicular to the forward direction, since the robot drives on the level. So the camera must be
/// mounted less than 45 degrees off upright. Sample consensus over pairs of lines of one image, then least squares
/// under Cauchy's loss. Absent if fewer than three images agree, or no more of the length than for randomly directed
/// lines.
/// @param images lines of every image of one camera; the vertical is one direction in all of them
/// @param ahead unit vector in the camera's frame
/// @param camera gives each camera its own random stream
std::optional<PlumbLines> plumb_direction(const std::vector<std::vector<SeenLine>>& images,
                                          const Eigen::Vector3d& ahead, int camera);

/// Line segments (von Gioi's detector, OpenCV) of every image of the camera, at stops and in straight segments. Those
/// on the board are left out, which need not stand plumb. Images that cannot be read have none.
std::vector<std::vector<SeenLine>> lines_of_camera(const MethodInput& input, int camera);

}  // namespace rigproof::rivals
