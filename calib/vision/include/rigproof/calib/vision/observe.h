// From a recording to observations: board corners, ground and board planes, odometry at each stop.
#pragma once

#include <functional>

#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"

namespace rigproof {

struct ObserveOptions {
  int threads = 0;  ///< 0 = all cores
  /// Frames of different cameras closer in time than this belong to one stop [s]. Where odometry has no two samples
  /// to interpolate between, one sample this close to the frame serves.
  double stop_tolerance_s = 0.02;
  /// Largest gap between odometry samples across which a frame's pose is interpolated [s].
  double max_odometry_gap_s = 0.5;
  bool use_depth = true;
  /// Called from one thread at a time with (frames done, frames in all), and with the total for both while planes are
  /// searched; return false to interrupt, which throws Error with ExitCode::kTryAgain.
  std::function<bool(std::size_t, std::size_t)> progress;
};

/// Reads every image of the recording. What cannot be used becomes an Exclusion with a reason; Error is thrown only
/// where nothing can be answered (no image at all, odometry that never meets the frames, every image of a camera of
/// another size than its intrinsics, the board in no image).
///
/// Stops: frames within stop_tolerance_s of each other, and all frames between which the odometer stands still. A
/// standstill gives one keyframe a camera: of three frames spread over it the one with the most corners, then the
/// nearest to the stop's stamp, so that cameras show one moment, then the sharpest, then the first.
/// Boards are found first; the rotation axis of the cameras' own motion then tells which planes in the depth images
/// can be the ground. Planes that disagree with the vertical or with the others become exclusions. A camera without
/// depth or clouds has no planes. The result does not depend on the number of threads.
Observations observe(const Recording& recording, const ObserveOptions& options = {});

}  // namespace rigproof
