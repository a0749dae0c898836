// Many views of ChArUco boards and AprilGrids, detected and counted.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "board_picture.h"
#include "rigproof/calib/vision/marked_board.h"
#include "rigproof/core/random.h"

namespace rigproof {

/// A board somewhere in the image, wholly visible, at any turn.
struct CharucoView {
  Board board;
  Camera camera;
  Rigid3 T_camera_board;
};

/// Which boards, and how far away.
struct MarkedViews {
  bool grids = false;  ///< AprilGrids with tags of 100 mm and gaps of several widths; else ChArUco boards
  double farthest_m = 4.0;
  double hidden = 0.0;  ///< share of the board's columns, from the first one on, that something hides
};

/// Up to 60 degrees oblique; boards of several sizes and dictionaries, some with small markers, some of the legacy
/// pattern.
CharucoView random_view(const MarkedViews& views, RandomStream& random);

/// What became of many views.
struct CharucoCounts {
  int views = 0, missed = 0, wrong = 0, lost = 0, corners = 0;  ///< wrong: a corner more than 1 px from its place
  double squares = 0.0, nees = 0.0, largest = 0.0;
  int poses = 0;
  double pose_nees = 0.0;  ///< of the board's pose from these corners, by their stated covariances
  std::map<std::string, int> reasons;

  double rms_px() const { return std::sqrt(0.5 * squares / corners); }
  double whitened() const { return std::sqrt(0.5 * nees / corners); }
  /// Root mean square error of the poses over their bound.
  double poses_by_bound() const { return std::sqrt(pose_nees / (6.0 * poses)); }
  void add(const CharucoView& view, const BoardPictureOptions& picture);
};

CharucoCounts count_views(int views, const BoardPictureOptions& picture, std::uint64_t seed,
                          const MarkedViews& kind = {});

}  // namespace rigproof
