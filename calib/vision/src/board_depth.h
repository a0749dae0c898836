// Depth on the board and off it.
#pragma once

#include <optional>

#include "rigproof/calib/geometry/pnp.h"
#include "rigproof/calib/vision/ground_plane.h"

namespace rigproof::detection {

/// The depth points of one frame, separated by where they project.
struct SplitPoints {
  DepthPoints on_board;   ///< well inside the squares
  DepthPoints elsewhere;  ///< well outside of the board and its border
};
SplitPoints split_at_board(const DepthPoints& points, const Board& board, const Rigid3& T_camera_board);

/// The plane where the board is seen, by least squares in inverse depth, with points beyond 3 robust deviations
/// trimmed. Absent with fewer than 50 points. At whatever distance: a depth scale or board size that is wrong must
/// show.
std::optional<PlaneObservation> fit_board_plane(const DepthPoints& points, const DepthNoise& noise,
                                                const Rigid3& T_camera_board);

}  // namespace rigproof::detection
