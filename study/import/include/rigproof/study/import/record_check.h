// While the robot drives, or afterwards: what the images taken so far show of the board, and what is missing.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/finding.h"
#include "rigproof/study/import/init.h"

namespace rigproof {

/// What was seen by one camera at one stop.
struct PictureCheck {
  bool board = false;
  int which = 0;                         ///< of the rig's boards
  std::optional<Finding> why_not;        ///< board.not_found, board.cut_off, image.unreadable ..
  std::vector<Eigen::Vector2d> corners;  ///< in the order of ids
  std::optional<double> edge_px;         ///< width of the edges around the corners
  bool overexposed = false, underexposed = false;
};

struct CameraCheck {
  std::string name;
  std::size_t stops = 0;        ///< with an image of it
  std::size_t board_stops = 0;  ///< with the whole board in it
  std::size_t cells = 0;        ///< of kImageCells, those with a corner in them
  std::optional<double> edge_px;
  std::size_t blurred = 0, overexposed = 0, underexposed = 0, unreadable = 0;  ///< stops
  std::vector<Finding> left_out;  ///< why there is no board, each with its `count`, the most frequent first
};

struct PairCheck {
  std::string first, second;
  std::size_t stops = 0;  ///< at which both have the board
};

/// What to do next.
struct Advice {
  std::vector<std::string> cameras;
  double turn_deg = 0.0;            ///< to the left, from `stop`
  std::size_t stop = 0;             ///< from where, counted from 0
  bool here = true;                 ///< that is where the robot stands now
  std::optional<std::string> part;  ///< of the image where the board is missing: "left", "upper", ..
};

struct RecordCheck {
  double duration_s = 0.0;  ///< from the first stop to the last
  std::size_t stops = 0;
  std::string board;  ///< "checkerboard 6x5"; empty: not known, and none found yet
  bool board_guessed = false;
  std::vector<CameraCheck> cameras;
  std::vector<PairCheck> pairs;
  std::vector<Advice> next;
  std::vector<std::vector<std::optional<PictureCheck>>> pictures;  ///< [stop][camera]
  std::size_t waiting = 0;                                         ///< images that cannot be read yet
};

struct RecordCheckOptions {
  /// Source, board (absent: that of a recording, or guessed from the images), odometry, topics, intrinsics, stamps.
  InitOptions source;
  bool growing = false;  ///< files may be half-written: they are read again by the next look()
  /// Images looked at and to look at; returns false to interrupt, which throws Error with ExitCode::kTryAgain.
  std::function<bool(std::size_t, std::size_t)> progress;
};

/// Looks at a recording, a folder of images with a trajectory, or a bag of ROS 2, again and again; an image once. Of
/// each stop and camera one image is looked at.
class RecordWatch {
 public:
  /// Throws Error where there is no such source, or it is none.
  explicit RecordWatch(RecordCheckOptions options);
  ~RecordWatch();
  RecordWatch(const RecordWatch&) = delete;
  RecordWatch& operator=(const RecordWatch&) = delete;

  /// The source as it is now. Throws Error where nothing can be told of it (yet): no image, no trajectory.
  RecordCheck look();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigproof
