// What is wrong with the clocks.
#include <algorithm>

#include "resolve.h"

namespace rigproof {
namespace {

// Stamps of one sensor stay at least this far apart.
constexpr double kLeastStepS = 1e-6;

// Moves stamps apart where a disturbance has put them out of order.
template <typename Items>
void keep_in_order(Items* items) {
  for (std::size_t i = 1; i < items->size(); ++i)
    (*items)[i].stamp_s = std::max((*items)[i].stamp_s, (*items)[i - 1].stamp_s + kLeastStepS);
}

void disturb_frames(const TimeSensingConfig& config, std::uint64_t seed, std::int32_t camera,
                    std::vector<CameraFrame>* frames, TrueCamera* truth) {
  RandomStream random(seed, "camera clock", -1, camera);
  const double offset_s = config.clock_offset_ms.sample(random) / 1000.0;
  const double delay_s = config.camera_delay_ms.sample(random) / 1000.0;
  std::vector<CameraFrame> kept;
  for (std::size_t i = 0; i < frames->size(); ++i) {
    CameraFrame frame = (*frames)[i];
    RandomStream draw(seed, "frame clock", static_cast<std::int64_t>(i), camera);
    const bool dropped = 100.0 * draw.uniform() < config.dropped_percent;
    frame.stamp_s += offset_s + delay_s + draw.normal() * config.stamp_jitter_ms / 1000.0;
    const bool last_hope = kept.empty() && i + 1 == frames->size();
    if (!dropped || last_hope) kept.push_back(frame);
  }
  keep_in_order(&kept);
  const auto add = [truth](const char* name, double value) {
    if (value != 0.0) truth->sensing[name] = value;
  };
  add("clock_offset_s", offset_s);
  add("camera_delay_s", delay_s);
  add("stamp_jitter_s", config.stamp_jitter_ms / 1000.0);
  add("dropped_frames", static_cast<double>(frames->size() - kept.size()));
  *frames = std::move(kept);
}

}  // namespace

void TimeSensingConfig::visit(FieldVisitor& visitor) {
  visitor.field("clock_offset_ms", clock_offset_ms, {-1000.0, 1000.0},
                "a camera's stamps are later than the truth by this, drawn for each camera");
  visitor.field("camera_delay_ms", camera_delay_ms, {-1000.0, 1000.0},
                "a camera takes its images later than the stop's time by this and says so, drawn for each camera: "
                "cameras without a common trigger. With drive.capture moving a render key, >= 0: images show where the "
                "robot is then, and the run's seed draws");
  visitor.field("stamp_jitter_ms", stamp_jitter_ms, {0.0, 1000.0}, "error of every single stamp, one sigma");
  visitor.field("dropped_percent", dropped_percent, {0.0, 90.0}, "share of the frames that were never recorded");
  visitor.field("odometry_delay_ms", odometry_delay_ms, {-1000.0, 1000.0},
                "stamps of the odometry are later than the truth by this, drawn once a run");
  visitor.field("odometry_jitter_ms", odometry_jitter_ms, {0.0, 1000.0}, "error of every single stamp, one sigma");
}

std::vector<double> rendered_delays_s(const GenerateConfig& config, std::size_t cameras) {
  std::vector<double> delays_s(cameras, 0.0);
  if (!config.moves_while_exposing()) return delays_s;
  for (std::size_t i = 0; i < cameras; ++i) {
    RandomStream random(static_cast<std::uint64_t>(config.seed), "camera delay", -1, static_cast<std::int32_t>(i));
    delays_s[i] = config.sensing.time.camera_delay_ms.sample(random) / 1000.0;
  }
  return delays_s;
}

TimeSensingConfig sensed_time(const GenerateConfig& config) {
  TimeSensingConfig time = config.sensing.time;
  if (config.moves_while_exposing()) time.camera_delay_ms = 0.0;
  return time;
}

void disturb_time(const TimeSensingConfig& config, std::uint64_t seed, Recording* recording, Truth* truth) {
  for (std::size_t i = 0; i < recording->frames.size(); ++i)
    disturb_frames(config, seed, static_cast<std::int32_t>(i), &recording->frames[i], &truth->cameras[i]);
  disturb_odometry_time(config, seed, recording, truth);
}

void disturb_odometry_time(const TimeSensingConfig& config, std::uint64_t seed, Recording* recording, Truth* truth) {
  RandomStream random(seed, "odometry clock");
  const double delay_s = config.odometry_delay_ms.sample(random) / 1000.0;
  for (OdometrySample& sample : recording->odometry)
    sample.stamp_s += delay_s + random.normal() * config.odometry_jitter_ms / 1000.0;
  keep_in_order(&recording->odometry);
  if (delay_s != 0.0) truth->drawn["sensing.time.odometry_delay_ms"] = 1000.0 * delay_s;
}

}  // namespace rigproof
