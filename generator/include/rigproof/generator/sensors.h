// What the sensors make of a clean picture: image noise in linear light, depth noise in disparity, and what a device's
// build and its surroundings add to that.
//
// Clean render -> Sensor -> what is recorded. Nothing here knows where the picture came from, so that one render can be
// sensed many times. Formulas and sources: docs/sensors.md.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rigproof/core/camera.h"
#include "rigproof/core/image.h"
#include "rigproof/core/random.h"
#include "rigproof/core/rig_yaml.h"

namespace rigproof {

/// From light to levels, in this order: defocus, vignetting, exposure, pixel gains, shot and dark noise, pixel offsets,
/// gamma, 8 bits. Zero (or 1 for a factor) leaves a step out.
struct ImageSensing {
  double full_well_electrons = 6300.0;
  double read_noise_electrons = 2.5;
  double gamma = 2.2;
  bool noise = true;                   ///< shot and read noise
  double dark_offset_electrons = 0.0;  ///< DSNU, one sigma
  double pixel_gain = 0.0;             ///< PRNU, one sigma, relative
  double corner_light = 1.0;           ///< light in the corner over that in the centre
  double exposure = 1.0;               ///< light over that of the render
  double exposure_jitter = 0.0;        ///< relative, from frame to frame, one sigma
  double defocus_sigma_px = 0.0;       ///< blur beside the lens's own

  /// True if nothing but shot and read noise is left: that is quicker.
  bool is_noise_alone() const;
};

/// How a depth sensor measures. The law and its sigma come from the rig's sensor preset.
struct DepthSensing {
  DepthStream stream;
  bool noise = true;
  /// Stereo: focal length times baseline; disparity [px] = this / z, and sigma [px] = this * sigma of 1/z.
  double focal_baseline_px_m = 0.08 / 0.0019;
  double disparity_step_px = 1.0 / 32.0;  ///< 0 = as fine as can be
  double bias = 0.0;                      ///< smooth field of the device, one sigma: px of disparity, or metres
  double bias_cell_px = 160.0;
  std::vector<double> imagers_x_m;  ///< what they do not all see has no depth
  double focal_px = 640.0;          ///< of the depth image, for the imagers' parallax
  double edge_step_per_m = 0.0;     ///< jump of 1/z that makes an edge; 0 = edges are clean
  double edge_jitter_px = 1.0;
  double flying_share = 0.3;
  double min_contrast_levels = 0.0;  ///< stereo: 8x8 pixels with less texture have no depth; 0 = all have
  double projector_reach_m = 0.0;    ///< up to here they have, all the same
  double patchy_share = 0.0, patch_px = 24.0;
  double ripple_share = 0.0, ripple_px = 12.0;
  double valid_share = 1.0;            ///< of the pixels, patch by patch
  int shift_x_px = 0, shift_y_px = 0;  ///< depth image against the colour image

  /// Standard deviation of what is recorded of a wall at z: the law and the rounding to disparity steps and units.
  double recorded_sigma_m(double z_m) const;
};

/// The depth sensor of a preset with its noise and nothing else. Throws Error if it has no depth.
DepthSensing depth_sensing_of(const SensorPreset& preset);

/// What one camera's sensor does. Absent parts leave the picture clean.
struct SensorModel {
  std::optional<ImageSensing> image;
  std::optional<DepthSensing> depth;
  double depth_scale = 1.0;  ///< measured over true depth, an error of the device

  /// What is simulated, for the truth: names with units, nothing that is off.
  std::map<std::string, double> labels() const;
};

/// Where the random numbers of one frame come from.
struct FrameSeed {
  std::uint64_t seed = 0;
  std::int64_t frame = -1;
  std::int32_t camera = -1;

  RandomStream stream(std::string_view purpose) const { return {seed, purpose, frame, camera}; }
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

 private:
  struct Prepared;
  SensorModel model_;
  std::unique_ptr<Prepared> prepared_;
};

}  // namespace rigproof
