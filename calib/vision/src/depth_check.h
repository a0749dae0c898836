// Whether depth belongs to its images, told by where the board is in both.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "rigproof/calib/vision/ground_plane.h"
#include "rigproof/core/rig.h"
#include "rigproof/core/rigid3.h"

namespace rigproof::detection {

/// How a depth image or cloud is taken.
enum class DepthReading { kAsItIs, kMirrored, kUpsideDown, kHalfTurn, kBodyAxes };

/// A depth image or cloud of a camera, of which the board's place is known: by this image, by the one before and the
/// one after, and by the other cameras at the same stop.
struct DepthFrame {
  std::optional<Rigid3> T_camera_board, T_camera_board_before, T_camera_board_after;
  std::vector<std::optional<Rigid3>> T_other_board;  ///< per camera; absent for this one
  /// All points whatever their range, in the colour camera's frame; absent where the file cannot be read so.
  std::function<std::optional<DepthPoints>(DepthReading)> points;
};

/// What is wrong with the depth of a camera: a likely cause without its cameras (`other` is the index of another
/// one); absent where the board is where the corners say, or too few frames show it. To be asked about cameras whose
/// depth on the board is missing or off in most frames: it reads files again. `unit_m` is what the rig says a count is.
struct DepthFault {
  Finding cause;
  int other = -1;
  DepthReading fits = DepthReading::kAsItIs;  ///< how depth must be taken to meet the board
};
std::optional<DepthFault> find_depth_fault(const std::vector<DepthFrame>& frames, const Board& board, double unit_m);

}  // namespace rigproof::detection
