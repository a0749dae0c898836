#include "rigproof/core/sensor_simulation.h"

namespace rigproof {

void ImageSimulation::visit(FieldVisitor& visitor) {
  visitor.field("full_well_electrons", full_well_electrons, {100.0, 1e6}, "light that gives level 255");
  visitor.field("read_noise_electrons", read_noise_electrons, {0.0, 1000.0}, "temporal noise in the dark, one sigma");
  visitor.field("gamma", gamma, {1.0, 3.0}, "level = 255 light^(1/gamma)");
  visitor.field("dark_offset_electrons", dark_offset_electrons, {0.0, 1000.0},
                "fixed offset of each pixel (DSNU), one sigma");
  visitor.field("pixel_gain_percent", pixel_gain_percent, {0.0, 20.0},
                "fixed gain error of each pixel (PRNU), one sigma");
  visitor.field("corner_light_percent", corner_light_percent, {5.0, 100.0},
                "vignetting: light in the image's corner over that in its centre");
  visitor.field("exposure_ms", exposure_ms, {0.001, 200.0}, "exposure of a row");
  visitor.field("readout_ms", readout_ms, {0.0, 200.0},
                "rolling shutter: from the first row's start to the last row's; 0 = global shutter");
  visitor.check(read_noise_electrons < full_well_electrons, "read_noise_electrons",
                "must be less than full_well_electrons");
}

void DepthSimulation::visit(FieldVisitor& visitor) {
  visitor.field("disparity_step_px", disparity_step_px, {1e-4, 1.0}, "stereo: resolution of the disparity");
  visitor.field("bias_px", bias_px, {0.0, 2.0}, "stereo: smooth bias field of the device, one sigma");
  visitor.field("bias_m", bias_m, {0.0, 0.2}, "time of flight: smooth bias field of the device, one sigma");
  visitor.field("bias_cell_deg", bias_cell_deg, {1.0, 90.0}, "angle over which the bias changes");
  visitor.field("imagers_x_m", imagers_x_m, {-1.0, 1.0}, 0, 2,
                "places of the imagers along the colour camera's x axis; depth is where all of them see the point");
  visitor.field("edge_jitter_px", edge_jitter_px, {0.0, 8.0}, "lateral noise of edges, one sigma");
  visitor.field("flying_share", flying_share, {0.0, 1.0}, "of the pixels at an edge, those that float in between");
  visitor.field("edge_step_per_m", edge_step_per_m, {1e-4, 10.0}, "jump of 1/z that makes an edge");
  visitor.field(
      "min_contrast_levels", min_contrast_levels, {0.0, 255.0},
      "stereo: texture that 8x8 pixels need where the projector does not reach, largest minus smallest level");
  visitor.field("projector_reach_m", projector_reach_m, {0.0, 1000.0}, "the pattern gives texture up to here, indoors");
  visitor.field("projector_reach_outdoors_m", projector_reach_outdoors_m, {0.0, 1000.0}, "the same in daylight");
  visitor.field("patchy_share", patchy_share, {0.0, 1.0}, "of the noise's variance, what varies patch by patch");
  visitor.field("patch_px", patch_px, {2.0, 500.0}, "size of a patch");
  visitor.field("ripple_share", ripple_share, {0.0, 1.0}, "of the noise's variance, waves along the columns");
  visitor.field("ripple_px", ripple_px, {2.0, 500.0}, "length of a wave");
  visitor.field("outdoor_valid_share", outdoor_valid_share, {0.0, 1.0}, "of the pixels, in daylight");
  visitor.field("outdoor_max_m", outdoor_max_m, {0.0, 1000.0}, "range in daylight");
  visitor.field("readout_ms", readout_ms, {0.0, 200.0},
                "time between the measurements of the first and the last row; 0 = all at once");
  visitor.check(patchy_share + ripple_share <= 1.0, "patchy_share",
                "patchy_share and ripple_share are parts of one variance: together at most 1");
}

void SensorSimulation::visit(FieldVisitor& visitor) {
  visitor.nested("color", color, "image sensor and lens");
  visitor.nested("depth", depth, "depth sensor");
}

}  // namespace rigproof
