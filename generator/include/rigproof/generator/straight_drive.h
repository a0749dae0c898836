// Frames along a straight line without the board, beside the viewpoints: what methods need that read vanishing points.
#pragma once

#include <vector>

#include "rigproof/core/recording.h"
#include "rigproof/generator/straight_drive_config.h"
#include "rigproof/generator/viewpoints.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

/// Appends places along the scene's straight path, evenly spread, to be visited after the last viewpoint. Throws Error
/// if the scene has no such path, or names what the robot would touch on it.
void append_straight_stops(const StraightDriveConfig& config, const StraightPath& path, ViewpointWorld& world,
                           ViewpointPlan* plan);

/// How many stops at the end of a drive belong to a straight path: they are no viewpoints of the board.
std::size_t trailing_straight_stops(const std::vector<Viewpoint>& stops);

/// The segment that holds the last `count` stops of a drive, count >= 1, with half a step to spare on either side:
/// clocks of cameras may differ a little.
RecordingSegment straight_segment(const std::vector<TrueStop>& stops, std::size_t count);

}  // namespace rigproof
