// Whether images show what their stops promise: a standstill, and a picture of their own.
#pragma once

#include <vector>

#include "rigproof/calib/vision/stops.h"
#include "sight.h"

namespace rigproof::detection {

/// Times at which the odometer stands still though the board moves through the images: dead or frozen odometry. Where
/// there is one, standstills that no camera can confirm, because it saw the board once at most, are among them.
std::vector<TimeSpan> false_standstills(const Recording& recording, const StopPlan& plan,
                                        const std::vector<Sight>& sights);

/// Of images of one camera that are the same to the last bit, at stops that differ by the odometry, all but the first
/// lose their corners: a driver that hung, or copied files, give no second measurement. Throws Error if two cameras
/// have the same image.
void drop_repeated_images(const Recording& recording, const StopPlan& plan, std::vector<Sight>* sights);

}  // namespace rigproof::detection
