// Faults of recordings that contradict themselves, and how each is undone: the one without which the data agree best is
// the likely cause.
#pragma once

#include <functional>
#include <vector>

#include "rigproof/core/finding.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

enum class FaultKind { kUnit, kSign, kStamps, kScale, kDrift, kImages, kFrames, kLens, kStop };

/// A fault with its remedy.
struct Fault {
  FaultKind kind;
  Finding cause;
  bool spoils_all = false;  ///< false: only x, y and yaw in the robot rest on it
  std::function<void(Observations*)> undo;
};

/// Odometry in another unit, of another handedness or inverted, and odometry whose stamps are off by whole stops.
std::vector<Fault> odometry_faults(const Observations& observations);

/// Images that are mirrored, depth with them, of one camera or of all, and cameras of other intrinsics whose images are
/// exchanged.
std::vector<Fault> image_faults(const Observations& observations);

/// Odometry that runs ahead of the images by `stops` stops (negative: behind); fractions are interpolated between two.
Fault odometry_ahead(const Observations& observations, double stops);

/// Odometry whose translations are `factor` times those that the cameras see.
Fault odometry_scaled(double factor);

/// Odometry whose yaw drifts by so much a second, as by the bias of a gyro.
Fault odometry_drifting(const Observations& observations, double rad_s);

/// Frames of one camera that were taken a stop earlier or later than stated.
std::vector<Fault> camera_shift_faults(const Observations& observations);

/// Exchanges what two cameras saw at a stop.
void swap_frames(int stop, int first, int second, Observations* observations);

/// Leaves out the stop: its row or frames may be wrong, with too few other stops to outvote it.
Fault wrong_stop(const Observations& observations, int stop);

/// The first `stops` stops, as a separate run.
Observations first_stops(const Observations& observations, int stops);
/// The stops `first` <= i < `end`, as a separate run.
Observations stops_between(const Observations& observations, int first, int end);

}  // namespace rigproof::ml
