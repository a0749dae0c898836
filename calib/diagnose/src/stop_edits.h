// Observations with some of their stops, or with what was seen at other stops.
#pragma once

#include <vector>

#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// The first `stops` stops, as a separate run.
Observations first_stops(const Observations& observations, int stops);
/// The stops `first` <= i < `end`, as a separate run.
Observations stops_between(const Observations& observations, int first, int end);

/// The way to the stop after it then leads past it.
void leave_out_stop(int stop, Observations* observations);

/// Exchanges what two cameras saw at a stop.
void swap_frames(int stop, int first, int second, Observations* observations);

/// What cameras saw from the stop `from` on, as seen `by` stops later: what was seen at the stops that it moves to, if
/// they lie before, is left out.
void shift_cameras(const std::vector<int>& cameras, int by, int from, Observations* observations);

/// What the cameras saw at each stop, as seen at stop to[stop].
void move_frames(const std::vector<int>& cameras, const std::vector<int>& to, Observations* observations);

}  // namespace rigproof::ml
