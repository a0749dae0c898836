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
  std::vector<Finding> further = {};  ///< what is wrong beside the cause, and undone with it
};

/// The observations without the fault. That of odometry is undone as it was recorded: of the point about which the
/// robot turns.
Observations undone(const Fault& fault, Observations observations);

/// Odometry in another unit, of another handedness or inverted, with its columns in another order, and odometry whose
/// stamps are off by a few stops.
std::vector<Fault> odometry_faults(const Observations& observations);

/// Two cameras of which each has the frames of the other.
Fault exchanged_folders(const Observations& observations, int first, int second);

/// Images that are mirrored, depth with them, of one camera or of all, and cameras of other intrinsics whose images are
/// exchanged.
std::vector<Fault> image_faults(const Observations& observations);

/// Odometry that runs ahead of the images by `stops` stops (negative: behind); fractions are interpolated between two.
Fault odometry_ahead(const Observations& observations, double stops);

/// Odometry that runs ahead (negative: behind) by so many stops that those without a row of their own are left out.
Fault far_ahead(const Observations& observations, int stops);

/// Odometry whose translations are `factor` times those that the cameras see.
Fault odometry_scaled(double factor);

/// Odometry whose turns are `factor` times those that the cameras see.
Fault turns_scaled(double factor);

/// Odometry whose yaw drifts by so much a second, as by the bias of a gyro.
Fault odometry_drifting(const Observations& observations, double rad_s);

/// Frames that from the stop `from` on were taken `by` stops (1 or -1) later than stated: one was lost or doubled.
Fault shifted_frames(const Observations& observations, const std::vector<int>& cameras, int by, int from);
/// Frames of one of these cameras, among others, that were taken a stop earlier or later than stated.
std::vector<Fault> camera_shift_faults(const Observations& observations, const std::vector<int>& cameras);

/// Frames of all cameras whose stamps are those of other frames: in the order of their numbers as text, or backwards.
/// @param observations all of the drive, of which a part is repaired; must outlive the faults
std::vector<Fault> frame_order_faults(const Observations& observations);
/// The same of one of these cameras, among others.
std::vector<Fault> camera_order_faults(const Observations& observations, const std::vector<int>& cameras);

/// Leaves out the stop: its row or frames may be wrong, with too few other stops to outvote it.
Fault wrong_stop(const Observations& observations, int stop);

}  // namespace rigproof::ml
