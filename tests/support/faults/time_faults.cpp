#include <algorithm>
#include <cmath>
#include <numeric>

#include "recording_faults.h"
#include "rigproof/core/text.h"

namespace rigproof::faults {
namespace {

using Codes = std::vector<std::string>;
using Frames = std::vector<CameraFrame>;

// Odometry that covers no frame leaves every camera without one.
const Codes kClock = {"odometry.stamps",       "camera.no_view",         "camera.no_pose",
                      "odometry.not_covering", "odometry.misses_frames", kError};

RecordingFault of_all(const std::string& name, const Codes& codes,
                      const std::function<double(double stamp_s, std::size_t frame)>& edit) {
  return {name, "time", codes, {Files::kFrames}, [edit](FaultyRecording* r) {
            for (std::size_t k = 0; k < r->cameras(); ++k)
              r->edit_frames(k, [&](Frames* frames) {
                for (std::size_t i = 0; i < frames->size(); ++i) (*frames)[i].stamp_s = edit((*frames)[i].stamp_s, i);
              });
          }};
}

RecordingFault of_one(const std::string& name, const Codes& codes, double shift_s) {
  return {name,
          "time",
          codes,
          {Files::kFrames},
          [shift_s](FaultyRecording* r) {
            r->edit_frames(r->any_camera(), [&](Frames* frames) {
              for (CameraFrame& frame : *frames) frame.stamp_s += shift_s;
            });
          },
          shift_s > 0.0 ? has_two_cameras : std::function<bool(const Rig&)>()};
}

RecordingFault jittered(const std::string& name, double sigma_s) {
  return {name, "time", {"odometry.stamps", "odometry.misses_frames"}, {Files::kFrames}, [sigma_s](FaultyRecording* r) {
            for (std::size_t k = 0; k < r->cameras(); ++k)
              r->edit_frames(k, [&](Frames* frames) {
                RandomStream random = r->random("jitter", static_cast<std::int64_t>(k));
                for (CameraFrame& frame : *frames) frame.stamp_s += random.normal(0.0, sigma_s);
              });
          }};
}

// Frames get each other's stamps: the i-th that of position(i).
RecordingFault reordered(const std::string& name,
                         const std::function<std::size_t(std::size_t, std::size_t)>& position) {
  return {name, "time", {"frames.misordered"}, {Files::kFrames}, [position](FaultyRecording* r) {
            for (std::size_t k = 0; k < r->cameras(); ++k)
              r->edit_frames(k, [&](Frames* frames) {
                const Frames before = *frames;
                for (std::size_t i = 0; i < before.size(); ++i)
                  (*frames)[i].stamp_s = before[position(i, before.size())].stamp_s;
              });
          }};
}

// Where a number comes when numbers are sorted as text: 0, 1, 10, 11, .., 2, 20, ..
std::size_t place_as_text(std::size_t number, std::size_t count) {
  std::vector<std::size_t> sorted(count);
  std::iota(sorted.begin(), sorted.end(), std::size_t{0});
  std::sort(sorted.begin(), sorted.end(),
            [](std::size_t a, std::size_t b) { return std::to_string(a) < std::to_string(b); });
  return static_cast<std::size_t>(std::find(sorted.begin(), sorted.end(), number) - sorted.begin());
}

}  // namespace

std::vector<RecordingFault> time_faults() {
  std::vector<RecordingFault> faults;
  for (const double ms : {5.0, 20.0, 50.0, 200.0, 1000.0, 2000.0, -4000.0, 10000.0, 3.6e6})
    faults.push_back(of_all(sized("frames of all cameras", ms, " ms"), kClock,
                            [ms](double stamp_s, std::size_t) { return stamp_s + 1e-3 * ms; }));
  for (const double ms : {20.0, 50.0, 200.0, 1000.0, 2000.0})
    faults.push_back(of_one(sized("frames of one camera", ms, " ms"),
                            {"frames.shifted", "camera.no_pose", "camera.no_view"}, 1e-3 * ms));
  for (const double ms : {10.0, 50.0, 200.0})
    faults.push_back(jittered("stamps of all frames scattered by " + number_text(ms) + " ms", 1e-3 * ms));
  faults.push_back(of_all("frames' stamps in milliseconds", kClock, [](double s, std::size_t) { return 1e3 * s; }));
  faults.push_back(
      of_all("frames' clock 0.1 % fast", {"odometry.stamps"}, [](double s, std::size_t) { return 1.001 * s; }));
  faults.push_back(of_all("frames' clock 3 % fast", {"odometry.stamps", "odometry.misses_frames"},
                          [](double s, std::size_t) { return 1.03 * s; }));
  faults.push_back(of_all("frames' stamps rounded to seconds", {"odometry.stamps"},
                          [](double s, std::size_t) { return std::round(s); }));
  faults.push_back(of_all("frames' stamps all the same", {"motion.standstill", "motion.too_few_poses", kError},
                          [](double, std::size_t) { return 4.0; }));
  faults.push_back(reordered("frames in the order of their numbers as text", place_as_text));
  faults.push_back(
      reordered("frames in backward order", [](std::size_t i, std::size_t count) { return count - 1 - i; }));
  return faults;
}

}  // namespace rigproof::faults
