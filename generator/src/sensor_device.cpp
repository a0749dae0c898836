#include "rigproof/generator/sensor_device.h"

namespace rigproof {

void ImageDevice::visit(FieldVisitor& visitor) {
  visitor.field("full_well_electrons", full_well_electrons, {100.0, 1e6}, "light that gives level 255");
  visitor.field("read_noise_electrons", read_noise_electrons, {0.0, 1000.0}, "temporal noise in the dark, one sigma");
  visitor.field("gamma", gamma, {1.0, 3.0}, "level = 255 light^(1/gamma)");
  visitor.field("exposure_ms", exposure_ms, {0.001, 200.0}, "exposure of a row");
  visitor.field("readout_ms", readout_ms, {0.0, 200.0},
                "rolling shutter: from the first row's start to the last row's; 0 = global shutter");
  visitor.field(
      "lens_residual_px", lens_residual_px, {0.0, 5.0},
      "smooth displacement of the image that the lens model's coefficients do not follow, root mean square of a "
      "coordinate, in pixels of the preset's image");
  visitor.field("lens_residual_cells", lens_residual_cells, {4.0, 40.0},
                "lattice cells of that displacement across the image's longer side");
  visitor.check(read_noise_electrons < full_well_electrons, "read_noise_electrons",
                "must be less than full_well_electrons");
  effects.visit_strengths(visitor);
}

void DepthSensorDevice::visit(FieldVisitor& visitor) {
  visitor.field("disparity_step_px", disparity_step_px, {1e-4, 1.0}, "stereo: resolution of the disparity");
  visitor.field("patch_px", patch_px, {2.0, 500.0}, "size of a patch, of coarse noise and of what daylight leaves");
  visitor.field("readout_ms", readout_ms, {0.0, 200.0},
                "time between the measurements of the first and the last row; 0 = all at once");
  effects.visit_strengths(visitor);
}

void SensorDevice::visit(FieldVisitor& visitor) {
  visitor.nested("color", color, "image sensor and lens");
  visitor.nested("depth", depth, "depth sensor");
}

SensorDevice load_sensor_device(const std::string& name, const SensingConfig& config) {
  SensorDevice device;
  device.color.effects = config.image.effects;
  device.depth.effects = config.depth.effects;
  if (!name.empty())
    device.preset = load_sensor_preset(name, [&device](FieldVisitor& visitor) { device.visit(visitor); });
  return device;
}

}  // namespace rigproof
