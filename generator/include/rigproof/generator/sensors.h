// What the sensors make of a clean picture: image noise in linear light, depth noise in disparity, and what a device's
// build and its surroundings add to that.
//
// Clean render -> Sensor -> what is recorded. Nothing here knows where the picture came from, so that one render can be
// sensed many times. Formulas and sources: docs/theory/sensors.md.
#pragma once

#include <memory>
#include <optional>

#include "rigproof/core/image.h"
#include "rigproof/generator/effect.h"
#include "rigproof/generator/sensor_device.h"

namespace rigproof {

/// From light to levels: the effects, then shot and read noise, gamma, 8 bits.
struct ImageSensing {
  double full_well_electrons = 6300.0;
  double read_noise_electrons = 2.5;
  double gamma = 2.2;
  bool noise = true;                ///< shot and read noise
  EffectList<ImageEffect> effects;  ///< those that are on

  /// True if nothing but shot and read noise is left: that is quicker.
  bool is_noise_alone() const { return noise && effects.empty(); }
};

/// How a depth sensor measures. The law and its sigma come from the rig's sensor preset.
struct DepthSensing {
  DepthStream stream;
  bool noise = true;
  /// Stereo: focal length times baseline; disparity [px] = this / z, and sigma [px] = this * sigma of 1/z.
  double focal_baseline_px_m = 0.08 / 0.0019;
  double disparity_step_px = 1.0 / 32.0;  ///< 0 = as fine as can be
  double focal_px = 640.0;                ///< of the depth image
  double patch_px = 24.0;
  EffectList<DepthEffect> effects;  ///< those that are on, in the order in which they change the scene

  bool is_stereo() const { return stream.noise.law == DepthNoise::Law::kStereo; }
  /// Standard deviation of what is recorded of a wall at z: the law and the rounding to disparity steps and units.
  double recorded_sigma_m(double z_m) const;
};

/// The depth sensor of a preset with its noise and nothing else. Throws Error if it has no depth.
DepthSensing depth_sensing_of(const SensorDevice& device);

/// Takes from `effects` those that are on for this device.
void add_effects(const EffectList<ImageEffect>& effects, DeviceDraws* draws, ImageSensing* image);
void add_effects(const EffectList<DepthEffect>& effects, bool outdoors, DeviceDraws* draws, DepthSensing* depth);

/// What one camera's sensor does. Absent parts leave the picture clean.
struct SensorModel {
  std::optional<ImageSensing> image;
  std::optional<DepthSensing> depth;
  double depth_scale = 1.0;  ///< measured over true depth, an error of the device

  /// What is simulated, for the truth: names with units, nothing that is off.
  Labels labels() const;
};

/// Prepared tables of one device. Const after construction, but for scratch memory: one thread at a time.
class Sensor {
 public:
  /// @param device its frame is ignored: what is fixed for a device is drawn from (seed, camera)
  /// A depth stream with a camera of its own has that camera's size instead.
  Sensor(const SensorModel& model, int width, int height, const FrameSeed& device = {});
  ~Sensor();
  Sensor(Sensor&&) noexcept;

  /// From the clean, gamma-coded 8-bit image to the recorded one, in place.
  void sense_color(const FrameSeed& frame, Image8* image) const;
  /// Depth image as the sensor writes it; 0 = no measurement. Without noise: the clean depth, rounded to the unit.
  /// @param depth_m clean z along the optical axis, 0 = nothing there
  /// @param clean_color what the depth sensor's imagers see, of the same size; may be empty where texture does not
  /// matter
  void sense_depth(const ImageF& depth_m, const Image8& clean_color, double unit_m, const FrameSeed& frame,
                   Image16* counts) const;

  const SensorModel& model() const { return model_; }
  /// The depth that the measurement sees; valid until the next call.
  const ImageF& seen_depth(const ImageF& depth_m, const Image8& clean_color, const FrameSeed& frame) const;

 private:
  struct Prepared;
  SensorModel model_;
  std::unique_ptr<Prepared> prepared_;
};

}  // namespace rigproof
