#include "frame_choice.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "rigproof/core/conventions.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {
namespace {

constexpr double kWindow_s = 0.1;
constexpr double kFarSample_s = 1.0;                        // says nothing of the time between
constexpr double kStands_m_s = 0.01, kStands_rad_s = 0.01;  // the mean over the window or the sample beside it
constexpr double kSameStop_m = 5e-3, kSameStop_rad = 5e-3;  // estimates of a pose that stands wander
constexpr double kStopsApart_s = 0.5;                       // in which a robot can drive off and come back
constexpr double kStep_m = 0.05, kStep_rad = 3.0 * kPi / 180.0;
constexpr std::size_t kFewestStops = 3;
constexpr double kOutside_s = 0.05;  // odometry serves an image this far beyond its ends

double distance(const OdometrySample& a, const OdometrySample& b) { return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }
double turn(const OdometrySample& a, const OdometrySample& b) { return std::abs(wrap_angle(a.yaw_rad - b.yaw_rad)); }
bool within(const OdometrySample& a, const OdometrySample& b, double metres, double radians) {
  return distance(a, b) <= metres && turn(a, b) <= radians;
}

struct Shot {
  std::size_t camera = 0, index = 0;
  double stamp_s = 0.0;
  OdometrySample pose;  // the nearest sample's
  bool stands = false;
};

class Track {
 public:
  explicit Track(const std::vector<OdometrySample>& odometry) : odometry_(odometry) {}

  bool covers(double stamp_s) const {
    return !odometry_.empty() && stamp_s >= odometry_.front().stamp_s - kOutside_s &&
           stamp_s <= odometry_.back().stamp_s + kOutside_s;
  }
  const OdometrySample& nearest(double stamp_s) const {
    const auto after = first_from(stamp_s);
    if (after == odometry_.begin()) return *after;
    if (after == odometry_.end()) return odometry_.back();
    const auto before = after - 1;
    return stamp_s - before->stamp_s < after->stamp_s - stamp_s ? *before : *after;
  }
  // By the samples within the window and the next on either side. One row for each stop tells nothing of the time
  // between: such a recording has stops only.
  bool stands(double stamp_s) const {
    const OdometrySample& here = nearest(stamp_s);
    auto sample = first_from(stamp_s - kWindow_s);
    if (sample != odometry_.begin()) --sample;
    for (; sample != odometry_.end(); ++sample) {
      const double apart_s = std::max(kWindow_s, std::abs(sample->stamp_s - stamp_s));
      if (apart_s > kFarSample_s && sample->stamp_s > stamp_s) break;
      if (apart_s > kFarSample_s) continue;
      if (!within(here, *sample, kStands_m_s * apart_s, kStands_rad_s * apart_s)) return false;
      if (sample->stamp_s > stamp_s + kWindow_s) break;
    }
    return true;
  }

 private:
  std::vector<OdometrySample>::const_iterator first_from(double stamp_s) const {
    return std::lower_bound(odometry_.begin(), odometry_.end(), stamp_s,
                            [](const OdometrySample& sample, double t) { return sample.stamp_s < t; });
  }
  const std::vector<OdometrySample>& odometry_;
};

std::vector<Shot> shots_of(const std::vector<std::vector<double>>& stamps_s, const Track& track, FrameChoice* choice) {
  std::vector<Shot> shots;
  for (std::size_t camera = 0; camera < stamps_s.size(); ++camera) {
    for (std::size_t i = 0; i < stamps_s[camera].size(); ++i) {
      const double stamp_s = stamps_s[camera][i];
      if (track.covers(stamp_s))
        shots.push_back({camera, i, stamp_s, track.nearest(stamp_s), track.stands(stamp_s)});
      else
        ++choice->outside;
    }
  }
  std::stable_sort(shots.begin(), shots.end(), [](const Shot& a, const Shot& b) { return a.stamp_s < b.stamp_s; });
  return shots;
}

// Shots of standstills, stop by stop.
std::vector<std::vector<Shot>> stops_of(const std::vector<Shot>& shots) {
  std::vector<std::vector<Shot>> stops;
  bool moved = true;
  for (const Shot& shot : shots) {
    if (!shot.stands) {
      moved = true;
      continue;
    }
    const bool same = !stops.empty() && within(stops.back().front().pose, shot.pose, kSameStop_m, kSameStop_rad) &&
                      !(moved && shot.stamp_s - stops.back().back().stamp_s > kStopsApart_s);
    if (!same) stops.emplace_back();
    stops.back().push_back(shot);
    moved = false;
  }
  return stops;
}

void keep_of_stop(const std::vector<Shot>& stop, const FrameChoiceOptions& options, FrameChoice* choice) {
  for (std::size_t camera = 0; camera < choice->kept.size(); ++camera) {
    std::vector<std::size_t> all;
    for (const Shot& shot : stop)
      if (shot.camera == camera) all.push_back(shot.index);
    if (!all.empty()) ++choice->stops_of_camera[camera];
    const auto most = static_cast<std::size_t>(std::max(1, options.images_per_stop));
    if (options.every_image || all.size() <= most) {
      choice->kept[camera].insert(choice->kept[camera].end(), all.begin(), all.end());
      continue;
    }
    choice->surplus += all.size() - most;
    // Evenly spread; a single one is from the middle, when nothing swings any more.
    for (std::size_t i = 0; i < most; ++i)
      choice->kept[camera].push_back(most == 1 ? all[all.size() / 2] : all[i * (all.size() - 1) / (most - 1)]);
  }
}

void keep_along_the_way(const std::vector<Shot>& shots, FrameChoice* choice) {
  std::vector<const Shot*> last(choice->kept.size(), nullptr);
  for (const Shot& shot : shots) {
    const Shot*& before = last[shot.camera];
    if (before != nullptr && within(before->pose, shot.pose, kStep_m, kStep_rad)) {
      ++choice->surplus;
      continue;
    }
    before = &shot;
    choice->kept[shot.camera].push_back(shot.index);
  }
}

}  // namespace

FrameChoice choose_frames(const std::vector<std::vector<double>>& stamps_s, const std::vector<OdometrySample>& odometry,
                          const FrameChoiceOptions& options) {
  FrameChoice choice;
  choice.kept.resize(stamps_s.size());
  choice.stops_of_camera.resize(stamps_s.size());
  const std::vector<Shot> shots = shots_of(stamps_s, Track(odometry), &choice);
  const std::vector<std::vector<Shot>> stops = stops_of(shots);
  choice.stops = stops.size();
  choice.on_the_move = stops.size() < kFewestStops && !options.every_image;
  if (choice.on_the_move) {
    keep_along_the_way(shots, &choice);
    return choice;
  }
  for (const std::vector<Shot>& stop : stops) keep_of_stop(stop, options, &choice);
  for (const Shot& shot : shots) {
    if (shot.stands) continue;
    if (options.every_image)
      choice.kept[shot.camera].push_back(shot.index);
    else
      ++choice.moving;
  }
  for (std::vector<std::size_t>& kept : choice.kept) std::sort(kept.begin(), kept.end());
  return choice;
}

}  // namespace rigproof
