#include "rigproof/calib/vision/stops.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "odometry_track.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof::detection {
namespace {

// The robot stands still while its odometer moves less than this [m]: encoders do not tick, and a pose that is
// estimated afresh at every stop differs by more.
constexpr double kStandstill = 5e-4;

struct Frame {
  int camera = 0;
  int index = 0;
  double stamp_s = 0.0;
  OdometryReading odometry;
};

// Every frame with its odometry, by (stamp, camera, index).
std::vector<Frame> locate_frames(const Recording& recording, const OdometryTrack& track,
                                 std::vector<Exclusion>* exclusions) {
  std::vector<Frame> frames;
  for (std::size_t camera = 0; camera < recording.frames.size(); ++camera) {
    for (std::size_t i = 0; i < recording.frames[camera].size(); ++i) {
      const CameraFrame& frame = recording.frames[camera][i];
      if (recording.in_segment(frame)) continue;  // serves something else, by the recording's own word
      Finding why_not;
      const std::optional<OdometryReading> reading = track.at(frame.stamp_s, &why_not);
      if (reading)
        frames.push_back({static_cast<int>(camera), static_cast<int>(i), frame.stamp_s, *reading});
      else
        exclusions->push_back({static_cast<int>(camera), -1, frame.color_file, why_not});
    }
  }
  std::sort(frames.begin(), frames.end(), [](const Frame& a, const Frame& b) {
    return std::tie(a.stamp_s, a.camera, a.index) < std::tie(b.stamp_s, b.camera, b.index);
  });
  return frames;
}

[[noreturn]] void throw_never_meet(const Recording& recording) {
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (const auto& frames : recording.frames) {
    for (const CameraFrame& frame : frames) {
      first = std::min(first, frame.stamp_s);
      last = std::max(last, frame.stamp_s);
    }
  }
  const auto& odometry = recording.odometry;
  const std::string text = odometry.empty()
                               ? "there is no odometry for the frames"
                               : "odometry covers " + fixed_text(odometry.front().stamp_s, 3) + " to " +
                                     fixed_text(odometry.back().stamp_s, 3) + " s, the frames " + fixed_text(first, 3) +
                                     " to " + fixed_text(last, 3) +
                                     " s, and no frame meets it; both need the same clock and the same unit, seconds";
  throw Error((recording.folder / recording.rig.odometry_file).string() + ": " + text);
}

// True if the frame belongs to the stop that began with `first`.
bool same_stop(const Frame& first, const Frame& frame, double tolerance_s, const std::vector<TimeSpan>& moved) {
  if (frame.stamp_s - first.stamp_s <= tolerance_s) return true;
  const bool moves = std::any_of(moved.begin(), moved.end(), [&first](const TimeSpan& span) {
    return span.begin_s <= first.stamp_s && first.stamp_s <= span.end_s;
  });
  return !moves && frame.odometry.odometer_m - first.odometry.odometer_m <= kStandstill;
}

// Some of many, both ends included.
std::vector<int> evenly_spread(const std::vector<int>& all, std::size_t count) {
  if (all.size() <= count) return all;
  std::vector<int> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(all[i * (all.size() - 1) / (count - 1)]);
  return chosen;
}

// The odometry at the middle of the frames that stand for the stop.
Stop stop_of(const std::vector<Frame>& group, const OdometryTrack& track) {
  const Frame& middle = group[group.size() / 2];
  return {middle.stamp_s,
          middle.odometry.x_m,
          middle.odometry.y_m,
          middle.odometry.yaw_rad,
          middle.odometry.sigma_m,
          {},
          track.velocity_at(middle.stamp_s),
          track.acceleration_at(middle.stamp_s)};
}

PlannedStop plan_stop(const Recording& recording, const std::vector<Frame>& group, const OdometryTrack& track, int stop,
                      std::vector<Exclusion>* exclusions) {
  PlannedStop planned;
  planned.stop = stop_of(group, track);
  planned.frames.resize(recording.frames.size());
  for (const Frame& frame : group) planned.frames[static_cast<std::size_t>(frame.camera)].push_back(frame.index);
  for (std::size_t camera = 0; camera < planned.frames.size(); ++camera) {
    std::vector<int>& all = planned.frames[camera];
    const std::vector<int> chosen = evenly_spread(all, kFramesPerStandstill);
    for (const int index : all) {
      if (std::find(chosen.begin(), chosen.end(), index) != chosen.end()) continue;
      exclusions->push_back({static_cast<int>(camera), stop,
                             recording.frames[camera][static_cast<std::size_t>(index)].color_file,
                             Finding("frame.surplus")});
    }
    all = chosen;
  }
  return planned;
}

}  // namespace

StopPlan plan_stops(const Recording& recording, const ObserveOptions& options, const std::vector<TimeSpan>& moved) {
  const bool any = std::any_of(recording.frames.begin(), recording.frames.end(),
                               [](const std::vector<CameraFrame>& frames) { return !frames.empty(); });
  if (!any) throw Error(recording.folder.string() + ": no camera has any image");
  const std::vector<OdometrySample> odometry = odometry_of_origin(recording);
  const OdometryTrack track(odometry, options.max_odometry_gap_s, options.stop_tolerance_s);
  StopPlan plan;
  const std::vector<Frame> frames = locate_frames(recording, track, &plan.exclusions);
  if (frames.empty()) throw_never_meet(recording);
  for (std::size_t begin = 0; begin < frames.size();) {
    std::size_t end = begin + 1;
    while (end < frames.size() && same_stop(frames[begin], frames[end], options.stop_tolerance_s, moved)) ++end;
    const std::vector<Frame> group(frames.begin() + static_cast<std::ptrdiff_t>(begin),
                                   frames.begin() + static_cast<std::ptrdiff_t>(end));
    plan.stops.push_back(plan_stop(recording, group, track, static_cast<int>(plan.stops.size()), &plan.exclusions));
    begin = end;
  }
  for (std::size_t i = 1; i < plan.stops.size(); ++i)
    plan.stops[i].stop.way = track.way(plan.stops[i - 1].stop, plan.stops[i].stop);
  return plan;
}

}  // namespace rigproof::detection
