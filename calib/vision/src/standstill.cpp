#include "standstill.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "rigproof/core/error.h"
#include "rigproof/core/median.h"

namespace rigproof::detection {
namespace {

// Of a standing robot: settling suspension and encoders that do not tick move the board by less [rad].
constexpr double kStands_rad = 0.01;

// Median over the corners that both have; 0 without any.
double median_shift_px(const Sight& a, const Sight& b) {
  std::map<int, Eigen::Vector2d> pixels;
  for (const CornerObservation& corner : a.corners) pixels[corner.id] = corner.pixel;
  std::vector<double> shifts;
  for (const CornerObservation& corner : b.corners)
    if (const auto other = pixels.find(corner.id); other != pixels.end())
      shifts.push_back((corner.pixel - other->second).norm());
  return shifts.empty() ? 0.0 : median(std::move(shifts));
}

struct Evidence {
  bool any = false;  // a camera saw the board twice
  bool moved = false;
};

std::vector<Evidence> evidence_of(const Recording& recording, std::size_t stops, const std::vector<Sight>& sights) {
  std::vector<Evidence> all(stops);
  std::map<std::pair<int, int>, const Sight*> last;  // with a board, by camera and board: the first of its stop
  for (const Sight& sight : sights) {
    if (sight.corners.empty()) continue;
    const Sight*& first = last[{sight.camera, sight.board}];
    if (first == nullptr || first->stop != sight.stop) {
      first = &sight;
      continue;
    }
    Evidence& evidence = all[static_cast<std::size_t>(sight.stop)];
    evidence.any = true;
    const double focal_px = recording.rig.cameras[static_cast<std::size_t>(sight.camera)].camera.fx_px;
    evidence.moved = evidence.moved || median_shift_px(*first, sight) > kStands_rad * focal_px;
  }
  return all;
}

TimeSpan span_of(const Recording& recording, const PlannedStop& stop) {
  TimeSpan span{stop.stop.stamp_s, stop.stop.stamp_s};
  for (std::size_t camera = 0; camera < stop.frames.size(); ++camera)
    for (const int frame : stop.frames[camera]) {
      const double stamp_s = recording.frames[camera][static_cast<std::size_t>(frame)].stamp_s;
      span = {std::min(span.begin_s, stamp_s), std::max(span.end_s, stamp_s)};
    }
  return span;
}

bool same_corners(const Sight& a, const Sight& b) {
  return a.corners.size() == b.corners.size() &&
         std::equal(a.corners.begin(), a.corners.end(), b.corners.begin(),
                    [](const CornerObservation& one, const CornerObservation& other) {
                      return one.id == other.id && one.pixel == other.pixel;
                    });
}

// Without noise a robot that comes back to a place sees the same again.
bool same_place(const Stop& a, const Stop& b) { return a.x_m == b.x_m && a.y_m == b.y_m && a.yaw_rad == b.yaw_rad; }

const std::string& file_of(const Recording& recording, const Sight& sight) {
  return recording.frames[static_cast<std::size_t>(sight.camera)][static_cast<std::size_t>(sight.frame)].color_file;
}

}  // namespace

std::vector<TimeSpan> false_standstills(const Recording& recording, const StopPlan& plan,
                                        const std::vector<Sight>& sights) {
  const std::vector<Evidence> evidence = evidence_of(recording, plan.stops.size(), sights);
  std::vector<TimeSpan> spans;
  if (std::none_of(evidence.begin(), evidence.end(), [](const Evidence& stop) { return stop.moved; })) return spans;
  for (std::size_t stop = 0; stop < plan.stops.size(); ++stop)
    if (evidence[stop].moved || !evidence[stop].any) spans.push_back(span_of(recording, plan.stops[stop]));
  return spans;
}

void drop_repeated_images(const Recording& recording, const StopPlan& plan, std::vector<Sight>* sights) {
  std::map<std::tuple<int, double, double>, const Sight*> first_of_camera;
  std::map<std::pair<double, double>, const Sight*> first_of_all;
  std::vector<std::pair<Sight*, const Sight*>> repeats;
  Problems shared;
  for (Sight& sight : *sights) {
    if (sight.corners.empty()) continue;
    const Eigen::Vector2d& pixel = sight.corners.front().pixel;
    const Sight& any = *first_of_all.emplace(std::make_pair(pixel.x(), pixel.y()), &sight).first->second;
    if (any.camera != sight.camera && same_corners(any, sight))
      shared.add({(recording.folder / file_of(recording, sight)).string(), 0, "", "",
                  "is the same image as " + file_of(recording, any) + ": each camera needs images of its own"});
    const Sight& first =
        *first_of_camera.emplace(std::make_tuple(sight.camera, pixel.x(), pixel.y()), &sight).first->second;
    const auto stop_of = [&plan](const Sight& of) { return plan.stops[static_cast<std::size_t>(of.stop)].stop; };
    if (first.stop != sight.stop && same_corners(first, sight) && !same_place(stop_of(first), stop_of(sight)))
      repeats.emplace_back(&sight, &first);
  }
  shared.throw_if_any();
  for (const auto& [sight, first] : repeats) {
    sight->why_not = Finding("image.repeats", {{"file", file_of(recording, *first)}});
    sight->corners.clear();
  }
}

}  // namespace rigproof::detection
